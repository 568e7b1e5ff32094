// The handbook's exercises on kinematics and dynamics (chapters 6 to 9), answered: the core on one side,
// formulas worked out by hand on the other. Appendix D's planar arm is in planar_arm_test.cc.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>

#include "rbd/urdf/urdf.h"
#include "tests/core/algorithm/random_tree.h"
#include "tests/support/paths.h"

namespace rbd {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::kEps;

constexpr double kGravity = 9.81;
// a dozen operations on numbers of order one, or of order 100 N m
constexpr double kTol = 100 * kEps, kEffortTol = 1e4 * kEps;

SE3 shift(double x, double y, double z) { return SE3(Eigen::Matrix3d::Identity(), Vector3d(x, y, z)); }

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
    std::ifstream file(lab::source_path("models/simple_3dof_arm.urdf"));
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
