#include "rbd/algorithm/configuration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::kEps;

TEST(Configuration, RoundTripsOnTrees) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Model model = testing::randomTree(seed, 10, seed % 2 == 0);
    const testing::State s = testing::randomState(model, seed), t = testing::randomState(model, seed + 100);
    const auto back = [&](double size) {
      return testing::distance(difference(model, s.q, integrate(model, s.q, size * s.v)), size * s.v);
    };
    for (const double size : {0.0, 1e-8, 1e-3, 1.0, 1.7}) EXPECT_LE(back(size), 1e-13) << size;
    // as configurations: q and -q of a quaternion are the same, so compare poses by their difference
    const Eigen::VectorXd there = integrate(model, s.q, difference(model, s.q, t.q));
    EXPECT_LE(difference(model, there, t.q).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LE(difference(model, s.q, s.q).cwiseAbs().maxCoeff(), 1e-15);
  }
}

TEST(Configuration, InterpolateRunsFromOneToTheOther) {
  const Model model = testing::randomTree(4, 8, true);
  const testing::State s = testing::randomState(model, 4), t = testing::randomState(model, 5);
  EXPECT_LE(difference(model, interpolate(model, s.q, t.q, 0), s.q).norm(), 1e-14);
  EXPECT_LE(difference(model, interpolate(model, s.q, t.q, 1), t.q).norm(), 1e-12);
  const Eigen::VectorXd half = interpolate(model, s.q, t.q, 0.5);
  EXPECT_LE(testing::distance(difference(model, s.q, half), 0.5 * difference(model, s.q, t.q)), 1e-13);
}

// A body that flies a screw: integrate must follow SE3's exponential.
TEST(Configuration, FreeFlyerFollowsTheExponential) {
  Model model;
  model.addJoint(0, JointModelFreeFlyer(), SE3(), "body");
  Data data(model);
  const testing::State s = testing::randomState(model, 6);
  forwardKinematics(model, data, s.q);
  const SE3 start = data.oMi[1];
  forwardKinematics(model, data, integrate(model, s.q, s.v));
  EXPECT_TRUE(data.oMi[1].isApprox(start * exp6(Motion(Vector6d(s.v))), 64 * kEps));
}

TEST(Configuration, NeutralAndNormalize) {
  const Model model = testing::randomTree(8, 8, true);
  Eigen::VectorXd q = neutral(model);
  EXPECT_EQ(q[6], 1);
  EXPECT_EQ(q.cwiseAbs().sum(), std::round(q.cwiseAbs().sum()));
  q.segment<4>(3) = Eigen::Vector4d(1, 2, 3, 4);
  normalize(model, q);
  EXPECT_NEAR(q.segment<4>(3).norm(), 1, 4 * kEps);
  EXPECT_NEAR(q[4] / q[3], 2, 8 * kEps);
}

// any length of quaternion is the same rotation
TEST(Configuration, QuaternionsNeedNotBeUnit) {
  Model model;
  buildModels::humanoid(model);
  Data data(model);
  const testing::State s = testing::randomState(model, 9);
  Eigen::VectorXd q = s.q;
  q.segment<4>(3) *= 1.7;
  const Eigen::VectorXd tau = rnea(model, data, s.q, s.v, s.a);
  EXPECT_LE(testing::distance(rnea(model, data, q, s.v, s.a), tau), 1e-13);
}

TEST(Configuration, RandomStaysInTheLimitsAndRepeats) {
  Model model;
  const auto one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
  model.addJoint(0, JointModelRX(), SE3(), "a", one(1), one(1), one(0.2), one(0.3));
  model.addJoint(1, JointModelContinuous(0, 0, 1), SE3(), "b");
  model.addJoint(2, JointModelFreeFlyer(), SE3(), "c");
  std::mt19937_64 engine(1);
  double low = 1, high = 0, turn = 0;
  for (int k = 0; k < 500; ++k) {
    const Eigen::VectorXd q = randomConfiguration(model, engine);
    low = std::min(low, q[0]);
    high = std::max(high, q[0]);
    turn = std::max(turn, std::abs(q[1]));
    EXPECT_NEAR(q.segment<4>(5).norm(), 1, 8 * kEps);
  }
  EXPECT_GE(low, 0.2);
  EXPECT_LT(low, 0.205);
  EXPECT_LE(high, 0.3);
  EXPECT_GT(high, 0.295);
  EXPECT_LE(turn, PI<double>());
  EXPECT_GT(turn, 3.0);
  EXPECT_EQ(randomConfiguration(model, 7u), randomConfiguration(model, 7u));
  EXPECT_NE(randomConfiguration(model, 7u), randomConfiguration(model, 8u));
  EXPECT_NE(randomConfiguration(model), randomConfiguration(model));
}

// dIntegrate and dDifference against central differences: error h^2 and eps / h.
TEST(Configuration, DerivativesOfIntegrateAndDifference) {
  const double h = 1e-5, tol = 1e-8;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Model model = testing::randomTree(seed, 10, seed % 2 == 0);
    const testing::State s = testing::randomState(model, seed), t = testing::randomState(model, seed + 50);
    const auto slopes = [&](auto&& f) {
      Eigen::MatrixXd out(model.nv, model.nv);
      for (int k = 0; k < model.nv; ++k) {
        const Eigen::VectorXd x = h * Eigen::VectorXd::Unit(model.nv, k);
        out.col(k) = (f(x) - f(-x)) / (2 * h);
      }
      return out;
    };
    using X = Eigen::VectorXd;
    const X end = integrate(model, s.q, s.v);
    const auto from_end = [&](const X& q) { return difference(model, end, q); };
    const auto by_q = [&](const X& x) { return from_end(integrate(model, integrate(model, s.q, x), s.v)); };
    const auto by_v = [&](const X& x) { return from_end(integrate(model, s.q, s.v + x)); };
    EXPECT_LE(testing::distance(dIntegrate(model, s.q, s.v, ARG0), slopes(by_q)), tol);
    EXPECT_LE(testing::distance(dIntegrate(model, s.q, s.v, ARG1), slopes(by_v)), tol);
    const auto by_q0 = [&](const X& x) { return difference(model, integrate(model, s.q, x), t.q); };
    const auto by_q1 = [&](const X& x) { return difference(model, s.q, integrate(model, t.q, x)); };
    EXPECT_LE(testing::distance(dDifference(model, s.q, t.q, ARG0), slopes(by_q0)), 10 * tol);
    EXPECT_LE(testing::distance(dDifference(model, s.q, t.q, ARG1), slopes(by_q1)), 10 * tol);
  }
}

// The exact rate is the inverse right Jacobian times v. The series that is cut off goes on with [x, [x, [x, [x, v]]]] /
// 720, and a bracket is at most 2 |x| long: 16 |x|^4 |v| / 720 and what follows.
TEST(Configuration, CoordinateRateIsTheInverseRightJacobianUpToFourthOrder) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Model model = testing::randomTree(seed, 15, seed % 2 == 0);
    const testing::State s = testing::randomState(model, seed);
    for (const double size : {1.0, 0.1, 1e-3}) {
      const Eigen::VectorXd x = size / s.v.norm() * s.v;
      const Eigen::VectorXd rate = coordinateRate(model, x, s.a);
      const Eigen::VectorXd back = dIntegrate(model, s.q, x, ARG1) * rate;
      EXPECT_LE((back - s.a).norm(), (std::pow(size, 4) / 40 + 32 * kEps) * s.a.norm())
          << seed << " " << size;
      Eigen::VectorXd in_place = s.a;
      coordinateRate(model, x, in_place, in_place);
      EXPECT_EQ(in_place, rate);
    }
  }
  Model arm;  // velocities are the rates of the angles
  buildModels::manipulator(arm);
  const testing::State s = testing::randomState(arm, 1);
  EXPECT_EQ(coordinateRate(arm, s.v, s.a), s.a);
  EXPECT_THROW(coordinateRate(arm, s.v.head(2), s.a), std::invalid_argument);
}

TEST(Configuration, DistanceAndSameness) {
  const Model model = testing::randomTree(4, 12, true);
  const testing::State s = testing::randomState(model, 4), t = testing::randomState(model, 5);
  EXPECT_NEAR(distance(model, s.q, t.q), difference(model, s.q, t.q).norm(), 1e-12);
  EXPECT_NEAR(squaredDistance(model, s.q, t.q), difference(model, s.q, t.q).squaredNorm(), 1e-11);
  Eigen::VectorXd q = s.q;
  q.segment<4>(3) *= -1;  // the same rotation
  EXPECT_TRUE(isSameConfiguration(model, s.q, q));
  EXPECT_FALSE(isSameConfiguration(model, s.q, t.q));
  EXPECT_TRUE(isNormalized(model, q));
  q[3] += 0.1;
  EXPECT_FALSE(isNormalized(model, q));
}

TEST(Configuration, RandomStaysBetweenBounds) {
  const Model model = testing::randomTree(7, 20, false);
  std::mt19937_64 engine(1);
  const Eigen::VectorXd low = Eigen::VectorXd::Constant(model.nq, 0.25), high = low * 2;
  const Eigen::VectorXd q = randomConfiguration(model, engine, low, high);
  for (const JointModel& joint : model.joints) {
    if (joint.nq() != joint.nv()) continue;
    for (int k = joint.idx_q(); k < joint.idx_q() + joint.nq(); ++k) EXPECT_TRUE(q[k] >= 0.25 && q[k] <= 0.5);
  }
  EXPECT_TRUE(isNormalized(model, q));
  EXPECT_THROW(randomConfiguration(model, engine, low.head(1), high), std::invalid_argument);
}

// Where a limit is missing, pi (1 m) stands in for it, or the other limit if that lies beyond. Of 500 even numbers none lies in the
// outer 2 % at an end with a probability of 0.98^500 = 4e-5; the seed is fixed.
TEST(Configuration, RandomWithOneLimitReachesFromItToTheUsualEnd) {
  const double none = INFINITY, pi = 3.14159265358979324;
  const struct {
    JointModel joint;
    double lower, upper, from, to;
  } rows[] = {{JointModelRX(), -0.5, none, -0.5, pi}, {JointModelRX(), -none, 0.5, -pi, 0.5},
              {JointModelPX(), 0.25, none, 0.25, 1},  {JointModelPX(), -none, -0.25, -1, -0.25},
              {JointModelPX(), 3, none, 3, 3},        {JointModelPX(), -none, -3, -3, -3},
              {JointModelPX(), -none, none, -1, 1}};
  Model model;
  for (const auto& row : rows) {
    const int at = model.addJoint(0, row.joint, SE3(), "j" + std::to_string(model.njoints)) - 1;
    model.lowerPositionLimit[at] = row.lower;
    model.upperPositionLimit[at] = row.upper;
  }
  std::mt19937_64 engine(3);
  Eigen::VectorXd least = randomConfiguration(model, engine), most = least;
  for (int k = 0; k < 500; ++k) {
    const Eigen::VectorXd q = randomConfiguration(model, engine);
    least = least.cwiseMin(q);
    most = most.cwiseMax(q);
  }
  for (int i = 0; i < model.nq; ++i) {
    const double near = 0.02 * (rows[i].to - rows[i].from);
    EXPECT_GE(least[i], rows[i].from) << i;
    EXPECT_LE(least[i], rows[i].from + near) << i;
    EXPECT_LE(most[i], rows[i].to) << i;
    EXPECT_GE(most[i], rows[i].to - near) << i;
  }
}

}  // namespace
}  // namespace rbd
