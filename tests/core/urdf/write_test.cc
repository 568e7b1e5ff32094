// Models written as URDF and read again: the same robot in every algorithm; what URDF cannot say is refused.
#include <gtest/gtest.h>
#include <rbd/rbd.h>
#include <rbd/urdf/urdf.h>
#include <rbd/urdf/write.h>

#include "tests/core/algorithm/random_tree.h"
#include "tests/core/urdf/corpus.h"
#include "tests/support/paths.h"

namespace rbd::urdf {
namespace {

using rbd::testing::Random;

Model read_back(const Model& model) {
  const Loaded loaded = loadXML(writeModel(model));
  std::string said;
  for (const Diagnostic& d : loaded.diagnostics) said += d.text() + "\n";
  EXPECT_TRUE(loaded.ok()) << said;
  return loaded.model;
}

// Where joint j of `a` stands in `b`.
JointIndex same(const Model& a, JointIndex j, const Model& b) { return j == 0 ? 0 : b.jointId(a.names[j]); }

// Numbers of one model in the order of the other's joints.
enum class Space { Q, V };
Eigen::VectorXd reordered(const Model& a, const Eigen::VectorXd& x, const Model& b, Space space) {
  Eigen::VectorXd y(x.size());
  for (JointIndex j = 1; j < a.njoints; ++j) {
    const JointModel &from = a.joints[j], &to = b.joints[same(a, j, b)];
    const int n = space == Space::Q ? from.nq() : from.nv();
    if (n > 0 && space == Space::Q) y.segment(to.idx_q(), n) = x.segment(from.idx_q(), n);
    if (n > 0 && space == Space::V) y.segment(to.idx_v(), n) = x.segment(from.idx_v(), n);
  }
  return y;
}

void expect_near(const Eigen::MatrixXd& got, const Eigen::MatrixXd& wanted, double tol) {
  EXPECT_LE((got - wanted).cwiseAbs().maxCoeff(), tol * (1 + wanted.cwiseAbs().maxCoeff()));
}

// The same robot: what is stored exactly (limits, friction), placements and inertias to rounding, and the
// algorithms at random states. Placements lose some eps per joint in roll, pitch, yaw and the quaternion
// behind them, the algorithms that times the condition of M, here far below 1e4.
void expect_same(const Model& a, const Model& b) {
  ASSERT_EQ(a.njoints, b.njoints);
  ASSERT_EQ(a.nq, b.nq);
  ASSERT_EQ(a.nv, b.nv);
  EXPECT_EQ(a.name, b.name);
  for (JointIndex j = 0; j < a.njoints; ++j) {
    const JointIndex k = same(a, j, b);
    SCOPED_TRACE("joint " + a.names[j]);
    EXPECT_EQ(a.joints[j].kind(), b.joints[k].kind());
    EXPECT_EQ(same(a, a.parents[j], b), b.parents[k]);
    EXPECT_TRUE(a.jointPlacements[j].isApprox(b.jointPlacements[k], 1e-14));
    EXPECT_TRUE(a.inertias[j].isApprox(b.inertias[k], 1e-12));
    EXPECT_TRUE(a.joints[j].axis().isApprox(b.joints[k].axis(), 1e-15) || a.joints[j].axis().isZero(0));
    EXPECT_EQ(a.mimic(j).leader < 0, b.mimic(k).leader < 0);
  }
  EXPECT_EQ(reordered(a, a.lowerPositionLimit, b, Space::Q), b.lowerPositionLimit);
  EXPECT_EQ(reordered(a, a.upperPositionLimit, b, Space::Q), b.upperPositionLimit);
  EXPECT_EQ(reordered(a, a.upperEffortLimit, b, Space::V), b.upperEffortLimit);
  EXPECT_EQ(reordered(a, a.upperVelocityLimit, b, Space::V), b.upperVelocityLimit);
  EXPECT_EQ(reordered(a, a.damping, b, Space::V), b.damping);
  EXPECT_EQ(reordered(a, a.friction, b, Space::V), b.friction);

  Data da(a), db(b);
  std::mt19937_64 engine(7);
  for (int round = 0; round < 3; ++round) {
    const Eigen::VectorXd q = randomConfiguration(a, engine), v = Eigen::VectorXd::Random(a.nv),
                          x = Eigen::VectorXd::Random(a.nv);
    const Eigen::VectorXd qb = reordered(a, q, b, Space::Q), vb = reordered(a, v, b, Space::V),
                          xb = reordered(a, x, b, Space::V);
    if (a.nv > 0) {
      expect_near(rnea(b, db, qb, vb, xb), reordered(a, rnea(a, da, q, v, x), b, Space::V), 1e-12);
      Eigen::VectorXd acceleration;
      try {
        acceleration = aba(a, da, q, v, x);
      } catch (const std::runtime_error&) {  // singular: then both are
        EXPECT_THROW(aba(b, db, qb, vb, xb), std::runtime_error);
      }
      if (acceleration.size() > 0)
        expect_near(aba(b, db, qb, vb, xb), reordered(a, acceleration, b, Space::V), 1e-10);
    }
    forwardKinematics(a, da, q);
    forwardKinematics(b, db, qb);
    updateFramePlacements(a, da);
    updateFramePlacements(b, db);
    for (FrameIndex f = 1; f < a.nframes; ++f) {
      const Frame& frame = a.frames[f];
      const int types = frame.type == JOINT ? JOINT : frame.type == FIXED_JOINT ? FIXED_JOINT : BODY;
      const FrameIndex g = b.getFrameId(frame.name, static_cast<FrameType>(types));
      ASSERT_LT(g, b.nframes) << frame.name;
      EXPECT_TRUE(da.oMf[f].isApprox(db.oMf[g], 1e-12)) << frame.name;
      // a frame without one: its joint may know more than its frames
      EXPECT_TRUE(frame.inertia.mass() == 0 || frame.inertia.isApprox(b.frames[g].inertia, 1e-12))
          << frame.name;
    }
  }
}

TEST(UrdfWrite, EveryAcceptedFileOfTheCorpus) {
  int written = 0;
  for (const CorpusCase& c : read_corpus(lab::source_path("tests/core/urdf/corpus.txt"))) {
    if (c.text.size() > 300000) continue;  // the long chains take seconds to compare
    const Loaded loaded = loadXML(c.text);
    if (!loaded.ok()) continue;
    SCOPED_TRACE(c.name);
    expect_same(loaded.model, read_back(loaded.model));
    ++written;
  }
  EXPECT_GT(written, 60);
}

// Written again, a model that came from text gives the same text: nothing drifts, no link or joint is lost or
// added.
TEST(UrdfWrite, ASecondTimeTheTextIsTheSame) {
  Model arm;
  buildModel(lab::source_path("models/simple_3dof_arm.urdf"), arm);
  const Model once = read_back(arm);
  expect_same(arm, once);
  EXPECT_EQ(once.nframes, arm.nframes);
  EXPECT_EQ(writeModel(read_back(once)), writeModel(once));
}

TEST(UrdfWrite, SampleModels) {
  Model arm, human;
  buildModels::manipulator(arm);
  buildModels::humanoid(human);
  arm.armature.setZero();  // URDF has none
  human.armature.setZero();
  expect_same(arm, read_back(arm));
  expect_same(human, read_back(human));
}

// A tree of every kind that URDF has, in any order, axes at random; frames of every type; one joint follows.
Model tree_of(unsigned seed) {
  Random random(seed);
  Model model;
  model.name = "tree <\"&'> " + std::to_string(seed);
  for (int j = 1; j <= 12; ++j) {
    const JointIndex parent = random.below(j);
    const std::string name = "j" + std::to_string(random.below(1000)) + "_" + std::to_string(j);
    const Eigen::Vector3d axis = random.below(2) ? random.vec3() : -Eigen::Vector3d::Unit(random.below(3));
    const auto one = [&](double x) { return Eigen::VectorXd::Constant(1, x); };
    JointLimits limits;
    limits.lowerPosition = one(-random.in(0, 2)), limits.upperPosition = one(random.in(0, 2));
    limits.upperVelocity = one(random.in(0, 2)), limits.lowerVelocity = -limits.upperVelocity;
    limits.upperEffort = one(random.in(0, 2)), limits.lowerEffort = -limits.upperEffort;
    const SE3 place = random.pose();
    JointIndex index = 0;
    switch (random.below(5)) {
      case 0:
        index = model.addJoint(parent, JointModelRevoluteUnaligned(axis), place, name, limits);
        break;
      case 1:
        index = model.addJoint(parent, JointModelPrismaticUnaligned(axis), place, name, limits);
        break;
      case 2:
        index = model.addJoint(parent, JointModelContinuous(axis), place, name);
        break;
      case 3:
        index = model.addJoint(parent, JointModelPlanar(axis), place, name);
        break;
      default:
        index = model.addJoint(parent, JointModelFreeFlyer(), place, name);
        break;
    }
    if (model.joints[index].nv() == 1) {
      model.damping[model.joints[index].idx_v()] = random.in(0, 1);
      model.friction[model.joints[index].idx_v()] = random.in(0, 1);
    }
    const FrameIndex above = model.getFrameId(name, JOINT);
    if (j % 3 == 0) {  // without a link of its own
      model.appendBodyToJoint(index, random.inertia(), random.pose());
    } else {
      model.addBodyFrame(name + " link", index, SE3::Identity(), above, random.inertia());
      model.addFrame(Frame(name + " tool", index, model.nframes - 1, random.pose(), OP_FRAME));
      model.addFrame(Frame(name + " eye", index, model.nframes - 1, random.pose(), SENSOR));
      model.addBodyFrame(name + " hand", index, random.pose(), 0, random.inertia());
    }
  }
  return model;
}

TEST(UrdfWrite, RandomTreesOfEveryKind) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const Model model = tree_of(seed);
    expect_same(model, read_back(model));
  }
}

TEST(UrdfWrite, FollowersFollow) {
  Model model;
  model.name = "followers";
  const auto inertia = Random(1).inertia();
  for (const char* name : {"b", "a", "c"}) {
    model.addBodyFrame(std::string(name) + "_link",
                       model.addJoint(model.njoints - 1, JointModelRX(), Random(2).pose(), name),
                       SE3::Identity(), 0, inertia);
  }
  model.setMimic(model.jointId("b"), model.jointId("c"), -2,
                 0.5);  // the leader comes later, and follows itself
  model.setMimic(model.jointId("c"), model.jointId("a"), 0.3, -0.1);
  const Model back = read_back(model);
  expect_same(model, back);
  EXPECT_EQ(back.nv, 1);
  EXPECT_EQ(back.mimic(back.jointId("b")).multiplier, -2);
  EXPECT_EQ(back.mimic(back.jointId("b")).offset, 0.5);
}

// An inertia that was changed afterwards belongs to no link any more: all of it is written at the joint.
TEST(UrdfWrite, ChangedInertia) {
  Model model;
  buildModel(lab::source_path("models/simple_3dof_arm.urdf"), model);
  model.setInertia(2, Random(3).inertia());
  const Model back = read_back(model);
  EXPECT_TRUE(model.inertias[2].isApprox(back.inertias[2], 1e-12));
  EXPECT_TRUE(model.inertias[1].isApprox(back.inertias[1], 1e-12));
}

std::string refusal(const Model& model) {
  try {
    writeModel(model);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "written";
}

TEST(UrdfWrite, WhatUrdfCannotSayIsRefused) {
  const auto with = [](const JointModel& joint) {
    Model model;
    model.addJoint(0, joint, SE3::Identity(), "j");
    model.appendBodyToJoint(1, Inertia::FromSphere(1, 1));
    return model;
  };
  for (const JointModel& joint :
       std::vector<JointModel>{JointModelHZ(0.1), JointModelSpherical(), JointModelTranslation(),
                               JointModelUniversal({1, 0, 0}, {0, 1, 0})}) {
    EXPECT_EQ(refusal(with(joint)), "writeModel: joint 'j': URDF has no joint of type " + joint.shortname());
  }
  EXPECT_EQ(refusal(with(JointModelRX())), "written");

  Model model = with(JointModelRX());
  model.armature[0] = 0.1;
  EXPECT_NE(refusal(model).find("joint 'j': URDF has no armature"), std::string::npos);
  model = with(JointModelRX());
  model.rotorInertia[0] = 0.1;
  EXPECT_NE(refusal(model).find("joint 'j': URDF has no rotor"), std::string::npos);
  model = with(JointModelRX());
  model.lowerEffortLimit[0] = -1;
  EXPECT_NE(refusal(model).find("both directions"), std::string::npos);
  model = with(JointModelPlanar());
  model.upperPositionLimit[0] = 1;
  EXPECT_NE(refusal(model).find("several axes"), std::string::npos);
  model = with(JointModelPlanar());
  model.damping[1] = 1;
  EXPECT_NE(refusal(model).find("one damping for all"), std::string::npos);
  model.damping.setOnes();
  EXPECT_EQ(refusal(model), "written");
  model = with(JointModelRX());
  model.gravity.linear().setZero();
  EXPECT_NE(refusal(model).find("gravity"), std::string::npos);
  model = with(JointModelRX());
  model.addBodyFrame("x", 1);
  model.addFrame(Frame("x", 1, SE3::Identity(), OP_FRAME));
  EXPECT_NE(refusal(model).find("link 'x': twice"), std::string::npos);
  model = with(JointModelRX());
  model.name = "  ";
  EXPECT_NE(refusal(model).find("read back:2: robot"), std::string::npos) << refusal(model);
}

// What is not there stays away: a continuous joint has no position limits, unless it was given some.
TEST(UrdfWrite, LimitsThatAreNone) {
  Model model;
  model.addJoint(0, JointModelContinuous(0, 0, 1), SE3::Identity(), "j");
  model.appendBodyToJoint(1, Inertia::FromSphere(1, 1));
  EXPECT_EQ(writeModel(model).find("<limit"), std::string::npos);
  model.lowerPositionLimit[0] = -1;
  const Model back = read_back(model);
  EXPECT_EQ(back.joints[1].kind(), JointKind::Revolute);
  EXPECT_EQ(back.lowerPositionLimit[0], -1);
  EXPECT_EQ(back.upperPositionLimit[0], std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace rbd::urdf
