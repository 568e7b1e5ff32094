// What a user gets for a mistake: one clear line, in Release too.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "tests/core/algorithm/random_tree.h"
#include "tests/core/error_of.h"

namespace rbd {
namespace {

using testing::errorOf;

#define EXPECT_SAYS(text, call) \
  EXPECT_NE(errorOf([&] { call; }).find(text), std::string::npos) << errorOf([&] { call; })

class Errors : public ::testing::Test {
 protected:
  void SetUp() override { buildModels::manipulator(model); }
  Model model;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(6), y = Eigen::VectorXd::Zero(5);
};

TEST_F(Errors, SizesAreNamed) {
  Data data(model);
  EXPECT_SAYS("rnea: v has 5 entries, model 'manipulator' needs 6 (nv)", rnea(model, data, x, y, x));
  EXPECT_SAYS("rnea: a has 5", rnea(model, data, x, x, y));
  EXPECT_SAYS("nonLinearEffects: q has 5", nonLinearEffects(model, data, y, x));
  EXPECT_SAYS("computeGeneralizedGravity: q has 5", computeGeneralizedGravity(model, data, y));
  EXPECT_SAYS("crba: q has 5", crba(model, data, y));
  EXPECT_SAYS("aba: tau has 5", aba(model, data, x, x, y));
  EXPECT_SAYS("computeMinverse: q has 5", computeMinverse(model, data, y));
  EXPECT_SAYS("forwardKinematics: q has 5", forwardKinematics(model, data, y));
  EXPECT_SAYS("forwardKinematics: v has 5", forwardKinematics(model, data, x, y));
  EXPECT_SAYS("forwardKinematics: a has 5", forwardKinematics(model, data, x, x, y));
  EXPECT_SAYS("computeJointJacobians: q has 5", computeJointJacobians(model, data, y));
  EXPECT_SAYS("centerOfMass: q has 5", centerOfMass(model, data, y));
  EXPECT_SAYS("jacobianCenterOfMass: q has 5", jacobianCenterOfMass(model, data, y));
  EXPECT_SAYS("computeCentroidalMomentum: v has 5", computeCentroidalMomentum(model, data, x, y));
  EXPECT_SAYS("computeKineticEnergy: v has 5", computeKineticEnergy(model, data, x, y));
  EXPECT_SAYS("computePotentialEnergy: q has 5", computePotentialEnergy(model, data, y));
  EXPECT_SAYS("integrate: v has 5", integrate(model, x, y));
  EXPECT_SAYS("difference: q1 has 5", difference(model, x, y));
  EXPECT_SAYS("interpolate: q0 has 5", interpolate(model, y, x, 0.5));
  Eigen::MatrixXd J(6, 5);
  EXPECT_SAYS("getJointJacobian: output J is 6 x 5, it must be 6 x 6",
              getJointJacobian(model, data, 1, WORLD, J));
  EXPECT_SAYS("rnea: tau has 5", rnea(model, data, x, x, x, y));
  EXPECT_SAYS("crba: output M is 6 x 5", crba(model, data, x, J));
}

// Vectors of the model that anybody may write.
TEST_F(Errors, SizesOfTheModelsOwnVectors) {
  Data data(model);
  for (Eigen::VectorXd Model::* list :
       {&Model::armature, &Model::rotorInertia, &Model::rotorGearRatio, &Model::damping, &Model::friction}) {
    Model broken = model;
    (broken.*list).setZero(3);
    EXPECT_SAYS("has 3 entries, model 'manipulator' needs 6 (nv)", crba(broken, data, x));
    EXPECT_SAYS("rnea: model.", rnea(broken, data, x, x, x));
    EXPECT_SAYS("aba: model.", aba(broken, data, x, x, x));
  }
  Model broken = model;
  broken.lowerPositionLimit.setZero(2);
  EXPECT_SAYS("randomConfiguration: lower has 2", randomConfiguration(broken));
}

TEST_F(Errors, IndicesAreNamed) {
  Data data(model);
  forwardKinematics(model, data, x, x);
  for (const FrameIndex frame : {-1, 13}) {
    const std::string text =
        "frame index " + std::to_string(frame) + " does not exist, model 'manipulator' has 13";
    EXPECT_SAYS(text, updateFramePlacement(model, data, frame));
    EXPECT_SAYS(text, getFrameJacobian(model, data, frame, WORLD));
    EXPECT_SAYS(text, rnea(model, data, x, x, x, {{frame, Force(), LOCAL}}));
    EXPECT_SAYS(text, aba(model, data, x, x, x, {{frame, Force(), LOCAL}}));
  }
  for (const JointIndex joint : {-1, 7})
    EXPECT_SAYS("joint index " + std::to_string(joint) + " does not exist, model 'manipulator' has 7",
                getVelocity(model, data, joint, LOCAL));
  EXPECT_SAYS("frame index 13 does not exist", getFrameVelocity(model, data, 13, WORLD));
  EXPECT_SAYS("joint index -1 does not exist", getJointJacobian(model, data, -1, WORLD));
}

TEST_F(Errors, NumbersThatAreNone) {
  Data data(model);
  Eigen::VectorXd bad = x;
  bad[3] = std::nan("");
  EXPECT_SAYS("rnea: q[3] is nan", rnea(model, data, bad, x, x));
  bad[3] = -INFINITY;
  EXPECT_SAYS("aba: tau[3] is -inf", aba(model, data, x, x, bad));
  EXPECT_SAYS("integrate: v[3] is -inf", integrate(model, x, bad));
}

TEST_F(Errors, ForeignOrStaleData) {
  Model other;
  buildModels::humanoid(other);
  Data data(other);
  EXPECT_SAYS("rnea: this Data was made for another model", rnea(model, data, x, x, x));
  // same sizes, another tree
  Model turned;
  for (int i = 0; i < 6; ++i) turned.addJoint(0, JointModelRZ(), SE3(), "j" + std::to_string(i));
  Data same_sizes(turned);
  EXPECT_SAYS("crba: this Data", crba(model, same_sizes, x));
  Data old(model);
  model.addFrame(Frame("late", 1, SE3(), OP_FRAME));
  EXPECT_SAYS("was extended", forwardKinematics(model, old, x));
}

TEST_F(Errors, OrderOfCalls) {
  Data data(model);
  forwardKinematics(model, data, x);
  EXPECT_SAYS("getFrameVelocity: call forwardKinematics(model, data, q, v) first",
              getFrameVelocity(model, data, 1, WORLD));
  EXPECT_SAYS("computeCentroidalMomentum: call", computeCentroidalMomentum(model, data));
}

TEST_F(Errors, ZeroQuaternion) {
  Model other;
  buildModels::humanoid(other);
  Data data(other);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(37), v = Eigen::VectorXd::Zero(36);
  EXPECT_SAYS("the quaternion of joint 'root_joint' (q[3] to q[6]) is zero",
              forwardKinematics(other, data, zero));
  EXPECT_SAYS("integrate: the quaternion", integrate(other, zero, v));
}

// Every kind that has a part of unit length, in every function that takes q.
TEST(UnitParts, ZeroIsNamed) {
  for (const bool planar : {false, true}) {
    Model model;
    model.addJoint(0, JointModelRX(), SE3(), "arm");
    model.addJoint(1, planar ? JointModel(JointModelPlanar()) : JointModel(JointModelSpherical()), SE3(),
                   "part");
    model.appendBodyToJoint(1, Inertia::FromSphere(1, 0.1));
    model.appendBodyToJoint(2, Inertia::FromSphere(1, 0.1));
    Data data(model);
    const Eigen::VectorXd q = Eigen::VectorXd::Zero(5), v = Eigen::VectorXd::Zero(4);
    const std::string text = planar ? "the cosine and sine of joint 'part' (q[3] to q[4]) are zero"
                                    : "the quaternion of joint 'part' (q[1] to q[4]) is zero";
    EXPECT_SAYS("rnea: " + text, rnea(model, data, q, v, v));
    EXPECT_SAYS("crba: " + text, crba(model, data, q));
    EXPECT_SAYS("aba: " + text, aba(model, data, q, v, v));
    EXPECT_SAYS("computeMinverse: " + text, computeMinverse(model, data, q));
    EXPECT_SAYS("computeJointJacobians: " + text, computeJointJacobians(model, data, q));
    EXPECT_SAYS("centerOfMass: " + text, centerOfMass(model, data, q));
    EXPECT_SAYS("difference: " + text, difference(model, q, neutral(model)));
    EXPECT_SAYS("distance: " + text, rbd::distance(model, neutral(model), q));
    EXPECT_SAYS("dIntegrate: " + text, dIntegrate(model, q, v, ARG0));
    Eigen::VectorXd out = q;
    EXPECT_SAYS("normalize: " + text, normalize(model, out));
  }
}

// The dof belongs to the leader, wherever its followers stand.
TEST(Singular, FollowersAreNotBlamed) {
  Model model;
  model.addJoint(0, JointModelRX(), SE3(), "follower");
  model.addJoint(1, JointModelRY(), SE3(), "empty");
  model.addJoint(2, JointModelRZ(), SE3(), "leader");
  model.appendBodyToJoint(3, Inertia::FromSphere(1, 0.1));
  model.setMimic(1, 3);
  model.setInertia(3, Inertia());
  Data data(model);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(2);
  model.armature << 0, 1;
  EXPECT_SAYS("joint 'empty' moves is singular", aba(model, data, zero, zero, zero));
  model.armature << 1, 0;
  EXPECT_SAYS("joint 'leader' moves is singular", aba(model, data, zero, zero, zero));
}

TEST(Vectors, NumbersOfTheModelThatAreNotFiniteAreNamed) {
  Model model;
  buildModels::manipulator(model);
  model.terms.damping = true;
  Data data(model);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
  model.damping[2] = NAN;
  EXPECT_SAYS("rnea: model.damping[2] is nan", rnea(model, data, zero, zero, zero));
  model.damping[2] = 0;
  model.armature[5] = INFINITY;
  EXPECT_SAYS("rnea: model.armature[5] is inf", rnea(model, data, zero, zero, Eigen::VectorXd::Ones(6)));
}

// By hand: the lower link's speed pulls at the upper joint with m l c sin(q2) v2^2 = 0.05 v2^2, which is beyond 1.8e308 for v2 =
// 1e160; at 1e150 it is not. Joints before that one, of several dofs too, are not blamed.
TEST(Vectors, ResultsThatAreTooLargeForANumberNameTheJoint) {
  Model model;
  model.addJoint(0, JointModelFreeFlyer(), SE3(), "aside");
  model.addJoint(0, JointModelRZ(), SE3(), "upper");
  model.addJoint(2, JointModelRZ(), SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.5, 0, 0)), "lower");
  for (const JointIndex joint : {1, 2, 3})
    model.appendBodyToJoint(joint, Inertia(1, Eigen::Vector3d(0.1, 0, 0), Eigen::Matrix3d::Identity()));
  Data data(model);
  Eigen::VectorXd q = neutral(model), v = Eigen::VectorXd::Zero(8), zero = v;
  q[8] = M_PI / 2;
  v[7] = 1e160;
  const std::string why = " the result for joint 'upper' is ";
  EXPECT_SAYS("nonLinearEffects:" + why, nonLinearEffects(model, data, q, v));
  EXPECT_SAYS("rnea:" + why, rnea(model, data, q, v, zero));
  EXPECT_SAYS("aba:" + why, aba(model, data, q, v, zero));
  EXPECT_SAYS("the state or the model's numbers are too large", nonLinearEffects(model, data, q, v));
  v[7] = 1e150;
  EXPECT_NEAR(nonLinearEffects(model, data, q, v)[6] / -0.05e300, 1, 1e-13);
}

TEST(Singular, MasslessTipIsNamed) {
  Model model;
  model.name = "m";
  model.addJoint(0, JointModelRX(), SE3(), "arm");
  model.appendBodyToJoint(1, Inertia::FromSphere(1, 0.1),
                          SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 1, 0)));
  model.addJoint(1, JointModelRZ(), SE3(), "empty");
  Data data(model);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(2);
  EXPECT_SAYS("aba: the inertia that joint 'empty' moves is singular", aba(model, data, zero, zero, zero));
  EXPECT_SAYS("computeMinverse: the inertia that joint 'empty'", computeMinverse(model, data, zero));
  // a rotor makes it well again
  model.armature[1] = 1e-3;
  EXPECT_TRUE(aba(model, data, zero, zero, zero).allFinite());
}

// Two joints about one line with nothing between them: M is singular although every tip has mass.
TEST(Singular, TwoJointsOnOneAxis) {
  testing::Random random(1);
  for (int n = 0; n < 50; ++n) {
    Model model;
    const Eigen::Vector3d axis = random.vec3();
    model.addJoint(0, JointModelRevoluteUnaligned(axis), random.pose(), "first");
    model.addJoint(1, JointModelRevoluteUnaligned(axis), SE3(), "second");
    model.appendBodyToJoint(2, random.inertia(), random.pose());
    Data data(model);
    const testing::State s = testing::randomState(model, static_cast<unsigned>(n));
    EXPECT_SAYS("joint 'first' moves is singular", aba(model, data, s.q, s.v, s.tau));
  }
}

TEST(Singular, NoMassNoCentre) {
  Model model;
  model.addJoint(0, JointModelRX(), SE3(), "arm");
  model.appendBodyToJoint(0, Inertia::FromSphere(1, 1));
  Data data(model);
  EXPECT_SAYS("centerOfMass: model '' has no moving mass",
              centerOfMass(model, data, Eigen::VectorXd::Zero(1)));
}

TEST(Empty, AModelWithoutJoints) {
  const Model model;
  Data data(model);
  const Eigen::VectorXd none(0);
  EXPECT_EQ(rnea(model, data, none, none, none).size(), 0);
  EXPECT_EQ(aba(model, data, none, none, none).size(), 0);
  EXPECT_EQ(crba(model, data, none).size(), 0);
  EXPECT_EQ(computeMinverse(model, data, none).size(), 0);
  forwardKinematics(model, data, none, none);
  EXPECT_TRUE(data.oMf[0].isApprox(SE3::Identity(), 0));
}

}  // namespace
}  // namespace rbd
