#include "rbd/model/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "rbd/rbd.h"
#include "tests/core/algorithm/random_tree.h"
#include "tests/core/error_of.h"

namespace rbd {
namespace {

// The three-joint arm of the first lesson: up 0.5 along z, then 0.4 and 0.3 along y.
Model lessonArm() {
  Model model;
  const auto at = [](double y, double z) {
    return SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, y, z));
  };
  const JointIndex one =
      model.addJoint(JointIndex(0), JointModelRZ(), SE3::Identity(), "joint_1_base_rotation");
  const JointIndex two = model.addJoint(one, JointModelRY(), at(0, 0.5), "joint_2_shoulder");
  const JointIndex three = model.addJoint(two, JointModelRY(), at(0.4, 0), "joint_3_elbow");
  model.addFrame(Frame("end_effector", three, at(0.3, 0), OP_FRAME));
  return model;
}

using testing::errorOf;

TEST(Model, StartsWithTheUniverse) {
  const Model model;
  EXPECT_EQ(model.njoints, 1);
  EXPECT_EQ(model.nframes, 1);
  EXPECT_EQ(model.nq, 0);
  EXPECT_EQ(model.names[0], "universe");
  EXPECT_EQ(model.joints[0].shortname(), "FIXED");
  EXPECT_EQ(model.gravity.linear(), Eigen::Vector3d(0, 0, -9.81));
}

TEST(Model, LessonArm) {
  const Model model = lessonArm();
  EXPECT_EQ(model.njoints, 4);
  EXPECT_EQ(model.nq, 3);
  EXPECT_EQ(model.nframes, 5);  // universe, one per joint, the tool
  EXPECT_EQ(model.parents[3], 2);
  Data data(model);
  forwardKinematics(model, data, neutral(model));
  EXPECT_LE((data.oMi[2].translation() - Eigen::Vector3d(0, 0, 0.5)).norm(), 1e-15);
  EXPECT_LE((data.oMi[3].translation() - Eigen::Vector3d(0, 0.4, 0.5)).norm(), 1e-15);
  EXPECT_LE((data.oMf[model.frameId("end_effector")].translation() - Eigen::Vector3d(0, 0.7, 0.5)).norm(),
            1e-15);
}

TEST(Model, Shortnames) {
  EXPECT_EQ(JointModelRX().shortname(), "RX");
  EXPECT_EQ(JointModelPZ().shortname(), "PZ");
  EXPECT_EQ(JointModelRevoluteUnaligned(0, 0, 2).shortname(), "RZ");
  EXPECT_EQ(JointModelRevoluteUnaligned(0, 0, -1).shortname(), "RevoluteUnaligned");
  EXPECT_EQ(JointModelPrismaticUnaligned(1, 1, 0).shortname(), "PrismaticUnaligned");
  EXPECT_EQ(JointModelContinuous(0, 1, 0).shortname(), "CY");
  EXPECT_EQ(JointModelFreeFlyer().shortname(), "FreeFlyer");
  EXPECT_EQ(JointModelFreeFlyer().nq(), 7);
  EXPECT_EQ(JointModelFreeFlyer().nv(), 6);
}

TEST(Model, NamesAndNearNames) {
  Model model = lessonArm();
  EXPECT_EQ(model.getFrameId("nowhere"), model.nframes);
  EXPECT_EQ(model.getJointId("nowhere"), model.njoints);
  EXPECT_EQ(model.names[model.jointId("joint_3_elbow")], "joint_3_elbow");
  const std::string text = errorOf([&] { model.frameId("end_efector"); });
  EXPECT_NE(text.find("near names: end_effector"), std::string::npos) << text;
  EXPECT_NE(errorOf([&] { model.jointId("joint_2_sholder"); }).find("joint_2_shoulder"), std::string::npos);
  // a link may be called like its joint: types tell them apart
  const FrameIndex body = model.addBodyFrame("joint_3_elbow", 3);
  EXPECT_EQ(model.getFrameId("joint_3_elbow", BODY), body);
  EXPECT_NE(model.getFrameId("joint_3_elbow"), body);
}

TEST(Model, RefusesAndStaysAsItWas) {
  Model model = lessonArm();
  const auto refuses = [&](const std::string& part, const std::function<void()>& call) {
    const std::string text = errorOf(call);
    EXPECT_NE(text.find(part), std::string::npos) << "wanted '" << part << "', got '" << text << "'";
    EXPECT_EQ(model.njoints, 4);
    EXPECT_EQ(model.nframes, 5);
  };
  const SE3 here;
  refuses("joint index 9", [&] { model.addJoint(9, JointModelRX(), here, "x"); });
  refuses("joint index -1", [&] { model.addJoint(-1, JointModelRX(), here, "x"); });
  refuses("exists already", [&] { model.addJoint(1, JointModelRX(), here, "joint_3_elbow"); });
  refuses("use addFrame", [&] { model.addJoint(1, JointModel(), here, "x"); });
  refuses("not a pose", [&] {
    model.addJoint(1, JointModelRX(), SE3(2 * Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()), "x");
  });
  refuses("not a pose", [&] {
    model.addFrame(
        Frame("x", 1, SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, std::nan(""), 0)), BODY));
  });
  refuses("exists already", [&] { model.addFrame(Frame("end_effector", 1, here, OP_FRAME)); });
  refuses("axis", [&] { JointModelRevoluteUnaligned(0, 0, 0); });
  refuses("axis", [&] { JointModelPrismaticUnaligned(std::nan(""), 0, 0); });
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1), two = Eigen::VectorXd::Ones(2);
  refuses("velocity limit has 2", [&] { model.addJoint(1, JointModelRX(), here, "x", one, two, -one, one); });
  refuses("above upper", [&] { model.addJoint(1, JointModelRX(), here, "x", one, one, 2 * one, one); });
  refuses("effort limit must not be -1",
          [&] { model.addJoint(1, JointModelRX(), here, "x", -one, one, -one, one); });
}

TEST(Model, ChangesThatMakeNoSense) {
  Model model = lessonArm();
  const Model before = model;
  const auto refuses = [&](const std::string& part, const std::function<void()>& call) {
    const std::string text = errorOf(call);
    EXPECT_NE(text.find(part), std::string::npos) << "wanted '" << part << "', got '" << text << "'";
    EXPECT_EQ(model.nbodies, before.nbodies);
    EXPECT_EQ(model.njoints, before.njoints);
    EXPECT_EQ(model.nframes, before.nframes);
    EXPECT_EQ(model.topology(), before.topology());
  };
  const SE3 here, nowhere(-Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  for (const JointIndex joint : {-1, 4}) {
    const std::string text = "joint index " + std::to_string(joint) + " does not exist";
    refuses("appendBodyToJoint: " + text, [&] { model.appendBodyToJoint(joint, Inertia()); });
    refuses("setInertia: " + text, [&] { model.setInertia(joint, Inertia()); });
    refuses("setJointPlacement: " + text, [&] { model.setJointPlacement(joint, here); });
    refuses("addFrame: " + text, [&] { model.addFrame(Frame("x", joint, here, BODY)); });
    refuses("setMimic: " + text, [&] { model.setMimic(1, joint); });
    refuses("setMimic: " + text, [&] { model.setMimic(joint, 1); });
  }
  for (const FrameIndex frame : {-1, 5}) {
    refuses("frame " + std::to_string(frame) + " does not exist",
            [&] { model.setFramePlacement(frame, here); });
    refuses("parent frame " + std::to_string(frame) + " does not exist",
            [&] { model.addFrame(Frame("x", 1, frame, here, BODY)); });
  }
  // a reflection is no rotation
  refuses("not a pose", [&] { model.setJointPlacement(1, nowhere); });
  refuses("not a pose", [&] { model.setFramePlacement(1, nowhere); });
  refuses("not a pose", [&] { model.appendBodyToJoint(1, Inertia(), nowhere); });
  refuses("setMimic 'joint_2_shoulder' to 'universe'", [&] { model.setMimic(2, 0); });
  EXPECT_THROW(model.frameId("nowhere"), std::out_of_range);
  EXPECT_THROW(model.jointId("nowhere"), std::out_of_range);
}

// A frame that calls itself a joint's keeps its name, and the model stays whole.
TEST(Model, JointFramesKeepTheirNames) {
  Model model = lessonArm();
  model.addFrame(Frame("wrist", 3, SE3(), JOINT));
  EXPECT_EQ(errorOf([&] { model.addJoint(3, JointModelRX(), SE3(), "wrist"); }),
            "addJoint: a frame 'wrist' of type JOINT exists already");
  EXPECT_EQ(model.njoints, 4);
  EXPECT_EQ(model.nq, 3);
  EXPECT_EQ(static_cast<int>(model.joints.size()), model.njoints);
}

TEST(Model, JointsThatCannotBe) {
  const double nan = std::nan("");
  EXPECT_NE(errorOf([&] { JointModelHelicalUnaligned({1, 0, 0}, nan); }).find("pitch must be finite"),
            std::string::npos);
  EXPECT_NE(errorOf([&] { JointModelUniversal({1, 0, 0}, {-2, 0, 0}); }).find("must not be parallel"),
            std::string::npos);
  EXPECT_NE(errorOf([&] { JointModelPlanar({0, 0, 0}); }).find("axis must be finite and not zero"),
            std::string::npos);
  EXPECT_NE(errorOf([&] { JointModelContinuous(0, INFINITY, 0); }).find("axis"), std::string::npos);
  EXPECT_NE(
      errorOf([&] { Inertia(nan, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()); }).find("finite"),
      std::string::npos);
  Eigen::Matrix3d skewed = Eigen::Matrix3d::Identity();
  skewed(0, 1) = 0.5;
  EXPECT_NE(errorOf([&] { Inertia(1, Eigen::Vector3d::Zero(), skewed); }).find("not symmetric"),
            std::string::npos);
  Model model;
  JointLimits limits;
  limits.lowerVelocity = Eigen::VectorXd::Constant(1, nan);
  EXPECT_NE(errorOf([&] {
              model.addJoint(0, JointModelRX(), SE3(), "x", limits);
            }).find("addJoint 'x': lower velocity limit must not be nan"),
            std::string::npos);
  limits = {};
  limits.upperPosition = Eigen::VectorXd::Ones(3);
  EXPECT_EQ(errorOf([&] { model.addJoint(0, JointModelSpherical(), SE3(), "x", limits); }),
            "addJoint 'x': upper position limit has 3 entries, the joint needs 4");
  EXPECT_EQ(model.njoints, 1);
}

TEST(Model, LimitsAreKept) {
  Model model;
  const auto one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
  model.addJoint(0, JointModelRX(), SE3(), "a", one(10), one(2), one(-1), one(3));
  model.addJoint(1, JointModelFreeFlyer(), SE3(), "b");
  EXPECT_EQ(model.upperEffortLimit[0], 10);
  EXPECT_EQ(model.upperVelocityLimit[0], 2);
  EXPECT_EQ(model.lowerPositionLimit[0], -1);
  EXPECT_EQ(model.upperPositionLimit[0], 3);
  EXPECT_TRUE(std::isinf(model.upperPositionLimit[3]));
  EXPECT_EQ(model.armature.size(), model.nv);
  EXPECT_EQ(model.upperPositionLimit.size(), model.nq);
}

TEST(Model, BodiesAddUpInTheJointFrame) {
  testing::Random random(1);
  Model model;
  model.addJoint(0, JointModelRevoluteUnaligned(1, 2, 3), random.pose(), "a");
  const Inertia b1 = random.inertia(), b2 = random.inertia();
  const SE3 p1 = random.pose(), p2 = random.pose();
  model.appendBodyToJoint(1, b1, p1);
  model.appendBodyToJoint(1, b2, p2);
  EXPECT_TRUE(model.inertias[1].isApprox(p1.act(b1) + p2.act(b2), 1e-14));
  EXPECT_EQ(model.nbodies, 3);
}

// The kernels read packed copies: a change after building must reach them.
TEST(Model, SettersReachTheKernels) {
  Model model = testing::randomTree(3, 6, false);
  const testing::State s = testing::randomState(model, 3);
  Data data(model);
  const Eigen::VectorXd tau = rnea(model, data, s.q, s.v, s.a);
  Model heavy = model;
  for (JointIndex i = 1; i < heavy.njoints; ++i) heavy.setInertia(i, heavy.inertias[i] * 2);
  heavy.armature *= 2;
  // efforts are linear in the inertias; and Data serves any model of the same tree
  EXPECT_LE(testing::distance(rnea(heavy, data, s.q, s.v, s.a), 2 * tau), 1e-13);
  Model moved = model;
  moved.setJointPlacement(1, SE3(model.jointPlacements[1].rotation(), Eigen::Vector3d(1, 2, 3)));
  forwardKinematics(moved, data, s.q);
  const Eigen::Vector3d with = data.oMi[1].translation();
  forwardKinematics(model, data, s.q);
  const Eigen::Vector3d shift = Eigen::Vector3d(1, 2, 3) - model.jointPlacements[1].translation();
  EXPECT_LE((with - data.oMi[1].translation() - shift).norm(), 1e-14);
  moved.setFramePlacement(1, SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, 1)));
  forwardKinematics(moved, data, s.q);
  EXPECT_LE((data.oMf[1].translation() - data.oMi[1].act(Eigen::Vector3d(0, 0, 1))).norm(), 1e-14);
  EXPECT_THROW(moved.setJointPlacement(0, SE3()), std::invalid_argument);
}

// What length 1 belongs to is found by asking which numbers normalize changes.
TEST(Model, UnitPartsAreWhatNormalizeChanges) {
  Model model;
  const JointModel kinds[] = {JointModelSpherical(), JointModelRX(),          JointModelPlanar(),
                              JointModelFreeFlyer(), JointModelTranslation(), JointModelContinuous(0, 0, 1)};
  for (const JointModel& kind : kinds) model.addJoint(0, kind, SE3(), "j" + std::to_string(model.njoints));
  const Eigen::VectorXd twos = Eigen::VectorXd::Constant(model.nq, 2);
  Eigen::VectorXd q = twos;
  normalize(model, q);
  for (const JointModel& joint : model.joints) {
    const UnitPart unit = joint.unit_part();
    for (int k = joint.idx_q(); k < joint.idx_q() + joint.nq(); ++k) {
      EXPECT_EQ(q[k] != 2, k >= unit.at && k < unit.at + unit.size) << joint.shortname() << " " << k;
    }
    EXPECT_EQ(isVectorSpace(joint.manifold()), unit.size == 0);
    EXPECT_EQ(isVectorSpace(joint.manifold()), joint.nq() == joint.nv());
  }
}

TEST(Model, CopiesAreIndependent) {
  const Model model = lessonArm();
  Model copy = model;
  copy.addJoint(3, JointModelRX(), SE3(), "wrist");
  EXPECT_EQ(model.njoints, 4);
  EXPECT_EQ(copy.njoints, 5);
  EXPECT_EQ(model.getJointId("wrist"), model.njoints);
}

}  // namespace
}  // namespace rbd
