// Every name of the handbook's appendix A, once, meaning what its table says; and the API smoke test of its
// chapter 11. That a name exists is proven by compiling, that it means the right thing by a second road.
#include <gtest/gtest.h>
#include <rbd/rbd.h>
#include <rbd/urdf/urdf.h>

#include <Eigen/LU>
#include <memory>
#include <sstream>

#include "tests/core/algorithm/random_tree.h"
#include "tests/support/paths.h"

namespace rbd {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// numbers of order 1 to 100, a few hundred operations
constexpr double kTol = 1e-11;

class Handbook : public ::testing::Test {
 protected:
  void SetUp() override {
    buildModels::manipulator(model, false);
    data = std::make_unique<Data>(model);
    testing::Random random(11);
    q = random.vec(6, 2);
    v = random.vec(6);
    a = random.vec(6);
    tau = random.vec(6, 20);
  }
  Model model;
  std::unique_ptr<Data> data;
  VectorXd q, v, a, tau;
};

// table "building and loading"

TEST_F(Handbook, SampleModels) {
  EXPECT_EQ(model.name, "manipulator");
  EXPECT_EQ(model.nq, 6);
  EXPECT_EQ(model.nv, 6);
  EXPECT_EQ(model.njoints, 7);  // the universe is one
  EXPECT_EQ(model.nframes, 13);
  EXPECT_EQ(model.nbodies, 8);  // one a joint, the foot that stands on the ground, and the universe itself
  Model human;
  buildModels::humanoid(human, false);
  EXPECT_EQ(human.nq, 37);
  EXPECT_EQ(human.nv, 36);
  Data one(human);
  auto other = human.createData();
  EXPECT_EQ(one.oMf.size(), other.oMf.size());
}

// The second argument: some joints follow others.
TEST_F(Handbook, SampleModelsWithMimic) {
  Model linkage, squats;
  buildModels::manipulator(linkage, true);
  buildModels::humanoid(squats, true);
  EXPECT_EQ(linkage.nq, 5);
  EXPECT_EQ(linkage.njoints, model.njoints);
  Data follows(linkage);
  VectorXd six = q;
  six[5] = -q[3];  // the tool keeps its roll
  forwardKinematics(linkage, follows, q.head(5));
  forwardKinematics(model, *data, six);
  for (FrameIndex f = 0; f < model.nframes; ++f) EXPECT_TRUE(follows.oMf[f].isApprox(data->oMf[f], kTol));

  EXPECT_EQ(squats.nq, 33);
  EXPECT_EQ(squats.nv, 32);
  Data legs(squats);
  VectorXd pose = neutral(squats);
  pose[squats.joints[squats.jointId("left_hip_pitch")].idx_q()] = 0.6;
  forwardKinematics(squats, legs, pose);
  const SE3& ankle = legs.oMi[squats.jointId("left_ankle_roll")];
  // thigh 0.38 m and shin 0.36 m, one tilted forwards and one backwards; the foot stays level
  EXPECT_NEAR(ankle.translation().z(), -0.08 - 0.74 * std::cos(0.6), kTol);
  EXPECT_LE((ankle.rotation() - Matrix3d::Identity()).norm(), kTol);
}

TEST_F(Handbook, AddJointAndAddFrame) {
  Model arm;
  const JointIndex base = arm.addJoint(JointIndex(0), JointModelRZ(), SE3::Identity(), "base");
  const JointIndex elbow =
      arm.addJoint(base, JointModelRY(), SE3(Matrix3d::Identity(), Vector3d(0, 0, 0.5)), "elbow");
  const SE3 tip_placement(Matrix3d::Identity(), Vector3d(0, 0.3, 0));
  const FrameIndex tip = arm.addFrame(Frame("tip", elbow, tip_placement, OP_FRAME));
  EXPECT_EQ(arm.getFrameId("tip"), tip);
  EXPECT_LT(arm.getFrameId("elbow"), arm.nframes);  // addJoint has added a frame of its name
  EXPECT_EQ(arm.getFrameId("nowhere"), arm.nframes);
  EXPECT_EQ(arm.frames[tip].name, "tip");
  EXPECT_EQ(arm.frames[tip].type, OP_FRAME);
  EXPECT_EQ(arm.frames[tip].parentJoint, elbow);
  EXPECT_TRUE(arm.frames[tip].placement.isApprox(tip_placement, 0));
  for (const FrameType type : {OP_FRAME, JOINT, BODY, SENSOR, FIXED_JOINT}) {
    EXPECT_STRNE(frameTypeName(type), "");
  }
}

TEST_F(Handbook, Urdf) {
  const std::string file = lab::source_path("models/simple_3dof_arm.urdf");
  Model one, two, three;
  GeometryModel shapes;
  urdf::buildModel(file, one);
  urdf::buildModelsFromUrdf(file, {}, three, shapes);
  EXPECT_EQ(one.name, "simple_3dof_arm");
  EXPECT_EQ(one.nq, 3);
  EXPECT_EQ(shapes.visual.size(), 4u);
  EXPECT_EQ(three.nframes, one.nframes);
  urdf::buildModelFromXML("<robot name='r'><link name='l'/></robot>", two);
  EXPECT_EQ(two.nq, 0);
  try {  // the handbook's programs catch std::exception and print what()
    urdf::buildModel("no such file.urdf", one);
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("no such file.urdf"), std::string::npos);
  }
}

// table "properties of a model"

TEST_F(Handbook, Properties) {
  const char* const kinds[] = {"FIXED", "RZ", "RY", "RY", "RZ", "RY", "RZ"};
  for (JointIndex i = 0; i < model.njoints; ++i) {
    EXPECT_EQ(model.joints[i].shortname(), kinds[i]);
    EXPECT_EQ(model.joints[i].nq(), i > 0);
    EXPECT_EQ(model.joints[i].nv(), i > 0);
    EXPECT_EQ(model.parents[i], std::max(0, i - 1));
  }
  EXPECT_EQ(model.jointPlacements[3].translation(), Vector3d(0, 0, 0.45));
  const auto& inertia = model.inertias[2];
  EXPECT_EQ(inertia.mass(), 5);
  EXPECT_EQ(inertia.lever(), Vector3d(0, 0, 0.225));
  EXPECT_GT(inertia.inertia()(0, 0), 0);
  EXPECT_LT(model.getFrameId("arm_tool_link"), model.nframes);
  EXPECT_LT(model.getFrameId("arm_base_link"), model.nframes);
  EXPECT_LT(model.getFrameId("effector_body"), model.nframes);
  EXPECT_EQ(data->joints.size(), 7u);
  forwardKinematics(model, *data, q);
  EXPECT_EQ(data->joints[1].joint_q()[0], q[0]);
  EXPECT_EQ(data->q_in, q);
}

// table "kinematics"

TEST_F(Handbook, ForwardKinematics) {
  EXPECT_EQ(neutral(model), VectorXd::Zero(6));
  forwardKinematics(model, *data, q);
  EXPECT_TRUE(data->oMi[0].isApprox(SE3::Identity(), 0));
  const FrameIndex base = model.getFrameId("arm_base_link"), tool = model.getFrameId("arm_tool_link");
  const SE3 tool_in_base = data->oMf[base].inverse() * data->oMf[tool];
  const Vector3d point = data->oMf[base].inverse().actOnEigenObject(data->oMf[tool].translation());
  EXPECT_LE((tool_in_base.translation() - point).norm(), kTol);
  const SE3 by_joint = data->oMi[6] * model.frames[tool].placement;
  EXPECT_TRUE(data->oMf[tool].isApprox(by_joint, kTol));
}

TEST_F(Handbook, VelocitiesAndJacobians) {
  forwardKinematics(model, *data, q, v);
  const Motion& spatial = data->v[6];
  computeJointJacobians(model, *data, q);
  const auto& J = data->J;
  EXPECT_EQ(J.rows(), 6);
  EXPECT_EQ(J.cols(), 6);
  const FrameIndex tool = model.getFrameId("arm_tool_link");
  for (const ReferenceFrame reference : {WORLD, LOCAL, LOCAL_WORLD_ALIGNED}) {
    const MatrixXd Jj = getJointJacobian(model, *data, 6, reference);
    const MatrixXd Jf = getFrameJacobian(model, *data, tool, reference);
    const Motion velocity = getFrameVelocity(model, *data, tool, reference);
    EXPECT_LE((Jf * v - velocity.toVector()).norm(), kTol);
    const Motion moving = getVelocity(model, *data, 6, reference);
    EXPECT_LE((Jj * v - moving.toVector()).norm(), kTol);
  }
  EXPECT_EQ(spatial, getVelocity(model, *data, 6, LOCAL));
  // the arm is one chain: here the columns of data.J are the last joint's Jacobian, in WORLD
  EXPECT_LE((getJointJacobian(model, *data, 6, WORLD) - MatrixXd(J)).norm(), kTol);
  const Motion qualified = getFrameVelocity(model, *data, tool, ReferenceFrame::WORLD);
  EXPECT_EQ(qualified, getFrameVelocity(model, *data, tool, WORLD));
}

TEST_F(Handbook, CentreOfMass) {
  const VectorXd step = 1e-6 * v;
  const Vector3d after = centerOfMass(model, *data, q + step), before = centerOfMass(model, *data, q - step);
  const MatrixXd J = jacobianCenterOfMass(model, *data, q);
  EXPECT_EQ(J.rows(), 3);
  EXPECT_LE((J * v - (after - before) / 2e-6).norm(), 1e-8);  // central difference: h^2 and eps / h
}

// table "dynamics"

TEST_F(Handbook, Dynamics) {
  const VectorXd g = computeGeneralizedGravity(model, *data, q);
  EXPECT_EQ(data->g, g);
  nonLinearEffects(model, *data, q, v);
  const VectorXd b = data->nle;
  computeMinverse(model, *data, q);
  const MatrixXd Minv = data->Minv, M = crba(model, *data, q);
  EXPECT_LE((Minv * M - MatrixXd::Identity(6, 6)).norm(), kTol);  // the inverse, and both sides of it filled
  EXPECT_LE((rnea(model, *data, q, v, a) - (M * a + b)).norm(), kTol);
  EXPECT_LE((rnea(model, *data, q, VectorXd::Zero(6), a) - (M * a + g)).norm(), kTol);
  EXPECT_LE((aba(model, *data, q, v, tau) - Minv * (tau - b)).norm(), kTol);
}

// What its listings write works on our fields too, and does what Eigen says: the inverse of Minv is M, and
// solving with Minv multiplies by M (its chapters 8.2 and 10.2 meant Minv times x, which is aba's answer).
TEST_F(Handbook, ListingsWithMinv) {
  computeMinverse(model, *data, q);
  const MatrixXd M = data->Minv.inverse();
  EXPECT_LE((M - crba(model, *data, q)).norm(), kTol);
  const VectorXd solved = data->Minv.fullPivLu().solve(tau);
  EXPECT_LE((solved - M * tau).norm(), 1e3 * kTol);
  nonLinearEffects(model, *data, q, v);
  const VectorXd a_by_hand = data->Minv * (tau - data->nle);
  EXPECT_LE((a_by_hand - aba(model, *data, q, v, tau)).norm(), kTol);
  computeJointJacobians(model, *data, q);
  const VectorXd world = data->J * v;
  const Vector3d linear = data->J.block(3, 0, 3, data->J.cols()) * v;
  EXPECT_LE((world.tail<3>() - linear).norm(), kTol);
}

TEST_F(Handbook, CentroidalMomentum) {
  // the handbook's order of calls: places, then velocities, then momentum
  forwardKinematics(model, *data, q);
  forwardKinematics(model, *data, q, v);
  computeCentroidalMomentum(model, *data);
  const Force h = data->hg;
  centerOfMass(model, *data, q, v);
  EXPECT_LE((h.linear() - data->mass[0] * data->vcom[0]).norm(), kTol);
  computeCentroidalMomentumTimeVariation(model, *data);
  const Force rate = data->dhg;
  const auto at = [&](double t) { return Force(computeCentroidalMomentum(model, *data, q + t * v, v)); };
  EXPECT_TRUE(rate.isApprox((at(1e-5) - at(-1e-5)) * 5e4, 1e-7));
}

// table "types"

TEST_F(Handbook, Types) {
  const Matrix3d quarter = Eigen::AngleAxisd(PI<double>() / 2.0, Vector3d::UnitZ()).toRotationMatrix();
  const SE3 T(quarter, Vector3d(1, 0, 0)), one = SE3::Identity();
  EXPECT_TRUE((T * T.inverse()).isApprox(one, kTol));
  EXPECT_LE((T.actOnEigenObject(Vector3d(1, 0, 0)) - Vector3d(1, 1, 0)).norm(), kTol);
  EXPECT_EQ(T.toHomogeneousMatrix().topLeftCorner(3, 3), T.rotation());
  EXPECT_EQ(T.toHomogeneousMatrix().topRightCorner(3, 1), T.translation());

  Force weight;
  weight.linear(Vector3d(0, 0, -9.8));
  weight.angular(Vector3d::Zero());
  EXPECT_EQ(weight.linear(), Vector3d(0, 0, -9.8));
  EXPECT_EQ(weight.angular(), Vector3d::Zero());
  const Motion fall(Vector3d::Zero(), Vector3d(0, 0, -2));
  EXPECT_NEAR(fall.dot(weight), 19.6, kTol);
  EXPECT_EQ(fall.toVector().tail<3>(), fall.linear());  // angular first
  EXPECT_EQ(fall.toVector().head<3>(), fall.angular());
  const Inertia ball = Inertia::FromSphere(2, 0.1);
  EXPECT_EQ((ball * fall).linear(), Vector3d(0, 0, -4));

  const JointModel joints[] = {JointModelRX(), JointModelRY(), JointModelRZ(),
                               JointModelPX(), JointModelPY(), JointModelPZ()};
  const char* const names[] = {"RX", "RY", "RZ", "PX", "PY", "PZ"};
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(joints[k].shortname(), names[k]);
    EXPECT_EQ(joints[k].axis(), Vector3d::Unit(k % 3));
  }
  EXPECT_EQ(JointModelFreeFlyer().nq(), 7);
  EXPECT_EQ(JointModelFreeFlyer().nv(), 6);
}

// Chapter 5.2 and 6.3: models and data are values that go anywhere values go.
TEST_F(Handbook, Values) {
  const auto by_value = [](Model copy) { return copy.njoints; };
  EXPECT_EQ(by_value(model), 7);
  const auto shared = std::make_shared<Model>();
  buildModels::manipulator(*shared, false);
  std::vector<Model> models(3, *shared);
  EXPECT_EQ(models[2].njoints, shared->njoints);
  auto owner = std::make_unique<Data>(*shared);
  const auto next = std::move(owner);
  EXPECT_FALSE(owner);
  EXPECT_EQ(rnea(*shared, *next, q, v, a), rnea(model, *data, q, v, a));
}

}  // namespace
}  // namespace rbd
