// The handbook's appendix D on two links in a plane: everything by formulas on one side, the core on the
// other.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::kEps;

constexpr double kGravity = 9.81;
// a dozen operations on numbers of order one, or of order 100 N m
constexpr double kTol = 100 * kEps, kEffortTol = 1e4 * kEps;

SE3 shift(double x, double y, double z) { return SE3(Eigen::Matrix3d::Identity(), Vector3d(x, y, z)); }

// D4: two links in the x-z plane, both joints about y; at q = 0 they stand upright. Link k: length l, centre
// of mass at c, mass m, inertia I about its centre.
struct Planar {
  double l1 = 0.5, c1 = 0.2, m1 = 3, I1 = 0.04, l2 = 0.4, c2 = 0.25, m2 = 2, I2 = 0.03;

  Model model() const {
    Model out;
    const auto body = [](double m, double I) {
      return Inertia(m, Vector3d::Zero(), Vector3d(0.02, I, 0.01).asDiagonal());
    };
    out.addJoint(0, JointModelRY(), SE3(), "shoulder");
    out.addJoint(1, JointModelRY(), shift(0, 0, l1), "elbow");
    out.appendBodyToJoint(1, body(m1, I1), shift(0, 0, c1));
    out.appendBodyToJoint(2, body(m2, I2), shift(0, 0, c2));
    out.addFrame(Frame("tip", 2, shift(0, 0, l2), OP_FRAME));
    return out;
  }
  Vector2d tip(const Vector2d& q) const {  // x, z
    return {l1 * std::sin(q[0]) + l2 * std::sin(q[0] + q[1]),
            l1 * std::cos(q[0]) + l2 * std::cos(q[0] + q[1])};
  }
  Eigen::Matrix2d J(const Vector2d& q) const {
    const double far_x = l2 * std::cos(q[0] + q[1]), far_z = -l2 * std::sin(q[0] + q[1]);
    return (Eigen::Matrix2d() << l1 * std::cos(q[0]) + far_x, far_x, -l1 * std::sin(q[0]) + far_z, far_z)
        .finished();
  }
  Eigen::Matrix2d M(const Vector2d& q) const {
    const double both = I2 + m2 * (c2 * c2 + l1 * c2 * std::cos(q[1])), far = I2 + m2 * c2 * c2;
    const double near = I1 + m1 * c1 * c1 + I2 + m2 * (l1 * l1 + c2 * c2 + 2 * l1 * c2 * std::cos(q[1]));
    return (Eigen::Matrix2d() << near, both, both, far).finished();
  }
  // Christoffel symbols of M: only M(., q2) varies.
  Eigen::Matrix2d C(const Vector2d& q, const Vector2d& v) const {
    const double h = -m2 * l1 * c2 * std::sin(q[1]);
    return (Eigen::Matrix2d() << h * v[1], h * (v[0] + v[1]), -h * v[0], 0).finished();
  }
  Vector2d gravity(const Vector2d& q) const {
    const double far = -m2 * c2 * kGravity * std::sin(q[0] + q[1]);
    return {-(m1 * c1 + m2 * l1) * kGravity * std::sin(q[0]) + far, far};
  }
  // Both ways to reach a point: the elbow bent by +angle or -angle (law of cosines).
  Vector2d reach(const Vector2d& point, double sign) const {
    const double bend = sign * std::acos((point.squaredNorm() - l1 * l1 - l2 * l2) / (2 * l1 * l2));
    return {std::atan2(point[0], point[1]) - std::atan2(l2 * std::sin(bend), l1 + l2 * std::cos(bend)), bend};
  }
};

class PlanarArm : public ::testing::Test {
 protected:
  Planar arm;
  Model model = arm.model();
  Data data{model};
  FrameIndex tip = model.frameId("tip");
  testing::Random random{4};

  Eigen::MatrixXd planarJacobian(const VectorXd& q) {  // rows x, z of the tip's velocity
    const Matrix6Xd J = computeFrameJacobian(model, data, q, tip, LOCAL_WORLD_ALIGNED);
    Eigen::MatrixXd out(2, 2);
    out << J.row(3), J.row(5);
    return out;
  }
};

TEST_F(PlanarArm, TipAndJacobian) {
  for (int n = 0; n < 20; ++n) {
    const Vector2d q = random.vec(2, 3), v = random.vec(2, 2);
    forwardKinematics(model, data, q, v);
    const Vector3d at = data.oMf[tip].translation();
    EXPECT_LE((at - Vector3d(arm.tip(q)[0], 0, arm.tip(q)[1])).norm(), kTol);
    const Vector2d moves = arm.J(q) * v;
    const Motion velocity = getFrameVelocity(model, data, tip, LOCAL_WORLD_ALIGNED);
    EXPECT_LE((velocity.linear() - Vector3d(moves[0], 0, moves[1])).norm(), kTol);
    EXPECT_LE((velocity.angular() - Vector3d(0, v[0] + v[1], 0)).norm(), kTol);
    EXPECT_LE((planarJacobian(q) - arm.J(q)).norm(), kTol);
    // det J = - l1 l2 sin q2: the arm cannot stretch further when it is straight, or folded
    EXPECT_NEAR(planarJacobian(q).determinant(), -arm.l1 * arm.l2 * std::sin(q[1]), kTol);
  }
}

// The second derivative of the tip's formula, with what turning adds (v^2 terms).
TEST_F(PlanarArm, AccelerationOfTheTip) {
  const Vector2d q(0.4, 0.9), v(1.5, -0.7), a(0.8, 2.0);
  const auto link = [](double l, double angle, double rate, double up) -> Vector2d {
    return {l * (std::cos(angle) * up - std::sin(angle) * rate * rate),
            -l * (std::sin(angle) * up + std::cos(angle) * rate * rate)};
  };
  const Vector2d by_hand =
      link(arm.l1, q[0], v[0], a[0]) + link(arm.l2, q[0] + q[1], v[0] + v[1], a[0] + a[1]);
  forwardKinematics(model, data, q, v, a);
  const Motion tip_moves = getFrameClassicalAcceleration(model, data, tip, LOCAL_WORLD_ALIGNED);
  EXPECT_LE((tip_moves.linear() - Vector3d(by_hand[0], 0, by_hand[1])).norm(), kTol);
  EXPECT_LE((tip_moves.angular() - Vector3d(0, a[0] + a[1], 0)).norm(), kTol);
  // the same by the Jacobian and its rate
  computeJointJacobiansTimeVariation(model, data, q, v);
  const Matrix6Xd J = getFrameJacobian(model, data, tip, LOCAL_WORLD_ALIGNED);
  const Matrix6Xd dJ = getFrameJacobianTimeVariation(model, data, tip, LOCAL_WORLD_ALIGNED);
  EXPECT_LE((J * a + dJ * v - tip_moves.toVector()).norm(), kTol);
}

TEST_F(PlanarArm, EquationOfMotion) {
  for (int n = 0; n < 20; ++n) {
    const Vector2d q = random.vec(2, 3), v = random.vec(2, 2), a = random.vec(2, 2);
    EXPECT_LE((crba(model, data, q) - arm.M(q)).norm(), kTol);
    EXPECT_LE((computeCoriolisMatrix(model, data, q, v) - arm.C(q, v)).norm(), kTol);
    EXPECT_LE((computeGeneralizedGravity(model, data, q) - arm.gravity(q)).norm(), kEffortTol);
    const Vector2d tau = arm.M(q) * a + arm.C(q, v) * v + arm.gravity(q);
    EXPECT_LE((rnea(model, data, q, v, a) - tau).norm(), kEffortTol);
    EXPECT_LE((aba(model, data, q, v, tau) - a).norm(), 100 * kEffortTol);  // M's condition is below 100
  }
}

// A force at the tip is held by tau = J' f: the elbow by lever arm times force.
TEST_F(PlanarArm, ForcesGoThroughTheTransposedJacobian) {
  model.gravity = Motion();
  const Vector2d q(0.4, 0.9), f(12, -7);
  const FrameWrenches push = {{tip, Force(Vector3d::Zero(), Vector3d(f[0], 0, f[1])), LOCAL_WORLD_ALIGNED}};
  const Vector2d tau = computeStaticTorque(model, data, q, push);
  EXPECT_LE((tau + arm.J(q).transpose() * f).norm(), kEffortTol);
  const Vector2d lever = arm.tip(q) - arm.l1 * Vector2d(std::sin(q[0]), std::cos(q[0]));
  EXPECT_NEAR(tau[1], -(lever[1] * f[0] - lever[0] * f[1]), kEffortTol);
}

// D1: q += J^T (J J^T + d^2)^-1 (target - tip), from anywhere, finds one of the two answers of the law of
// cosines.
TEST_F(PlanarArm, InverseKinematicsByIteration) {
  const Vector2d target(0.45, 0.3);
  const auto iterate = [&](VectorXd q, const Vector2d& to, double damping) {
    for (int k = 0; k < 1000; ++k) {
      const Eigen::Matrix2d J = planarJacobian(q);
      forwardKinematics(model, data, q);
      const Vector3d at = data.oMf[tip].translation();
      const Eigen::Matrix2d A = J * J.transpose() + damping * Eigen::Matrix2d::Identity();
      q += J.transpose() * A.inverse() * (to - Vector2d(at[0], at[2]));
    }
    return q;
  };
  int found[2] = {0, 0};
  for (int n = 0; n < 20; ++n) {
    const VectorXd q = iterate(random.vec(2, 3), target, 0.05);
    const int which = std::sin(q[1]) > 0 ? 0 : 1;
    const VectorXd wanted = arm.reach(target, which == 0 ? 1 : -1);
    // angles are equal up to whole turns
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(std::remainder(q[i] - wanted[i], 2 * PI<double>()), 0, 1e-9);
    ++found[which];
  }
  EXPECT_GT(found[0], 0);
  EXPECT_GT(found[1], 0);
  // out of reach, it ends straight and pointing at the target; so near a singular pose it wants more damping
  const Vector2d far(1.2, 0.9);
  const VectorXd q = iterate(Vector2d(0.3, 0.8), far, 1);
  EXPECT_LE((arm.tip(q) - (arm.l1 + arm.l2) * far.normalized()).norm(), 1e-9);
}

// D5: gravity compensation with masses wrong by half leaves kp * error = half of gravity; right masses leave
// nothing.
TEST_F(PlanarArm, WrongMassesSag) {
  const double kp = 60, kd = 12, dt = 0.002;
  const Vector2d goal(0.7, 0.4);
  const auto rest = [&](double scale) {
    Model believed = model;
    for (const JointIndex j : {1, 2}) believed.setInertia(j, model.inertias[j] * scale);
    Data own(believed);
    VectorXd q = Vector2d(0, 0), v = Vector2d(0, 0);
    for (int k = 0; k < 5000; ++k) {
      const VectorXd tau = kp * (goal - q) - kd * v + computeGeneralizedGravity(believed, own, q);
      v += dt * aba(model, data, q, v, tau);
      q += dt * v;
    }
    return Vector2d(q);
  };
  EXPECT_LE((rest(1) - goal).norm(), 1e-9);
  const Vector2d q = rest(0.5);
  EXPECT_LE((kp * (goal - q) - 0.5 * arm.gravity(q)).norm(), 1e-8);
  EXPECT_GT((q - goal).norm(), 0.01);
}

}  // namespace
}  // namespace rbd
