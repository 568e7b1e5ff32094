// Accelerations, rates of Jacobians and of the centroidal map, derivatives of kinematics, subtrees: against
// finite differences of what they claim to be the rate of, on trees of every joint type with mimic.
#include <gtest/gtest.h>

#include <functional>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::distance;
using testing::kEps;
using testing::times;

constexpr ReferenceFrame kReferences[] = {WORLD, LOCAL, LOCAL_WORLD_ALIGNED};
constexpr double kStep = 1e-5;
constexpr double kTol = 1e-6;  // h^2 times third derivatives up to 1e3, and 1e-16 / h times values up to 1e2

class Rates : public ::testing::TestWithParam<int> {
 protected:
  unsigned seed = static_cast<unsigned>(GetParam());
  Model model = testing::randomTree(seed, 2 + GetParam(), GetParam() % 2 == 0);
  testing::State s = testing::randomState(model, seed);
  Data data{model}, other{model};

  // The state a time t later: v grows by t a, q along the mean of it.
  Eigen::VectorXd qAt(double t) const { return integrate(model, s.q, t * s.v + 0.5 * t * t * s.a); }
  Eigen::VectorXd vAt(double t) const { return s.v + t * s.a; }
  // Rate of f along that motion.
  Eigen::MatrixXd rate(const std::function<Eigen::MatrixXd(double)>& f) const {
    return (f(kStep) - f(-kStep)) / (2 * kStep);
  }
};

TEST_P(Rates, AccelerationsAreTheRatesOfVelocities) {
  forwardKinematics(model, data, s.q, s.v, s.a);
  // off the origin of tangent space a free-flyer's v is not the rate of the difference: second order in t, so
  // the central difference does not see it
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    for (const ReferenceFrame reference : kReferences) {
      const auto velocity = [&](double t) {
        forwardKinematics(model, other, qAt(t), vAt(t));
        return Eigen::MatrixXd(getFrameVelocity(model, other, f, reference).toVector());
      };
      const Motion a = getFrameAcceleration(model, data, f, reference);
      const Motion c = getFrameClassicalAcceleration(model, data, f, reference);
      // in LOCAL_WORLD_ALIGNED the numbers change as the classical acceleration, elsewhere as the spatial one
      const Motion wanted = reference == LOCAL_WORLD_ALIGNED ? c : a;
      EXPECT_LE(distance(wanted.toVector(), rate(velocity)), kTol)
          << model.frames[f].name << " " << reference;
      EXPECT_LE(distance(c.toVector() - a.toVector(),
                         Motion(Eigen::Vector3d::Zero(),
                                getFrameVelocity(model, data, f, reference)
                                    .angular()
                                    .cross(getFrameVelocity(model, data, f, reference).linear()))
                             .toVector()),
                1e-12);
    }
  }
  // a point's acceleration is the second difference of its position: error h^2, eps / h^2
  const double h = 1e-4;
  const auto position = [&](double t) {
    forwardKinematics(model, other, qAt(t));
    return other.oMf[model.nframes - 1].translation();
  };
  const Eigen::Vector3d second = (position(h) - 2 * position(0) + position(-h)) / (h * h);
  EXPECT_LE(
      distance(getFrameClassicalAcceleration(model, data, model.nframes - 1, LOCAL_WORLD_ALIGNED).linear(),
               second),
      1e-5);
}

TEST_P(Rates, JacobianRates) {
  computeJointJacobiansTimeVariation(model, data, s.q, s.v);
  Data kinematics(model);
  forwardKinematics(model, kinematics, s.q, s.v, s.a);
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    const JointIndex joint = model.frames[f].parentJoint;
    for (const ReferenceFrame reference : kReferences) {
      const auto frame_J = [&](double t) {
        computeJointJacobians(model, other, qAt(t));
        return Eigen::MatrixXd(getFrameJacobian(model, other, f, reference));
      };
      const Eigen::MatrixXd dJ = getFrameJacobianTimeVariation(model, data, f, reference);
      EXPECT_LE(distance(dJ, rate(frame_J)), kTol) << model.frames[f].name << " " << reference;
      // dJ v + J a
      const Eigen::VectorXd a = times(dJ, s.v) + times(getFrameJacobian(model, data, f, reference), s.a);
      const Motion wanted = reference == LOCAL_WORLD_ALIGNED
                                ? getFrameClassicalAcceleration(model, kinematics, f, reference)
                                : getFrameAcceleration(model, kinematics, f, reference);
      EXPECT_LE(distance(a, wanted.toVector()), 1e3 * kEps * std::max(1.0, wanted.toVector().norm()));
      const auto joint_J = [&](double t) {
        computeJointJacobians(model, other, qAt(t));
        return Eigen::MatrixXd(getJointJacobian(model, other, joint, reference));
      };
      EXPECT_LE(distance(getJointJacobianTimeVariation(model, data, joint, reference), rate(joint_J)), kTol);
    }
  }
}

TEST_P(Rates, CentroidalMap) {
  const Eigen::MatrixXd dAg = computeCentroidalMapTimeVariation(model, data, s.q, s.v);
  const Eigen::MatrixXd Ag = data.Ag;
  EXPECT_LE(distance(dAg, rate([&](double t) {
                       return Eigen::MatrixXd(computeCentroidalMap(model, other, qAt(t)));
                     })),
            kTol);
  const double tol = 1e3 * kEps;
  EXPECT_LE(distance(times(Ag, s.v), computeCentroidalMomentum(model, other, s.q, s.v).toVector()), tol);
  EXPECT_LE(distance(data.hg.toVector(), times(Ag, s.v)), tol);
  const Eigen::VectorXd dhg = computeCentroidalMomentumTimeVariation(model, other, s.q, s.v, s.a).toVector();
  EXPECT_LE(distance(times(Ag, s.a) + times(dAg, s.v), dhg), tol * std::max(1.0, dhg.norm()));
  EXPECT_LE(distance(data.vcom[0],
                     rate([&](double t) { return Eigen::MatrixXd(centerOfMass(model, other, qAt(t))); })),
            kTol);
}

TEST_P(Rates, CentresOfMass) {
  computeSubtreeCentersOfMass(model, data, s.q, s.v, s.a);
  centerOfMass(model, other, s.q, s.v, s.a);
  EXPECT_EQ(distance(data.acom[0], other.acom[0]), 0);
  EXPECT_NEAR(data.mass[0], computeTotalMass(model), 1e-12 * data.mass[0]);
  const std::vector<double> masses = data.mass;
  computeSubtreeMasses(model, other);
  Data now(model);
  forwardKinematics(model, now, s.q);
  for (JointIndex j = 0; j < model.njoints; ++j) {
    EXPECT_NEAR(other.mass[j], masses[j], 1e-12 * data.mass[0]);
    // by definition: the mean over all bodies at or behind the joint
    const auto com = [&](const Data& at) {
      double mass = 0;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (JointIndex i = 1; i < model.njoints; ++i) {
        JointIndex up = i;
        while (up > 0 && up != j) up = model.parents[up];
        if (up != j) continue;
        mass += model.inertias[i].mass();
        sum += model.inertias[i].mass() * at.oMi[i].act(model.inertias[i].lever());
      }
      return Eigen::Vector3d(sum / mass);
    };
    EXPECT_LE(distance(data.com[j], com(now)), 1e-12);
    const auto moved = [&](double t) {
      forwardKinematics(model, other, qAt(t));
      return Eigen::MatrixXd(com(other));
    };
    EXPECT_LE(distance(data.vcom[j], rate(moved)), kTol);
    const auto speed = [&](double t) {
      computeSubtreeCentersOfMass(model, other, qAt(t), vAt(t), s.a);
      return Eigen::MatrixXd(other.vcom[j]);
    };
    EXPECT_LE(distance(data.acom[j], rate(speed)), kTol);
    Eigen::MatrixXd J(3, model.nv);
    jacobianSubtreeCenterOfMass(model, other, s.q, j, J);
    EXPECT_LE(distance(times(J, s.v), data.vcom[j]), 1e3 * kEps * std::max(1.0, data.vcom[j].norm()));
  }
}

TEST_P(Rates, DerivativesOfKinematics) {
  computeForwardKinematicsDerivatives(model, data, s.q, s.v, s.a);
  crba(model, data, qAt(1));  // what came in between does not matter
  Eigen::MatrixXd v_q(6, model.nv), v_v = v_q, a_q = v_q, a_v = v_q, a_a = v_q, again = v_q;
  const auto slopes = [&](const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f) {
    Eigen::MatrixXd out(6, model.nv);
    for (int k = 0; k < model.nv; ++k) {
      const Eigen::VectorXd x = kStep * Eigen::VectorXd::Unit(model.nv, k);
      out.col(k) = (f(x) - f(-x)) / (2 * kStep);
    }
    return out;
  };
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    for (const ReferenceFrame reference : kReferences) {
      const auto velocity = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
        forwardKinematics(model, other, q, v);
        return getFrameVelocity(model, other, f, reference).toVector();
      };
      const auto acceleration = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                    const Eigen::VectorXd& a) {
        forwardKinematics(model, other, q, v, a);
        return getFrameAcceleration(model, other, f, reference).toVector();
      };
      getFrameVelocityDerivatives(model, data, f, reference, v_q, v_v);
      getFrameAccelerationDerivatives(model, data, f, reference, again, a_q, a_v, a_a);
      using X = const Eigen::VectorXd&;
      EXPECT_EQ(distance(again, v_q), 0);
      EXPECT_LE(distance(v_q, slopes([&](X x) { return velocity(integrate(model, s.q, x), s.v); })), kTol);
      EXPECT_LE(distance(v_v, slopes([&](X x) { return velocity(s.q, s.v + x); })), kTol);
      EXPECT_LE(distance(a_q, slopes([&](X x) { return acceleration(integrate(model, s.q, x), s.v, s.a); })),
                kTol);
      EXPECT_LE(distance(a_v, slopes([&](X x) { return acceleration(s.q, s.v + x, s.a); })), kTol);
      EXPECT_LE(distance(a_a, slopes([&](X x) { return acceleration(s.q, s.v, s.a + x); })), kTol);
    }
    if (model.frames[f].type != JOINT) continue;
    // a joint's frame is the joint itself
    getFrameAccelerationDerivatives(model, data, f, LOCAL, v_q, a_q, a_v, a_a);
    Eigen::MatrixXd q2 = v_q, aq2 = v_q, av2 = v_q, aa2 = v_q;
    getJointAccelerationDerivatives(model, data, model.frames[f].parentJoint, LOCAL, q2, aq2, av2, aa2);
    EXPECT_EQ(distance(q2, v_q) + distance(aq2, a_q) + distance(av2, a_v) + distance(aa2, a_a), 0);
  }
}

TEST_P(Rates, AllTermsAreAll) {
  computeAllTerms(model, data, s.q, s.v);
  EXPECT_EQ(distance(data.M, crba(model, other, s.q)), 0);
  EXPECT_EQ(distance(data.Minv, computeMinverse(model, other, s.q)), 0);
  EXPECT_EQ(distance(data.nle, nonLinearEffects(model, other, s.q, s.v)), 0);
  EXPECT_EQ(distance(data.g, computeGeneralizedGravity(model, other, s.q)), 0);
  EXPECT_EQ(distance(data.C, computeCoriolisMatrix(model, other, s.q, s.v)), 0);
  EXPECT_EQ(distance(data.dJ, computeJointJacobiansTimeVariation(model, other, s.q, s.v)), 0);
  EXPECT_EQ(distance(data.J, other.J), 0);
  EXPECT_EQ(distance(data.Jcom, jacobianCenterOfMass(model, other, s.q)), 0);
  EXPECT_EQ(distance(data.dAg, dccrba(model, other, s.q, s.v)), 0);
  EXPECT_EQ(distance(data.Ag, other.Ag), 0);
  centerOfMass(model, other, s.q, s.v);
  EXPECT_LE(distance(data.vcom[0], other.vcom[0]), 1e3 * kEps);
  EXPECT_EQ(data.mechanical_energy, computeMechanicalEnergy(model, other, s.q, s.v));
  forwardKinematics(model, other, s.q, s.v);
  for (FrameIndex f = 0; f < model.nframes; ++f) EXPECT_TRUE(data.oMf[f].isApprox(other.oMf[f], 0));
}

INSTANTIATE_TEST_SUITE_P(Random, Rates, ::testing::Range(0, 12));

}  // namespace
}  // namespace rbd
