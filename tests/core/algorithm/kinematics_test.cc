// Poses against products of SE3, velocities and Jacobians against finite differences, in all three
// references.
#include "rbd/algorithm/kinematics.h"

#include <gtest/gtest.h>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::distance;
using testing::kEps;

constexpr ReferenceFrame kReferences[] = {WORLD, LOCAL, LOCAL_WORLD_ALIGNED};

// What a joint does, from its definition and the public SE3 alone.
SE3 jointPose(const JointModel& joint, const Eigen::VectorXd& q) {
  const double* x = q.data() + joint.idx_q();
  const auto turn = [](const Eigen::Vector3d& axis, double angle) {
    return SE3(exp3(axis * angle), Eigen::Vector3d::Zero());
  };
  switch (joint.kind()) {
    case JointKind::Revolute:
    case JointKind::Continuous:
      return turn(joint.axis(), x[0]);
    case JointKind::Helical:
      return SE3(exp3(joint.axis() * x[0]), joint.pitch() * x[0] * joint.axis());
    case JointKind::Universal:
      return turn(joint.axis(), x[0]) * turn(joint.axis2(), x[1]);
    case JointKind::Spherical:
      return SE3(Eigen::Quaterniond(x[3], x[0], x[1], x[2]), Eigen::Vector3d::Zero());
    case JointKind::Planar: {
      const SE3 plane(rotationWithZ(joint.axis()), Eigen::Vector3d::Zero());
      return plane * SE3(exp3({0, 0, std::atan2(x[3], x[2])}), {x[0], x[1], 0}) * plane.inverse();
    }
    case JointKind::Translation:
      return SE3(Eigen::Matrix3d::Identity(), {x[0], x[1], x[2]});
    case JointKind::Prismatic:
      return SE3(Eigen::Matrix3d::Identity(), joint.axis() * x[0]);
    case JointKind::FreeFlyer:
      return SE3(Eigen::Quaterniond(x[6], x[3], x[4], x[5]), Eigen::Vector3d(x[0], x[1], x[2]));
    case JointKind::Fixed:
      break;
  }
  return SE3();
}

class Trees : public ::testing::TestWithParam<int> {
 protected:
  Model model =
      testing::randomTree(static_cast<unsigned>(GetParam()), 3 + 2 * GetParam(), GetParam() % 2 == 0);
  testing::State s = testing::randomState(model, static_cast<unsigned>(GetParam()));
  Data data{model};

  double followed(JointIndex j, const Eigen::VectorXd& q) const {
    if (!model.joints[j].mimics()) return q[model.joints[j].idx_q()];
    return model.mimic(j).multiplier * followed(model.mimic(j).leader, q) + model.mimic(j).offset;
  }
};

TEST_P(Trees, PosesAreProductsOfPlacements) {
  forwardKinematics(model, data, s.q);
  std::vector<SE3> oMi(1);
  for (JointIndex i = 1; i < model.njoints; ++i) {
    Eigen::VectorXd q = s.q;  // what a follower's own q would be
    if (model.joints[i].mimics()) q[model.joints[i].idx_q()] = followed(i, s.q);
    oMi.push_back(oMi[model.parents[i]] * model.jointPlacements[i] * jointPose(model.joints[i], q));
    // one product per level, entries up to the size of the robot
    EXPECT_TRUE(data.oMi[i].isApprox(oMi[i], 200 * kEps * model.njoints)) << model.names[i];
  }
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    const SE3 wanted = oMi[model.frames[f].parentJoint] * model.frames[f].placement;
    EXPECT_TRUE(data.oMf[f].isApprox(wanted, 200 * kEps * model.njoints)) << model.frames[f].name;
  }
}

// v and a from poses at q(t) = q + v t + a t^2 / 2, by central differences: error h^2 and eps / h.
TEST_P(Trees, VelocitiesAreTheRatesOfPoses) {
  const double h = 1e-5;
  forwardKinematics(model, data, s.q, s.v);
  Data before(model), after(model);
  forwardKinematics(model, before, integrate(model, s.q, -h * s.v));
  forwardKinematics(model, after, integrate(model, s.q, h * s.v));
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    const Motion local = log6(before.oMf[f].actInv(after.oMf[f])) * (0.5 / h);
    EXPECT_TRUE(getFrameVelocity(model, data, f, LOCAL).isApprox(local, 1e-6)) << model.frames[f].name;
    // the bystander sees the frame's origin move
    const Eigen::Vector3d rate = (after.oMf[f].translation() - before.oMf[f].translation()) / (2 * h);
    EXPECT_LE((getFrameVelocity(model, data, f, LOCAL_WORLD_ALIGNED).linear() - rate).norm(), 1e-6);
    EXPECT_TRUE(getFrameVelocity(model, data, f, WORLD).isApprox(data.oMf[f].act(local), 1e-5));
  }
  for (JointIndex i = 0; i < model.njoints; ++i) {
    Motion out;
    getVelocity(model, data, i, LOCAL, out);
    EXPECT_EQ(out, data.v[i]);
  }
}

TEST_P(Trees, AccelerationsAreTheRatesOfVelocities) {
  const double h = 1e-5;
  forwardKinematics(model, data, s.q, s.v, s.a);
  Data before(model), after(model);
  forwardKinematics(model, before, integrate(model, s.q, -h * s.v), s.v - h * s.a);
  forwardKinematics(model, after, integrate(model, s.q, h * s.v), s.v + h * s.a);
  for (JointIndex i = 1; i < model.njoints; ++i) {
    // the local components of a spatial velocity: their plain rate is the spatial acceleration
    const Motion rate = (after.v[i] - before.v[i]) * (0.5 / h);
    EXPECT_TRUE(data.a[i].isApprox(rate, 1e-5)) << model.names[i];
  }
}

TEST_P(Trees, JacobiansTimesVelocityAreVelocities) {
  forwardKinematics(model, data, s.q, s.v);
  computeJointJacobians(model, data, s.q);
  for (const ReferenceFrame reference : kReferences) {
    for (FrameIndex f = 0; f < model.nframes; ++f) {
      const Matrix6Xd J = getFrameJacobian(model, data, f, reference);
      EXPECT_LE(distance(testing::times(J, s.v), getFrameVelocity(model, data, f, reference).toVector()),
                1e-13);
    }
    for (JointIndex i = 0; i < model.njoints; ++i) {
      const Matrix6Xd J = getJointJacobian(model, data, i, reference);
      EXPECT_LE(distance(testing::times(J, s.v), getVelocity(model, data, i, reference).toVector()), 1e-13);
    }
  }
}

TEST_P(Trees, JacobianColumnsAreDerivativesOfPoses) {
  const double h = 1e-6;
  const FrameIndex f = model.nframes - 1;
  forwardKinematics(model, data, s.q);
  const Matrix6Xd J = computeFrameJacobian(model, data, s.q, f, LOCAL);
  Data before(model), after(model);
  for (int k = 0; k < model.nv; ++k) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.nv, k);
    forwardKinematics(model, before, integrate(model, s.q, -step));
    forwardKinematics(model, after, integrate(model, s.q, step));
    const Motion column = log6(before.oMf[f].actInv(after.oMf[f])) * (0.5 / h);
    EXPECT_LE((J.col(k) - column.toVector()).cwiseAbs().maxCoeff(), 1e-7) << k;
  }
}

TEST_P(Trees, JointJacobiansAreWorldColumns) {
  computeJointJacobians(model, data, s.q);
  for (JointIndex i = 1; i < model.njoints; ++i) {
    if (!model.tree().mimic.identity) break;  // there a column is the sum of a leader's and its followers'
    const Matrix6Xd J = getJointJacobian(model, data, i, WORLD);
    const int k = model.joints[i].idx_v();
    EXPECT_EQ(distance(J.col(k), data.J.col(k)), 0);
  }
  const Data copy = data;
  forwardKinematics(model, data, s.q);
  // the same sums, compiled twice: a few last bits
  for (JointIndex i = 1; i < model.njoints; ++i)
    EXPECT_TRUE(copy.oMi[i].isApprox(data.oMi[i], 20 * kEps * i));
}

INSTANTIATE_TEST_SUITE_P(Random, Trees, ::testing::Range(0, 8));

TEST(Kinematics, FramePlacementsFollowJointPoses) {
  const Model model = testing::randomTree(9, 5, false);
  Data data(model);
  const testing::State s = testing::randomState(model, 9);
  framesForwardKinematics(model, data, s.q);
  Data other(model);
  other.oMi = data.oMi;
  updateFramePlacements(model, other);
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    EXPECT_TRUE(other.oMf[f].isApprox(data.oMf[f], 0));
    EXPECT_TRUE(updateFramePlacement(model, other, f).isApprox(data.oMf[f], 1e-14));
  }
}

// far from the origin a free-flyer keeps its digits: the kernels work about the robot
TEST(Kinematics, FarFromTheOrigin) {
  const Model model = testing::randomTree(2, 10, true);
  const testing::State s = testing::randomState(model, 2);
  Data near(model), far(model);
  Eigen::VectorXd q = s.q;
  q.head<3>() += Eigen::Vector3d(1e6, -2e6, 3e6);
  EXPECT_LE(distance(crba(model, far, q), crba(model, near, s.q)), 1e-9);  // q itself is rounded to 5e-10
  EXPECT_LE(distance(aba(model, far, q, s.v, s.tau), aba(model, near, s.q, s.v, s.tau)), 1e-8);
}

}  // namespace
}  // namespace rbd
