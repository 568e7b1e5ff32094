#include "rbd/model/sample_models.h"

#include <gtest/gtest.h>

#include "rbd/kernel/workspace.h"
#include "rbd/model/sample_geometries.h"
#include "rbd/rbd.h"
#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

// Elimination of M - bound * 1: all pivots are positive exactly when every eigenvalue of M is above the
// bound.
double smallestPivot(Eigen::MatrixXd M, double bound) {
  double smallest = 1e300;
  M.diagonal().array() -= bound;
  for (Eigen::Index k = 0; k < M.rows(); ++k) {
    smallest = std::min(smallest, M(k, k));
    for (Eigen::Index i = k + 1; i < M.rows(); ++i) {
      const double factor = M(i, k) / M(k, k);
      for (Eigen::Index j = k + 1; j < M.cols(); ++j) M(i, j) -= factor * M(k, j);
    }
  }
  return smallest;
}

TEST(SampleModels, ManipulatorIsAsTheContractSays) {
  Model model;
  buildModels::manipulator(model, false);
  EXPECT_EQ(model.name, "manipulator");
  EXPECT_EQ(model.njoints, 7);
  EXPECT_EQ(model.nq, 6);
  EXPECT_EQ(model.nv, 6);
  EXPECT_EQ(model.nframes, 13);
  const char* kinds[] = {"FIXED", "RZ", "RY", "RY", "RZ", "RY", "RZ"};
  for (JointIndex i = 0; i < model.njoints; ++i) EXPECT_EQ(model.joints[i].shortname(), kinds[i]);
  for (const char* name : {"universe", "arm_base_link", "upperarm_body", "forearm_body", "wrist_body",
                           "arm_tool_link", "effector_body"}) {
    EXPECT_LT(model.getFrameId(name), model.nframes) << name;
  }
}

TEST(SampleModels, ManipulatorsInertiaNeverFallsBelowTheBound) {
  for (const bool mimic : {false, true}) {
    Model model;
    buildModels::manipulator(model, mimic);
    Data data(model);
    std::mt19937_64 engine(1);
    for (int k = 0; k < 1000; ++k) {
      const Eigen::MatrixXd M = crba(model, data, randomConfiguration(model, engine));
      ASSERT_GT(smallestPivot(M, 0.2), 0);
      ASSERT_LT(smallestPivot(M, 5.0), 0);  // the check can fail
    }
  }
}

// At neutral gravity does not turn the base, but bends shoulder and elbow.
TEST(SampleModels, ManipulatorsGravityAtNeutral) {
  Model model;
  buildModels::manipulator(model);
  Data data(model);
  const Eigen::VectorXd& g = computeGeneralizedGravity(model, data, neutral(model));
  EXPECT_NEAR(g[0], 0, 1e-12);
  // levers by hand: forearm bodies at 0.10, 0.30, 0.45, 0.54 m from the elbow, which carries them all
  const double elbow = -9.81 * (2.5 * 0.10 + 2.0 * 0.30 + 1.0 * 0.45 + 0.5 * 0.54);
  EXPECT_NEAR(g[2], elbow, 1e-12);
  EXPECT_NEAR(g[1], elbow, 1e-12);  // the upper arm stands upright
}

TEST(SampleModels, Humanoid) {
  Model model;
  buildModels::humanoid(model, false);
  EXPECT_EQ(model.nq, 37);
  EXPECT_EQ(model.nv, 36);
  EXPECT_EQ(model.joints[1].shortname(), "FreeFlyer");
  Data data(model);
  EXPECT_TRUE(data.work().depthFirst);
  const Eigen::Vector3d com = centerOfMass(model, data, neutral(model));
  EXPECT_NEAR(com.y(), 0, 1e-12);  // left and right are mirror images
  EXPECT_GT(data.mass[0], 50);
  EXPECT_LT(data.mass[0], 80);
  for (const Inertia& inertia : model.inertias) {
    if (inertia.mass() > 0) {
      EXPECT_EQ(inertia.problem(), "");
    }
  }
}

// With a straight wrist the tool stands as if the forearm had not turned.
TEST(SampleModels, ManipulatorsToolKeepsItsRoll) {
  Model model, free;
  buildModels::manipulator(model, true);
  buildModels::manipulator(free, false);
  EXPECT_EQ(model.nq, 5);
  EXPECT_EQ(model.nv, 5);
  EXPECT_EQ(model.nframes, free.nframes);
  EXPECT_EQ(model.armature.minCoeff(), 0.25);
  Data data(model), data2(free);
  Eigen::VectorXd q = testing::Random(1).vec(5), still = Eigen::VectorXd::Zero(6);
  q[4] = 0;
  still.head(3) = q.head(3);
  forwardKinematics(model, data, q);
  forwardKinematics(free, data2, still);
  const FrameIndex tool = model.frameId("arm_tool_link");
  EXPECT_TRUE(data.oMf[tool].isApprox(data2.oMf[tool], 1e-14));
  EXPECT_FALSE(data.oMi[4].isApprox(data2.oMi[4], 0.1));  // the forearm has turned
  // and any motion is that of the free arm with the sixth joint against the fourth
  q = testing::Random(2).vec(5);
  Eigen::VectorXd q6(6);
  q6 << q, -q[3];
  forwardKinematics(model, data, q);
  forwardKinematics(free, data2, q6);
  for (FrameIndex f = 0; f < model.nframes; ++f) EXPECT_TRUE(data.oMf[f].isApprox(data2.oMf[f], 1e-14));
}

// The hip, knee and ankle pitches of a leg add up to nothing: what is left between pelvis and foot are the
// hip's yaw and roll and the ankle's roll.
TEST(SampleModels, HumanoidsFeetDoNotPitch) {
  Model model;
  buildModels::humanoid(model, true);
  EXPECT_EQ(model.nq, 33);
  EXPECT_EQ(model.nv, 32);
  EXPECT_EQ(model.njoints, 32);
  Data data(model);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Eigen::VectorXd q = testing::randomState(model, seed).q;
    forwardKinematics(model, data, q);
    for (const std::string side : {"left_", "right_"}) {
      const auto angle = [&](const char* joint) {
        return q[model.joints[model.jointId(side + joint)].idx_q()];
      };
      const auto turn = [](double x, const Eigen::Vector3d& axis) { return exp3(Eigen::Vector3d(x * axis)); };
      const Eigen::Matrix3d foot = turn(angle("hip_yaw"), Eigen::Vector3d::UnitZ()) *
                                   turn(angle("hip_roll") + angle("ankle_roll"), Eigen::Vector3d::UnitX());
      const SE3 seen = data.oMi[1].actInv(data.oMf[model.frameId(side + "ankle_roll")]);
      EXPECT_LE(testing::distance(seen.rotation(), foot), 1e-14);
      // the knee, which has no limits of its own, stays within what it had
      const double knee = -2 * angle("hip_pitch");
      EXPECT_LE(std::abs(knee), 2.5);
    }
  }
  EXPECT_EQ(model.upperVelocityLimit[model.joints[model.jointId("left_hip_pitch")].idx_v()], 5);
  EXPECT_EQ(model.upperPositionLimit[model.joints[model.jointId("left_hip_roll")].idx_q()], 2.5);
}

// children of one joint are in alphabetical order, and the tree depth first: the wire's model order
TEST(SampleModels, ModelOrder) {
  Model model;
  buildModels::humanoid(model);
  std::vector<JointIndex> path = {0};
  for (JointIndex i = 1; i < model.njoints; ++i) {
    while (path.back() != model.parents[i]) {
      path.pop_back();
      ASSERT_FALSE(path.empty()) << model.names[i];
    }
    path.push_back(i);
    for (JointIndex k = 1; k < i; ++k) {
      if (model.parents[k] == model.parents[i]) {
        EXPECT_LT(model.names[k], model.names[i]);
      }
    }
  }
}

TEST(SampleModels, PicturesAndInertiasAgree) {
  Model model;
  buildModels::manipulator(model);
  const GeometryModel shapes = buildModels::manipulatorGeometries(model);
  ASSERT_EQ(shapes.visual.size(), 7u);
  // one body per joint: its centre of mass is the middle of its shape
  for (const GeometryObject& shape : shapes.visual) {
    EXPECT_LE((shape.placement.translation() - model.inertias[shape.parentJoint].lever()).norm(), 1e-12)
        << shape.name;
  }
  Model other;
  buildModels::humanoid(other);
  EXPECT_EQ(buildModels::humanoidGeometries(other).visual.size(),
            static_cast<std::size_t>(other.njoints - 1));
  EXPECT_THROW(buildModels::manipulatorGeometries(other), std::out_of_range);
}

}  // namespace
}  // namespace rbd
