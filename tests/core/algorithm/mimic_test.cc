// Joints that mimic others: every quantity equals that of the same robot with all joints free, projected by
// the linear map between the two (q_free = G q + offset).
#include <gtest/gtest.h>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::distance;
using testing::kEps;
using testing::times;

class Mimics : public ::testing::TestWithParam<int> {
 protected:
  unsigned seed = static_cast<unsigned>(GetParam());
  buildModels::RandomTree shape{.joints = 6 + 3 * GetParam(), .floating_base = GetParam() % 2 == 0};
  Model free = buildModels::randomTree(seed, shape);
  Model model = [this] {
    shape.mimic = true;
    return buildModels::randomTree(seed, shape);
  }();
  Data data{model}, free_data{free};
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(free.nv, model.nv);
  testing::State s = testing::randomState(model, seed);
  Eigen::VectorXd q = freeQ(s.q), v, a;

  void SetUp() override {
    // the rotors of followers do not exist
    model.armature.setConstant(0.1);
    free.armature.setZero();
    for (JointIndex j = 1; j < model.njoints; ++j) {
      const JointModel& joint = free.joints[j];
      for (int k = 0; k < joint.nv(); ++k) {
        G(joint.idx_v() + k, model.joints[j].idx_v() + k) = ratio(j);
        if (!model.joints[j].mimics()) free.armature[joint.idx_v() + k] = 0.1;
      }
    }
    v = times(G, s.v);
    a = times(G, s.a);
  }
  double ratio(JointIndex j) const {
    return model.joints[j].mimics() ? model.mimic(j).multiplier * ratio(model.mimic(j).leader) : 1;
  }
  // One number per joint, by the definition of following.
  double followed(JointIndex j, const Eigen::VectorXd& x) const {
    const Mimic& m = model.mimic(j);
    return m.leader < 0 ? x[model.joints[j].idx_q()] : m.multiplier * followed(m.leader, x) + m.offset;
  }
  Eigen::VectorXd freeQ(const Eigen::VectorXd& x) const {
    Eigen::VectorXd out(free.nq);
    for (JointIndex j = 1; j < model.njoints; ++j) {
      const JointModel& joint = free.joints[j];
      if (joint.nv() == 1) {
        out[joint.idx_q()] = followed(j, x);
      } else {
        out.segment(joint.idx_q(), joint.nq()) = x.segment(model.joints[j].idx_q(), joint.nq());
      }
    }
    return out;
  }
  Eigen::MatrixXd project(const Eigen::MatrixXd& m) const { return times(G.transpose(), times(m, G)); }
};

constexpr double kTol = 1e3 * kEps;

TEST_P(Mimics, NumbersShrink) {
  int followers = 0;
  for (const JointModel& joint : model.joints) followers += joint.mimics();
  EXPECT_GT(followers, 0);
  EXPECT_EQ(model.nv, free.nv - followers);
  EXPECT_EQ(model.upperEffortLimit.size(), model.nv);
  EXPECT_EQ(model.lowerPositionLimit.size(), model.nq);
}

TEST_P(Mimics, PosesVelocitiesAccelerations) {
  forwardKinematics(model, data, s.q, s.v, s.a);
  forwardKinematics(free, free_data, q, v, a);
  for (FrameIndex f = 0; f < model.nframes; ++f)
    EXPECT_TRUE(data.oMf[f].isApprox(free_data.oMf[f], kTol * 10));
  for (JointIndex j = 0; j < model.njoints; ++j) {
    EXPECT_LE(distance(data.v[j].toVector(), free_data.v[j].toVector()), kTol);
    EXPECT_LE(distance(data.a[j].toVector(), free_data.a[j].toVector()), kTol);
  }
}

TEST_P(Mimics, EffortsAndInertia) {
  const Eigen::MatrixXd Gt = G.transpose();
  EXPECT_LE(distance(rnea(model, data, s.q, s.v, s.a), times(Gt, rnea(free, free_data, q, v, a))), kTol);
  EXPECT_LE(
      distance(nonLinearEffects(model, data, s.q, s.v), times(Gt, nonLinearEffects(free, free_data, q, v))),
      kTol);
  EXPECT_LE(distance(computeGeneralizedGravity(model, data, s.q),
                     times(Gt, computeGeneralizedGravity(free, free_data, q))),
            kTol);
  EXPECT_LE(distance(crba(model, data, s.q), project(crba(free, free_data, q))), kTol);
}

TEST_P(Mimics, ForwardDynamics) {
  const Eigen::MatrixXd M = crba(model, data, s.q), Minv = computeMinverse(model, data, s.q);
  const double bound = kTol * testing::condition(M, Minv);
  EXPECT_LE(distance(times(Minv, M), Eigen::MatrixXd::Identity(model.nv, model.nv)), bound);
  const Eigen::VectorXd tau = rnea(model, data, s.q, s.v, s.a);
  EXPECT_LE(distance(aba(model, data, s.q, s.v, tau), s.a), bound);
}

TEST_P(Mimics, JacobiansAndMomentum) {
  computeJointJacobians(model, data, s.q);
  computeJointJacobians(free, free_data, q);
  EXPECT_LE(distance(data.J, times(free_data.J, G)), kTol);
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    for (const ReferenceFrame reference : {WORLD, LOCAL, LOCAL_WORLD_ALIGNED}) {
      EXPECT_LE(distance(getFrameJacobian(model, data, f, reference),
                         times(getFrameJacobian(free, free_data, f, reference), G)),
                kTol);
    }
  }
  EXPECT_LE(
      distance(jacobianCenterOfMass(model, data, s.q), times(jacobianCenterOfMass(free, free_data, q), G)),
      kTol);
  EXPECT_LE(distance(computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, s.a).toVector(),
                     computeCentroidalMomentumTimeVariation(free, free_data, q, v, a).toVector()),
            kTol);
  EXPECT_NEAR(computeKineticEnergy(model, data, s.q, s.v),
              0.5 * s.v.dot(times(crba(model, data, s.q), s.v).col(0)),
              kTol * std::max(1.0, data.kinetic_energy));
}

INSTANTIATE_TEST_SUITE_P(Random, Mimics, ::testing::Range(1, 11));

TEST(MimicErrors, AreNamed) {
  Model model;
  const JointIndex a = model.addJoint(0, JointModelRX(), SE3(), "a"),
                   b = model.addJoint(a, JointModelRY(), SE3(), "b");
  const JointIndex ball = model.addJoint(b, JointModelSpherical(), SE3(), "ball");
  const auto message = [&](JointIndex follower, JointIndex leader, double multiplier) -> std::string {
    try {
      model.setMimic(follower, leader, multiplier);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message(a, a, 1), "setMimic 'a' to 'a': a joint cannot follow itself");
  EXPECT_EQ(message(ball, a, 1),
            "setMimic 'ball' to 'a': 'ball' is Spherical, only joints of one degree of freedom mimic");
  EXPECT_EQ(message(b, a, std::nan("")), "setMimic 'b' to 'a': multiplier and offset must be finite");
  EXPECT_EQ(message(b, a, -2), "");
  EXPECT_EQ(message(a, b, 1), "setMimic 'a' to 'b': a joint cannot follow itself");
  EXPECT_NE(message(9, a, 1), "");
  EXPECT_EQ(model.nv, 4);
  EXPECT_EQ(model.joints[b].idx_v(), model.joints[a].idx_v());
}

// Data made before a joint began to follow another does not fit any more.
TEST(MimicErrors, OldDataIsRefused) {
  Model model;
  model.addJoint(0, JointModelRX(), SE3(), "a");
  model.addJoint(1, JointModelRY(), SE3(), "b");
  Data data(model);
  model.setMimic(2, 1);
  EXPECT_THROW(crba(model, data, Eigen::VectorXd::Zero(1)), std::invalid_argument);
}

}  // namespace
}  // namespace rbd
