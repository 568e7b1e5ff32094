// The handbook's exercises on kinematics and dynamics (chapters 6 to 9, appendix D), answered: the core on
// one side, formulas worked out by hand on the other.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <fstream>
#include <sstream>

#include "rbd/urdf/urdf.h"
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
  const auto iterate = [&](VectorXd q, const Vector2d& to, int steps) {
    for (int k = 0; k < steps; ++k) {
      const Eigen::Matrix2d J = planarJacobian(q);
      forwardKinematics(model, data, q);
      const Vector3d at = data.oMf[tip].translation();
      const Eigen::Matrix2d A = J * J.transpose() + 1e-4 * Eigen::Matrix2d::Identity();
      q += J.transpose() * A.inverse() * (to - Vector2d(at[0], at[2]));
    }
    return q;
  };
  int found[2] = {0, 0};
  for (int n = 0; n < 20; ++n) {
    const VectorXd q = iterate(random.vec(2, 3), target, 200);
    const int which = std::sin(q[1]) > 0 ? 0 : 1;
    const VectorXd wanted = arm.reach(target, which == 0 ? 1 : -1);
    // angles are equal up to whole turns
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(std::remainder(q[i] - wanted[i], 2 * PI<double>()), 0, 1e-9);
    ++found[which];
  }
  EXPECT_GT(found[0], 0);
  EXPECT_GT(found[1], 0);
  // out of reach, it ends stretched towards the target: straight, and pointing there
  const Vector2d far(1.2, 0.9);
  const VectorXd q = iterate(Vector2d(0.3, 0.8), far, 20000);
  EXPECT_LE((arm.tip(q) - (arm.l1 + arm.l2) * far.normalized()).norm(), 1e-3);
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

class SixAxes : public ::testing::Test {
 protected:
  void SetUp() override {
    buildModels::manipulator(model);
    data = std::make_unique<Data>(model);
    tool = model.frameId("arm_tool_link");
  }
  Eigen::Index rank(const VectorXd& q, ReferenceFrame reference = LOCAL_WORLD_ALIGNED) {
    Eigen::MatrixXd J = computeFrameJacobian(model, *data, q, tool, reference);
    return Eigen::FullPivLU<Eigen::MatrixXd>(J).setThreshold(1e-10).rank();
  }
  static VectorXd angles(double a, double b, double c, double d, double e, double f) {
    return (VectorXd(6) << a, b, c, d, e, f).finished();
  }
  Model model;
  std::unique_ptr<Data> data;
  FrameIndex tool = 0;
};

// 7.1: joint 1 at 2 rad/s carries the tool along a circle: speed 2 r. The columns of data.J are in WORLD,
// where the velocity is that of the body point at the origin, which is on the axis: it stands still. The trap
// of this exercise.
TEST_F(SixAxes, VelocityOfTheTool) {
  const VectorXd q = angles(0.3, 0.4, -0.2, 0.5, 0.6, 0.1), v = angles(2, 0, 0, 0, 0, 0);
  forwardKinematics(model, *data, q, v);
  computeJointJacobians(model, *data, q);
  const Vector3d at = data->oMf[tool].translation();
  const Vector3d circle = 2 * Vector3d(-at.y(), at.x(), 0);
  const Matrix6Xd J = getFrameJacobian(model, *data, tool, LOCAL_WORLD_ALIGNED);
  EXPECT_LE((J.bottomRows<3>() * v - circle).norm(), kTol);
  EXPECT_LE((getFrameVelocity(model, *data, tool, LOCAL_WORLD_ALIGNED).linear() - circle).norm(), kTol);
  const Vector3d world = data->J.bottomRows<3>() * v;
  EXPECT_LE(world.norm(), kTol);
  EXPECT_LE(getFrameVelocity(model, *data, tool, WORLD).linear().norm(), kTol);
  EXPECT_GT(circle.norm(), 0.5);
}

// 7.2: the three singularities of an arm with a spherical wrist, and the direction that each loses.
TEST_F(SixAxes, Singularities) {
  const VectorXd good = angles(0.3, 0.4, -0.2, 0.5, 0.6, 0.1);
  EXPECT_EQ(rank(good), 6);
  EXPECT_EQ(rank(neutral(model)), 5);  // the wrist is straight

  // wrist straight: joints 4 and 6 share an axis
  VectorXd q = good;
  q[4] = 0;
  for (const ReferenceFrame reference : {WORLD, LOCAL, LOCAL_WORLD_ALIGNED}) EXPECT_EQ(rank(q, reference), 5);
  const Matrix6Xd J = computeFrameJacobian(model, *data, q, tool, LOCAL_WORLD_ALIGNED);
  EXPECT_LE((J.col(3) - J.col(5)).norm(), kTol);

  // elbow stretched: the wrist's centre cannot move along the arm
  q = good;
  q[2] = -PI<double>() / 2;
  EXPECT_EQ(rank(q), 5);
  computeJointJacobians(model, *data, q);
  const Vector3d along = (data->oMi[5].translation() - data->oMi[2].translation()).normalized();
  const Matrix6Xd wrist = getJointJacobian(model, *data, 5, LOCAL_WORLD_ALIGNED);
  EXPECT_LE((along.transpose() * wrist.bottomRows<3>()).norm(), kTol);

  // wrist's centre above joint 1: it cannot move across the arm's plane. 0.45 sin(q2) + 0.40 cos(q2 + q3) = 0
  q = good;
  q[2] = std::acos(-0.45 / 0.40 * std::sin(q[1])) - q[1];
  EXPECT_EQ(rank(q), 5);
  computeJointJacobians(model, *data, q);
  EXPECT_LE(data->oMi[5].translation().head<2>().norm(), kTol);
  const Vector3d across(-std::sin(q[0]), std::cos(q[0]), 0);
  const Matrix6Xd above = getJointJacobian(model, *data, 5, LOCAL_WORLD_ALIGNED);
  EXPECT_LE((across.transpose() * above.bottomRows<3>()).norm(), kTol);
}

// 8.1: the arm stretched and tilted by an angle: the shoulder holds weights times horizontal levers.
TEST_F(SixAxes, TheLeverLaw) {
  // masses and their distances from the shoulder, docs/sample_models.md
  const double moment = 5.0 * 0.225 + 2.5 * 0.55 + 2.0 * 0.75 + 1.0 * 0.90 + 0.5 * 0.99;
  double last = -1;
  for (const double tilt : {0.0, 0.3, 0.6, 0.9, 1.2, PI<double>() / 2}) {
    const VectorXd g = computeGeneralizedGravity(model, *data, angles(0.7, tilt, -PI<double>() / 2, 0, 0, 0));
    EXPECT_NEAR(g[1], -moment * kGravity * std::sin(tilt), kEffortTol);
    EXPECT_NEAR(g[0], 0, kEffortTol);  // a vertical axis feels no weight
    EXPECT_GT(-g[1], last);            // the more level, the heavier
    last = -g[1];
  }
}

// 6.1: a fourth joint, about x, 0.3 m along y behind the elbow.
TEST(Exercises, OneMoreJoint) {
  Model model;
  model.addJoint(0, JointModelRZ(), SE3(), "base");
  model.addJoint(1, JointModelRY(), shift(0, 0, 0.5), "shoulder");
  model.addJoint(2, JointModelRY(), shift(0, 0.4, 0), "elbow");
  const int before[] = {model.njoints, model.nq, model.nv, model.nframes};
  model.addJoint(3, JointModelRX(), shift(0, 0.3, 0), "wrist");
  EXPECT_EQ(model.njoints, before[0] + 1);
  EXPECT_EQ(model.nq, before[1] + 1);
  EXPECT_EQ(model.nv, before[2] + 1);
  EXPECT_EQ(model.nframes, before[3] + 1);
  Data data(model);
  forwardKinematics(model, data, neutral(model));
  EXPECT_LE((data.oMi[4].translation() - Vector3d(0, 0.7, 0.5)).norm(), kTol);
}

// 8.2: one joint under PD is a damped oscillator: it overshoots by exp(-pi zeta / sqrt(1 - zeta^2)) of the
// step.
TEST(Exercises, OvershootOfPd) {
  Model model;
  model.addJoint(0, JointModelRZ(), SE3(), "joint");  // vertical: no gravity
  const double I = 0.5, kp = 50, dt = 1e-5;
  model.appendBodyToJoint(1, Inertia(1, Vector3d::Zero(), I * Eigen::Matrix3d::Identity()));
  Data data(model);
  for (const double kd : {0.2, 2.0, 5.0}) {
    VectorXd q = VectorXd::Zero(1), v = q;
    double highest = 0;
    for (int k = 0; k < 50000; ++k) {
      v += dt * aba(model, data, q, v, VectorXd::Constant(1, kp * (1 - q[0]) - kd * v[0]));
      q += dt * v;
      highest = std::max(highest, q[0]);
    }
    const double zeta = kd / (2 * std::sqrt(kp * I));
    EXPECT_NEAR(highest - 1, std::exp(-PI<double>() * zeta / std::sqrt(1 - zeta * zeta)), 1e-3)
        << kd;  // O(dt) of Euler
  }
}

// 8.3: semi-implicit Euler with PD is a linear recursion; its roots leave the unit circle at  h d + h^2 k / 2
// = 2 (d = kd / I, k = kp / I). Just below it every swing shrinks, just above it grows.
TEST(Exercises, LongestStableTimeStep) {
  Model model;
  model.addJoint(0, JointModelRZ(), SE3(), "joint");
  const double I = 0.25, kp = 50, kd = 10;
  model.appendBodyToJoint(1, Inertia(1, Vector3d::Zero(), I * Eigen::Matrix3d::Identity()));
  Data data(model);
  const double d = kd / I, k = kp / I, limit = (std::sqrt(d * d + 4 * k) - d) / k;
  const auto after = [&](double dt) {
    VectorXd q = VectorXd::Constant(1, 1), v = VectorXd::Zero(1);
    for (int n = 0; n < 2000; ++n) {
      v += dt * aba(model, data, q, v, -kp * q - kd * v);
      q += dt * v;
    }
    return std::abs(q[0]) + dt * std::abs(v[0]);
  };
  EXPECT_LT(after(0.98 * limit), 1e-6);
  EXPECT_GT(after(1.02 * limit), 1e6);
  EXPECT_LT(limit * kd, 2 * I);  // the rule of thumb dt kd < 2 M is the bound without kp
}

// 8.4: the centre of mass is a point; its Jacobian is what the links' points add up to.
TEST_F(SixAxes, CentreOfMassHasThreeRows) {
  const VectorXd q = angles(0.3, 0.4, -0.2, 0.5, 0.6, 0.1);
  computeJointJacobians(model, *data, q);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, 6);
  double mass = 0;
  for (JointIndex i = 1; i < model.njoints; ++i) {
    const Matrix6Xd J = getJointJacobian(model, *data, i, LOCAL_WORLD_ALIGNED);
    const Vector3d arm = data->oMi[i].rotation() * model.inertias[i].lever();
    sum += model.inertias[i].mass() * (J.bottomRows<3>() - skew(arm) * J.topRows<3>());
    mass += model.inertias[i].mass();
  }
  EXPECT_LE((jacobianCenterOfMass(model, *data, q) - sum / mass).norm(), kTol);
}

// 9.1 to 9.3: changes of the URDF arm.
class UrdfArm : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ifstream file(LCMLAB_MODELS "/simple_3dof_arm.urdf");
    std::stringstream all;
    all << file.rdbuf();
    text = all.str();
  }
  // The file with one piece of text replaced.
  Model with(const std::string& from, const std::string& to) const {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    changed.replace(at, from.size(), to);
    Model model;
    urdf::buildModelFromXML(changed, model);
    return model;
  }
  static Eigen::VectorXd gravity(const Model& model) {
    Data data(model);
    return computeGeneralizedGravity(model, data, Vector3d(0.3, 0.8, -0.5));
  }
  std::string text;
};

TEST_F(UrdfArm, HeavierLinks) {
  const VectorXd g = gravity(with("5.0", "5.0"));
  // link1 turns about a vertical axis and hangs on no other: ten times its mass changes no effort at all
  EXPECT_LE((gravity(with("<mass value=\"5.0\"/>", "<mass value=\"50.0\"/>")) - g).norm(), kTol);
  // the shoulder lifts link2: 0.2 m level arm at sin(0.8), 27 kg more
  const VectorXd heavy = gravity(with("<mass value=\"3.0\"/>", "<mass value=\"30.0\"/>"));
  EXPECT_NEAR(heavy[1] - g[1], -27 * kGravity * 0.2 * std::sin(0.8), kEffortTol);
  EXPECT_NEAR(heavy[2], g[2], kTol);
}

TEST_F(UrdfArm, OneMoreJoint) {
  const std::string wrist =
      "<link name='hand'><inertial><mass value='0.2'/><inertia ixx='1e-4' ixy='0' ixz='0' iyy='1e-4' iyz='0' "
      "izz='1e-4'/></inertial></link><joint name='joint4_wrist' type='revolute'><origin xyz='0 0 0.05'/>"
      "<parent link='end_effector'/><child link='hand'/><axis xyz='0 0 1'/>"
      "<limit lower='-3' upper='3' effort='5' velocity='5'/></joint></robot>";
  const Model model = with("</robot>", wrist);
  EXPECT_EQ(model.nq, 4);
  EXPECT_EQ(model.joints[4].shortname(), "RZ");
}

TEST_F(UrdfArm, AnotherAxisAnotherPlane) {
  const auto tip = [](const Model& model) -> Vector3d {
    Data data(model);
    forwardKinematics(model, data, Vector3d(0, 0.8, 0));
    return data.oMf[model.frameId("end_effector")].translation();
  };
  const double out = 0.4 * std::sin(0.8), up = 0.55 + 0.4 * std::cos(0.8);
  EXPECT_LE((tip(with("0 1 0", "0 1 0")) - Vector3d(out, 0, up)).norm(), kTol);   // about y: the x-z plane
  EXPECT_LE((tip(with("0 1 0", "1 0 0")) - Vector3d(0, -out, up)).norm(), kTol);  // about x: the y-z plane
}

}  // namespace
}  // namespace rbd
