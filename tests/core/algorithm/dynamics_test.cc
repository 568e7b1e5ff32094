// Inverse and forward dynamics on random trees: every number is reached by two roads.
#include <gtest/gtest.h>

#include <cmath>

#include "rbd/kernel/workspace.h"
#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::condition;
using testing::distance;
using testing::kEps;
using testing::Order;
using testing::times;

class Dynamics : public ::testing::TestWithParam<int> {
 protected:
  unsigned seed = static_cast<unsigned>(GetParam());
  Model model = testing::randomTree(seed, 2 + 3 * GetParam(), GetParam() % 2 == 0,
                                    GetParam() % 3 == 0 ? Order::DepthFirst : Order::Any);
  testing::State s = testing::randomState(model, seed);
  Data data{model};
  Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.nv);
};

// Errors of one pass are of order eps times the size of the efforts inside; 1e3 covers the depth of the
// trees.
constexpr double kTol = 1e3 * kEps;

TEST_P(Dynamics, InertiaTimesAccelerationPlusBiasIsRnea) {
  const Eigen::VectorXd tau = rnea(model, data, s.q, s.v, s.a);
  const Eigen::MatrixXd M = crba(model, data, s.q);
  EXPECT_LE(distance(times(M, s.a) + nonLinearEffects(model, data, s.q, s.v), tau), kTol);
}

TEST_P(Dynamics, ColumnsOfMByRnea) {
  const Eigen::MatrixXd M = crba(model, data, s.q);
  EXPECT_EQ(distance(M, M.transpose()), 0);
  const Eigen::VectorXd rest = rnea(model, data, s.q, zero, zero);
  for (int k = 0; k < model.nv; ++k) {
    const Eigen::VectorXd column = rnea(model, data, s.q, zero, Eigen::VectorXd::Unit(model.nv, k)) - rest;
    EXPECT_LE((M.col(k) - column).cwiseAbs().maxCoeff(), kTol * std::max(1.0, rest.cwiseAbs().maxCoeff()))
        << k;
  }
}

TEST_P(Dynamics, MFromBodyJacobians) {
  // sum J' I J over the bodies, plus the rotors: no recursion at all
  computeJointJacobians(model, data, s.q);
  Eigen::MatrixXd sum = model.armature.asDiagonal();
  for (JointIndex i = 1; i < model.njoints; ++i) {
    const Matrix6Xd J = getJointJacobian(model, data, i, LOCAL);
    sum += times(J.transpose(), times(model.inertias[i].matrix(), J));
  }
  EXPECT_LE(distance(crba(model, data, s.q), sum), kTol);
}

TEST_P(Dynamics, AbaUndoesRnea) {
  const Eigen::VectorXd tau = rnea(model, data, s.q, s.v, s.a);
  const double bound = condition(crba(model, data, s.q), computeMinverse(model, data, s.q));
  EXPECT_LE(distance(aba(model, data, s.q, s.v, tau), s.a), kTol * bound);
}

TEST_P(Dynamics, AbaSolvesTheEquationOfMotion) {
  // M a + nle = tau, with neither M nor nle from the articulated bodies
  const Eigen::VectorXd a = aba(model, data, s.q, s.v, s.tau);
  const Eigen::MatrixXd M = crba(model, data, s.q);
  const double bound = condition(M, computeMinverse(model, data, s.q));
  EXPECT_LE(distance(times(M, a) + nonLinearEffects(model, data, s.q, s.v), s.tau), kTol * bound);
}

TEST_P(Dynamics, MinvTimesMIsOne) {
  const Eigen::MatrixXd M = crba(model, data, s.q);
  const Eigen::MatrixXd Minv = computeMinverse(model, data, s.q);
  EXPECT_EQ(distance(Minv, Minv.transpose()), 0);
  EXPECT_LE(distance(times(Minv, M), Eigen::MatrixXd::Identity(model.nv, model.nv)),
            kTol * condition(M, Minv));
}

TEST_P(Dynamics, GravityIsTheSlopeOfPotentialEnergy) {
  const Eigen::VectorXd g = computeGeneralizedGravity(model, data, s.q);
  EXPECT_LE(distance(g, rnea(model, data, s.q, zero, zero)), kTol);
  EXPECT_LE(distance(g, nonLinearEffects(model, data, s.q, zero)), kTol);
  const double h = 1e-5;  // U of order 100: rounding 1e-14 * 100 / h, truncation 100 h^2
  for (int k = 0; k < model.nv; ++k) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.nv, k);
    const double slope = (computePotentialEnergy(model, data, integrate(model, s.q, step)) -
                          computePotentialEnergy(model, data, integrate(model, s.q, -step))) /
                         (2 * h);
    EXPECT_NEAR(g[k], slope, 1e-6) << k;
  }
}

TEST_P(Dynamics, KineticEnergyIsHalfVMv) {
  const double energy = computeKineticEnergy(model, data, s.q, s.v);
  EXPECT_NEAR(energy, 0.5 * s.v.dot(times(crba(model, data, s.q), s.v).col(0)), kTol * std::max(1.0, energy));
}

// d(T + U)/dt = tau . v along the motion that aba predicts.
TEST_P(Dynamics, PowerIsTheRateOfEnergy) {
  const Eigen::VectorXd a = aba(model, data, s.q, s.v, s.tau);
  const double h = 1e-6;
  const auto energy = [&](double t) {
    const Eigen::VectorXd v = s.v + t * a, q = integrate(model, s.q, t * s.v + 0.5 * t * t * a);
    return computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q);
  };
  const double scale = std::max({1.0, std::abs(energy(0)), a.squaredNorm()});
  EXPECT_NEAR((energy(h) - energy(-h)) / (2 * h), s.tau.dot(s.v), 1e-7 * scale);
}

TEST_P(Dynamics, OutputTwinsAgree) {
  Eigen::VectorXd x(model.nv);
  Eigen::MatrixXd M(model.nv, model.nv);
  rnea(model, data, s.q, s.v, s.a, x);
  EXPECT_EQ(distance(x, rnea(model, data, s.q, s.v, s.a)), 0);
  nonLinearEffects(model, data, s.q, s.v, x);
  EXPECT_EQ(distance(x, data.nle), 0);
  computeGeneralizedGravity(model, data, s.q, x);
  EXPECT_EQ(distance(x, data.g), 0);
  aba(model, data, s.q, s.v, s.tau, x);
  EXPECT_EQ(distance(x, data.ddq), 0);
  const FrameWrenches push = {{1, Force(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)), LOCAL}};
  aba(model, data, s.q, s.v, s.tau, push, x);
  EXPECT_EQ(distance(x, data.ddq), 0);
  EXPECT_EQ(distance(x, aba(model, data, s.q, s.v, s.tau, push)), 0);
  aba(model, data, s.q, s.v, s.tau, {}, x);
  EXPECT_EQ(distance(x, aba(model, data, s.q, s.v, s.tau)), 0);
  crba(model, data, s.q, M);
  EXPECT_EQ(distance(M, data.M), 0);
  computeMinverse(model, data, s.q, M);
  EXPECT_EQ(distance(M, data.Minv), 0);
}

TEST_P(Dynamics, FrictionIsWhatTheTermsAdd) {
  const Eigen::VectorXd v = 0.02 * s.v;  // where tanh bends
  const Eigen::VectorXd bias = nonLinearEffects(model, data, s.q, v);
  model.damping.setConstant(0.7);
  model.friction.setConstant(0.3);
  EXPECT_EQ(nonLinearEffects(model, data, s.q, v), bias);
  model.terms.damping = model.terms.friction = true;
  Eigen::VectorXd with = bias;
  const double h = 1e-6;
  for (int k = 0; k < model.nv; ++k) {
    with[k] += frictionEffort(0.7, 0.3, v[k]);
    const double slope = (frictionEffort(0.7, 0.3, v[k] + h) - frictionEffort(0.7, 0.3, v[k] - h)) / (2 * h);
    EXPECT_NEAR(frictionSlope(0.7, 0.3, v[k]), slope, 1e-5);  // h^2 / 6 of 0.3 * 2 / kSlipSpeed^3
  }
  EXPECT_LE(distance(nonLinearEffects(model, data, s.q, v), with), 4 * kEps);
}

INSTANTIATE_TEST_SUITE_P(Random, Dynamics, ::testing::Range(0, 12));

// A chain of many joints: recursion depth must not matter.
TEST(DynamicsLong, ChainOfThousand) {
  Model model;
  testing::Random random(4);
  JointIndex last = 0;
  for (int i = 1; i <= 1000; ++i) {
    last = model.addJoint(last, JointModelRevoluteUnaligned(random.vec3()),
                          SE3(exp3(random.vec3(0.3)), 0.01 * random.vec3()), "j" + std::to_string(i));
    model.appendBodyToJoint(last, Inertia::FromSphere(0.1, 0.05));
  }
  model.armature.setConstant(0.1);
  Data data(model);
  const testing::State s = testing::randomState(model, 4);
  const Eigen::VectorXd tau = rnea(model, data, s.q, 0.01 * s.v, s.a);
  EXPECT_LE(distance(aba(model, data, s.q, 0.01 * s.v, tau), s.a), 1e-8);
}

// The same tree, its joints added in another order: the same robot.
TEST(DynamicsOrder, OrderOfAddingDoesNotMatter) {
  const auto build = [](const std::vector<int>& order) {
    testing::Random random(5);
    const int parent[] = {0, 0, 1, 1, 2, 3, 2};
    std::vector<SE3> place;
    std::vector<Inertia> body;
    std::vector<Eigen::Vector3d> axis;
    for (int i = 0; i < 7; ++i) {
      place.push_back(random.pose());
      body.push_back(random.inertia());
      axis.push_back(random.vec3());
    }
    Model model;
    for (const int i : order) {
      const JointIndex up = parent[i] == 0 ? 0 : model.jointId("j" + std::to_string(parent[i]));
      const JointIndex at =
          model.addJoint(up, JointModelRevoluteUnaligned(axis[i]), place[i], "j" + std::to_string(i));
      model.appendBodyToJoint(at, body[i]);
    }
    return model;
  };
  const Model one = build({1, 2, 4, 6, 3, 5}), two = build({1, 3, 2, 5, 4, 6});
  Data d1(one), d2(two);
  EXPECT_TRUE(d1.work().depthFirst);
  EXPECT_FALSE(d2.work().depthFirst);
  const Eigen::VectorXd q1 = testing::Random(6).vec(6);
  Eigen::VectorXd q2(6);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(6, 6);  // q2 = P q1
  for (JointIndex i = 1; i < 7; ++i) P(two.jointId(one.names[i]) - 1, i - 1) = 1;
  q2 = times(P, q1);
  EXPECT_LE(
      distance(computeMinverse(two, d2, q2), times(times(P, computeMinverse(one, d1, q1)), P.transpose())),
      1e-13);
  EXPECT_LE(distance(crba(two, d2, q2), times(times(P, crba(one, d1, q1)), P.transpose())), 1e-13);
}

}  // namespace
}  // namespace rbd
