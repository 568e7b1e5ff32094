// Values that can be worked out by hand: pendulums, the planar two-link arm, a falling and a spinning body.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::kEps;

// Two links in the vertical x-z plane, turning about -y so that positive angles lift from +x towards +z.
// Link k: length l, centre of mass at c, mass m, inertia I about its centre.
struct Planar {
  double l1 = 0.5, c1 = 0.2, m1 = 3, I1 = 0.04, c2 = 0.25, m2 = 2, I2 = 0.03;

  Model model() const {
    Model out;
    const auto along = [](double x) { return SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, 0, 0)); };
    const auto body = [](double m, double I) {
      return Inertia(m, Eigen::Vector3d::Zero(), Eigen::Vector3d(0.01, I, 0.02).asDiagonal());
    };
    out.addJoint(0, JointModelRevoluteUnaligned(0, -1, 0), SE3(), "shoulder");
    out.addJoint(1, JointModelRevoluteUnaligned(0, -1, 0), along(l1), "elbow");
    out.appendBodyToJoint(1, body(m1, I1), along(c1));
    out.appendBodyToJoint(2, body(m2, I2), along(c2));
    return out;
  }
  Eigen::Matrix2d M(double q2) const {
    const double a = I1 + m1 * c1 * c1 + I2 + m2 * (l1 * l1 + c2 * c2 + 2 * l1 * c2 * std::cos(q2));
    const double b = I2 + m2 * (c2 * c2 + l1 * c2 * std::cos(q2)), d = I2 + m2 * c2 * c2;
    return (Eigen::Matrix2d() << a, b, b, d).finished();
  }
  Eigen::Vector2d coriolis(double q2, double v1, double v2) const {
    const double h = m2 * l1 * c2 * std::sin(q2);
    return {-h * (2 * v1 * v2 + v2 * v2), h * v1 * v1};
  }
  Eigen::Vector2d gravity(double q1, double q2) const {
    const double g = 9.81, far = m2 * c2 * g * std::cos(q1 + q2);
    return {(m1 * c1 + m2 * l1) * g * std::cos(q1) + far, far};
  }
};

TEST(Textbook, PlanarTwoLinkArm) {
  const Planar arm;
  const Model model = arm.model();
  Data data(model);
  testing::Random random(1);
  for (int n = 0; n < 20; ++n) {
    const Eigen::Vector2d q = random.vec(2, 3), v = random.vec(2, 2), a = random.vec(2, 2);
    const Eigen::Vector2d nle = arm.coriolis(q[1], v[0], v[1]) + arm.gravity(q[0], q[1]);
    const double tol = 1e3 * kEps * 30;  // efforts of order 30
    EXPECT_LE((crba(model, data, q) - arm.M(q[1])).norm(), tol);
    EXPECT_LE((nonLinearEffects(model, data, q, v) - nle).norm(), tol);
    EXPECT_LE((computeGeneralizedGravity(model, data, q) - arm.gravity(q[0], q[1])).norm(), tol);
    EXPECT_LE((rnea(model, data, q, v, a) - (arm.M(q[1]) * a + nle)).norm(), tol);
    forwardKinematics(model, data, q);
    const Eigen::Vector3d elbow(arm.l1 * std::cos(q[0]), 0, arm.l1 * std::sin(q[0]));
    EXPECT_LE((data.oMi[2].translation() - elbow).norm(), 8 * kEps);
    // J of the elbow's origin: perpendicular to the upper arm
    computeJointJacobians(model, data, q);
    const Matrix6Xd J = getJointJacobian(model, data, 2, LOCAL_WORLD_ALIGNED);
    EXPECT_LE((J.col(0).tail<3>() - Eigen::Vector3d(-elbow.z(), 0, elbow.x())).norm(), 16 * kEps);
    EXPECT_LE(J.col(1).tail<3>().norm(), 16 * kEps);
  }
}

TEST(Textbook, PendulumWithRotor) {
  Model model;
  model.addJoint(0, JointModelRX(), SE3(), "swing");
  model.appendBodyToJoint(1, Inertia(2, Eigen::Vector3d(0, 0, -0.5), Eigen::Matrix3d::Zero()));
  model.armature[0] = 0.1;
  Data data(model);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.3), zero = Eigen::VectorXd::Zero(1);
  // (m l^2 + rotor) qdd = - m g l sin q
  EXPECT_NEAR(aba(model, data, q, zero, zero)[0], -2 * 9.81 * 0.5 * std::sin(0.3) / (2 * 0.25 + 0.1), 1e-14);
}

// A motor that turns n times while its joint turns once, in whichever sense, has the energy J (n qd)^2 / 2: M gains n^2 J.
// Numbers of at most 20 after a handful of roundings: 1e-14.
TEST(Textbook, PendulumWithAGearedMotor) {
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.3), zero = Eigen::VectorXd::Zero(1),
                        v = Eigen::VectorXd::Constant(1, 1.5), a = Eigen::VectorXd::Constant(1, 2);
  const double weight = 2 * 9.81 * 0.5 * std::sin(0.3), alone = 2 * 0.25;
  for (const double ratio : {50.0, -50.0, 0.5}) {
    Model model;
    model.addJoint(0, JointModelRX(), SE3(), "swing");
    model.appendBodyToJoint(1, Inertia(2, Eigen::Vector3d(0, 0, -0.5), Eigen::Matrix3d::Zero()));
    model.rotorInertia[0] = 1e-3;
    model.rotorGearRatio[0] = ratio;
    for (const bool rotor : {true, false}) {
      model.terms.rotor = rotor;
      const double M = alone + (rotor ? ratio * ratio * 1e-3 : 0);
      Data data(model);
      EXPECT_NEAR(crba(model, data, q)(0, 0), M, 1e-14) << ratio;
      EXPECT_NEAR(computeMinverse(model, data, q)(0, 0), 1 / M, 1e-14) << ratio;
      EXPECT_NEAR(rnea(model, data, q, v, a)[0], M * 2 + weight, 1e-14) << ratio;
      EXPECT_NEAR(aba(model, data, q, v, zero)[0], -weight / M, 1e-14) << ratio;
      EXPECT_NEAR(computeKineticEnergy(model, data, q, v), M * 1.5 * 1.5 / 2, 1e-14) << ratio;
      EXPECT_NEAR(nonLinearEffects(model, data, q, v)[0], weight, 1e-14) << ratio;
    }
  }
}

TEST(Textbook, LiftHoldsItsWeight) {
  Model model;
  model.addJoint(0, JointModelPZ(), SE3(), "lift");
  model.appendBodyToJoint(1, Inertia::FromSphere(3, 0.1));
  Data data(model);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 7.0);
  EXPECT_NEAR(computeGeneralizedGravity(model, data, q)[0], 3 * 9.81, 1e-14);
  EXPECT_NEAR(computePotentialEnergy(model, data, q), 3 * 9.81 * 7, 1e-12);
}

// A free body falls with g, and its spin follows Euler's equation I w' = - w x I w.
TEST(Textbook, FreeBody) {
  Model model;
  model.addJoint(0, JointModelFreeFlyer(), SE3(), "body");
  const Eigen::Vector3d moments(1, 2, 2.5);
  model.appendBodyToJoint(1, Inertia(4, Eigen::Vector3d::Zero(), moments.asDiagonal()));
  Data data(model);
  testing::Random random(2);
  const Eigen::VectorXd q = randomConfiguration(model, random.engine);
  const Eigen::VectorXd v = random.vec(6);
  const Eigen::VectorXd a = aba(model, data, q, v, Eigen::VectorXd::Zero(6));
  const Eigen::Vector3d w = v.head<3>();
  const Eigen::Vector3d spin = (-w.cross(moments.cwiseProduct(w))).cwiseQuotient(moments);
  EXPECT_LE((a.head<3>() - spin).norm(), 1e-14);
  // in body axes the velocity of a body in free fall turns with it: v' = R' g - w x v
  forwardKinematics(model, data, q);
  const Eigen::Vector3d fall =
      data.oMi[1].rotation().transpose() * Eigen::Vector3d(0, 0, -9.81) - w.cross(v.tail<3>());
  EXPECT_LE((a.tail<3>() - fall).norm(), 1e-14);
}

// RK4 over a swinging double pendulum: the energy drifts by O(dt^4), so halving dt divides the drift by
// about 16.
TEST(Textbook, EnergyIsKeptToFourthOrder) {
  const Model model = Planar().model();
  Data data(model);
  const auto drift = [&](double dt, int steps) {
    Eigen::VectorXd q = Eigen::Vector2d(0.5, -0.3), v = Eigen::Vector2d(0, 0), zero = v;
    const auto energy = [&] {
      return computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q);
    };
    const double start = energy();
    for (int n = 0; n < steps; ++n) {
      const auto f = [&](const Eigen::VectorXd& x, const Eigen::VectorXd& y) -> Eigen::VectorXd {
        return aba(model, data, x, y, zero);
      };
      const Eigen::VectorXd a1 = f(q, v), v2 = v + dt / 2 * a1, a2 = f(q + dt / 2 * v, v2);
      const Eigen::VectorXd v3 = v + dt / 2 * a2, a3 = f(q + dt / 2 * v2, v3);
      const Eigen::VectorXd v4 = v + dt * a3, a4 = f(q + dt * v3, v4);
      q += dt / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    return std::abs(energy() - start);
  };
  const double coarse = drift(0.002, 1000), fine = drift(0.001, 2000);
  EXPECT_LT(fine, 1e-5);
  EXPECT_GT(coarse / fine, 8);
}

}  // namespace
}  // namespace rbd
