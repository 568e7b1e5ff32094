// Two robots made one: what each does alone, each does together, seen from where it now stands.
#include "rbd/edit/append_model.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "rbd/model/sample_geometries.h"
#include "rbd/rbd.h"
#include "tests/core/algorithm/random_tree.h"
#include "tests/core/error_of.h"

namespace rbd {
namespace {

using testing::distance;
using testing::kEps;
using testing::times;

constexpr double kTol = 1e3 * kEps;

using testing::errorOf;

Eigen::VectorXd joined(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  Eigen::VectorXd x(a.size() + b.size());
  x << a, b;
  return x;
}

// An arm welded to the humanoid's hand. The body's own motion carries the arm: what the arm alone does in
// that frame comes on top of it.
class ArmOnHand : public ::testing::Test {
 protected:
  testing::Random random{1};
  Model body, arm, both;
  SE3 placement = random.pose();
  FrameIndex hand = 0;
  testing::State b, r;

  void SetUp() override {
    buildModels::humanoid(body);
    buildModels::manipulator(arm);
    hand = body.frameId("left_wrist_pitch_body");
    both = appendModel(body, arm, hand, placement, "arm/");
    b = testing::randomState(body, 1);
    r = testing::randomState(arm, 2);
  }
};

TEST_F(ArmOnHand, SizesNamesAndNumbers) {
  EXPECT_EQ(both.name, "humanoid");
  EXPECT_EQ(both.nq, 43);
  EXPECT_EQ(both.nv, 42);
  EXPECT_EQ(both.njoints, 32 + 6);
  EXPECT_EQ(both.nframes, body.nframes + arm.nframes - 1);
  EXPECT_EQ(both.nbodies, body.nbodies + arm.nbodies - 1);
  EXPECT_EQ(both.armature, joined(body.armature, arm.armature));
  EXPECT_EQ(both.upperEffortLimit, joined(body.upperEffortLimit, arm.upperEffortLimit));
  EXPECT_EQ(both.lowerPositionLimit, joined(body.lowerPositionLimit, arm.lowerPositionLimit));
  EXPECT_EQ(both.frames[both.frameId("arm/joint1_base_yaw")].parentFrame,
            body.getFrameId("left_wrist_pitch"));
  // the arm's foot has become part of the hand
  const JointIndex wrist = body.jointId("left_wrist_pitch");
  EXPECT_TRUE(both.inertias[wrist].isApprox(body.inertias[wrist] + placement.act(arm.inertias[0]), 1e-14));
  EXPECT_EQ(both.frames[both.frameId("arm/arm_base_link")].parentFrame, hand);
}

TEST_F(ArmOnHand, Poses) {
  Data all(both), alone(body), armed(arm);
  forwardKinematics(both, all, joined(b.q, r.q));
  forwardKinematics(body, alone, b.q);
  forwardKinematics(arm, armed, r.q);
  const SE3 foot = alone.oMf[hand] * placement;
  for (FrameIndex f = 0; f < body.nframes; ++f) EXPECT_TRUE(all.oMf[f].isApprox(alone.oMf[f], 0));
  for (FrameIndex f = 1; f < arm.nframes; ++f) {
    const SE3& pose = all.oMf[both.frameId("arm/" + arm.frames[f].name)];
    EXPECT_TRUE(pose.isApprox(foot * armed.oMf[f], 1e-13)) << arm.frames[f].name;
  }
}

// With a body that rests in a fixed pose the arm is the arm alone in a turned gravity, and its foot pulls on
// the hand with the wrench that the arm alone gives to its ground.
TEST_F(ArmOnHand, DynamicsAtRest) {
  Data all(both), alone(body), armed(arm);
  forwardKinematics(body, alone, b.q);
  const SE3 foot = alone.oMf[hand] * placement;
  arm.gravity.linear(foot.rotation().transpose() * Eigen::Vector3d(0, 0, -9.81));
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.nv);
  const Eigen::VectorXd q = joined(b.q, r.q), tau = rnea(both, all, q, joined(zero, r.v), joined(zero, r.a));
  EXPECT_LE(distance(tau.tail(arm.nv), rnea(arm, armed, r.q, r.v, r.a)), kTol);
  EXPECT_LE(
      distance(Eigen::MatrixXd(crba(both, all, q)).bottomRightCorner(arm.nv, arm.nv), crba(arm, armed, r.q)),
      kTol);

  // momentum rate of the arm (its foot stands), minus its weight, is the force that the hand gives
  const Force rate = computeCentroidalMomentumTimeVariation(arm, armed, r.q, r.v, r.a);
  centerOfMass(arm, armed, r.q);
  const Inertia& base = arm.inertias[0];
  const Eigen::Vector3d weight = armed.mass[0] * arm.gravity.linear();
  Eigen::Vector3d f = rate.linear() - weight - base.mass() * arm.gravity.linear();
  Eigen::Vector3d n = rate.angular() + armed.com[0].cross(rate.linear() - weight) -
                      base.lever().cross(base.mass() * arm.gravity.linear());
  const Force on_hand = placement.act(Force(-n, -f));  // in the hand's frame
  const Eigen::VectorXd carried = rnea(body, alone, b.q, zero, zero, {{hand, on_hand, LOCAL}});
  EXPECT_LE(distance(tau.head(body.nv), carried), kTol);
}

// The joint space of both: M is that of the body with a heavier hand in its corner when the arm is locked.
TEST_F(ArmOnHand, InertiaOfTheWhole) {
  Data all(both);
  const Eigen::VectorXd q = joined(b.q, r.q), v = joined(b.v, r.v);
  std::vector<JointIndex> arms;
  for (JointIndex j = body.njoints; j < both.njoints; ++j) arms.push_back(j);
  const Model locked = buildReducedModel(both, arms, q);
  Model heavy = body;
  Data armed(arm);
  forwardKinematics(arm, armed, r.q);
  for (JointIndex j = 0; j < arm.njoints; ++j) {
    heavy.appendBodyToJoint(body.frames[hand].parentJoint, arm.inertias[j],
                            body.frames[hand].placement * placement * armed.oMi[j]);
  }
  Data one(heavy), two(locked);
  EXPECT_LE(distance(crba(locked, two, b.q), crba(heavy, one, b.q)), kTol);
  EXPECT_LE(
      distance(Eigen::MatrixXd(crba(both, all, q)).topLeftCorner(body.nv, body.nv), crba(heavy, one, b.q)),
      kTol);
  const double energy = 0.5 * v.dot(times(crba(both, all, q), v).col(0));
  EXPECT_NEAR(computeKineticEnergy(both, all, q, v), energy, kTol * energy);
}

// At one ground, two robots know nothing of each other; mimic joints, every kind.
TEST(AppendModel, SideBySide) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Model a = testing::randomTree(seed, 8, seed % 2 == 0),
                b = testing::randomTree(seed + 20, 10, false);
    const SE3 placement = testing::Random(seed).pose();
    const Model both = appendModel(a, b, 0, placement, "second ");
    Model turned = b;
    turned.gravity.linear(placement.rotation().transpose() * b.gravity.linear());
    const testing::State s = testing::randomState(a, seed), t = testing::randomState(b, seed + 1);
    Data data(both), one(a), two(turned);
    const Eigen::VectorXd q = joined(s.q, t.q), v = joined(s.v, t.v), x = joined(s.a, t.a);
    EXPECT_LE(distance(rnea(both, data, q, v, x),
                       joined(rnea(a, one, s.q, s.v, s.a), rnea(turned, two, t.q, t.v, t.a))),
              kTol);
    const double energy =
        computeKineticEnergy(a, one, s.q, s.v) + computeKineticEnergy(turned, two, t.q, t.v);
    EXPECT_NEAR(computeKineticEnergy(both, data, q, v), energy, kTol * energy);
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(both.nv, both.nv);
    M.topLeftCorner(a.nv, a.nv) = crba(a, one, s.q);
    M.bottomRightCorner(b.nv, b.nv) = crba(b, two, t.q);
    EXPECT_LE(distance(crba(both, data, q), M), kTol);
    EXPECT_TRUE(both.inertias[0].isApprox(a.inertias[0] + placement.act(b.inertias[0]), 1e-13));
  }
}

// Behind a joint that follows another.
TEST(AppendModel, BehindAFollower) {
  Model model, tool;
  buildModels::manipulator(model);
  model.setMimic(model.jointId("joint6_tool_roll"), model.jointId("joint4_forearm_roll"));
  tool.addJoint(0, JointModelRX(), SE3(), "finger");
  tool.addJoint(1, JointModelRX(), SE3(), "thumb");
  tool.setMimic(1, 2, -2);
  const Model both = appendModel(model, tool, model.frameId("arm_tool_link"));
  EXPECT_EQ(both.nv, 5 + 1);
  EXPECT_EQ(both.mimic(both.jointId("finger")).leader, both.jointId("thumb"));
  EXPECT_EQ(both.joints[both.jointId("finger")].idx_v(), 5);
  Data data(both);
  const Eigen::VectorXd q = testing::Random(1).vec(6);
  forwardKinematics(both, data, q);
  const SE3 turn = data.oMf[both.frameId("arm_tool_link")].actInv(data.oMf[both.frameId("thumb")]);
  EXPECT_NEAR(log3(turn.rotation()).x(), -2 * q[5] + q[5], 1e-14);
}

TEST(AppendModel, ShapesOfBoth) {
  Model body, arm;
  buildModels::humanoid(body);
  buildModels::manipulator(arm);
  const GeometryModel a = buildModels::humanoidGeometries(body), b = buildModels::manipulatorGeometries(arm);
  const SE3 placement = testing::Random(3).pose();
  const FrameIndex head = body.frameId("head_pitch");
  GeometryModel shapes = a;
  const Model both = appendModel(body, shapes, arm, b, head, placement, "x_", shapes);
  ASSERT_EQ(shapes.visual.size(), a.visual.size() + b.visual.size());
  ASSERT_EQ(shapes.collision.size(), a.collision.size() + b.collision.size());
  Data data(both), armed(arm);
  const Eigen::VectorXd q = neutral(both);
  forwardKinematics(both, data, q);
  forwardKinematics(arm, armed, neutral(arm));
  for (std::size_t i = 0; i < b.visual.size(); ++i) {
    const GeometryObject &x = b.visual[i], &y = shapes.visual[a.visual.size() + i];
    EXPECT_EQ(y.name, "x_" + x.name);
    EXPECT_TRUE((data.oMi[y.parentJoint] * y.placement)
                    .isApprox(data.oMf[head] * placement * armed.oMi[x.parentJoint] * x.placement, 1e-13));
  }
}

TEST(AppendModel, RefusesNamesThatBothHave) {
  Model body, arm;
  buildModels::humanoid(body);
  buildModels::manipulator(arm);
  const Model two = appendModel(body, arm, 0);  // no name in both
  EXPECT_EQ(two.nv, 42);
  EXPECT_EQ(errorOf([&] { appendModel(two, arm, 0); }),
            "appendModel: 'humanoid' and 'manipulator' both have 'joint1_base_yaw', 'joint2_shoulder', "
            "'joint3_elbow', 'joint4_forearm_roll', 'joint5_wrist_pitch' and 7 more; give a prefix");
  EXPECT_NE(errorOf([&] {
              appendModel(appendModel(two, arm, 0, SE3(), "l_"), arm, 0, SE3(), "l_");
            }).find("give another prefix"),
            std::string::npos);
  EXPECT_EQ(errorOf([&] { appendModel(body, arm, 99); }),
            "appendModel: frame index 99 does not exist, model 'humanoid' has 63 frames");
  const SE3 none(2 * Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  EXPECT_NE(errorOf([&] { appendModel(body, arm, 0, none); }).find("not a pose"), std::string::npos);
  // a model may be put on itself
  EXPECT_EQ(appendModel(arm, arm, arm.frameId("arm_tool_link"), SE3(), "2").nv, 12);
}

}  // namespace
}  // namespace rbd
