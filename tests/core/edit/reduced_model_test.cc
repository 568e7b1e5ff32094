// Locking joints. The second road is the same robot with every joint free, mimic or not: the reduced robot
// moves it through  q_free = where its joints stand,  v_free = G v,  G zero for what is locked.
#include "rbd/edit/reduced_model.h"

#include <gtest/gtest.h>

#include <algorithm>
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

class Reduced : public ::testing::TestWithParam<int> {
 protected:
  unsigned seed = static_cast<unsigned>(GetParam());
  testing::Random random{seed};
  buildModels::RandomTree shape{.joints = 6 + 2 * GetParam(), .floating_base = GetParam() % 2 == 0};
  Model free = buildModels::randomTree(seed, shape);
  Model model = [this] {
    shape.mimic = GetParam() % 3 != 0;
    return buildModels::randomTree(seed, shape);
  }();
  std::vector<JointIndex> locked;  // listed, not all that follow
  Eigen::VectorXd at = testing::randomState(model, seed).q;
  Model reduced;
  testing::State s;                                    // of the reduced model
  Eigen::VectorXd q = Eigen::VectorXd(free.nq), v, a;  // the same of the free one
  Eigen::MatrixXd G;

  void SetUp() override {
    // every number a joint may have, in every model; the rotors of followers do not exist
    model.terms = free.terms = {true, true, true, true};
    for (Eigen::VectorXd Model::* list :
         {&Model::armature, &Model::rotorInertia, &Model::rotorGearRatio, &Model::damping, &Model::friction,
          &Model::lowerEffortLimit, &Model::upperEffortLimit, &Model::lowerVelocityLimit,
          &Model::upperVelocityLimit}) {
      (model.*list) = random.vec(model.nv).cwiseAbs();
      (free.*list).setZero();
      for (JointIndex j = 1; j < model.njoints; ++j) {
        const int n = model.joints[j].nv();
        (free.*list).segment(free.joints[j].idx_v(), n) = (model.*list).segment(model.joints[j].idx_v(), n);
      }
    }
    model.lowerPositionLimit = -random.vec(model.nq).cwiseAbs();
    model.upperPositionLimit = random.vec(model.nq).cwiseAbs();
    model.gravity = free.gravity = Motion(Eigen::Vector3d::Zero(), random.vec3(9));

    // a floating base stays, so that the mass does; else anything may go
    for (JointIndex j = shape.floating_base ? 2 : 1; j < model.njoints; ++j) {
      if (random.below(3) == 0) locked.push_back(j);
    }
    std::reverse(locked.begin(), locked.end());
    reduced = buildReducedModel(model, locked, at);

    s = testing::randomState(reduced, seed);
    G = Eigen::MatrixXd::Zero(free.nv, reduced.nv);
    for (JointIndex j = 1; j < model.njoints; ++j) {
      const JointModel& joint = free.joints[j];
      q.segment(joint.idx_q(), joint.nq()) = numbers(j);
      for (int k = 0; k < joint.nv(); ++k) {
        if (!isLocked(j)) G(joint.idx_v() + k, dof(j) + k) = ratio(j);
      }
    }
    v = times(G, s.v);
    a = times(G, s.a);
  }

  bool isListed(JointIndex j) const { return std::find(locked.begin(), locked.end(), j) != locked.end(); }
  bool isLocked(JointIndex j) const {
    return isListed(j) || (model.mimic(j).leader >= 0 && isLocked(model.mimic(j).leader));
  }
  double ratio(JointIndex j) const {
    const Mimic& m = model.mimic(j);
    return m.leader < 0 ? 1 : m.multiplier * ratio(m.leader);
  }
  JointIndex leader(JointIndex j) const {
    return model.mimic(j).leader < 0 ? j : leader(model.mimic(j).leader);
  }
  int dof(JointIndex j) const { return reduced.joints[reduced.jointId(model.names[leader(j)])].idx_v(); }
  // Where joint j stands: in `at` if it is locked, else in s.q.
  Eigen::VectorXd numbers(JointIndex j, bool held = false) const {
    held = held || isLocked(j);
    const Mimic& m = model.mimic(j);
    if (m.leader >= 0)
      return Eigen::VectorXd::Constant(1, m.multiplier * numbers(m.leader, held)[0] + m.offset);
    const JointModel& joint = held ? model.joints[j] : reduced.joints[reduced.jointId(model.names[j])];
    return (held ? at : s.q).segment(joint.idx_q(), joint.nq());
  }
  Eigen::MatrixXd project(const Eigen::MatrixXd& m) const { return times(G.transpose(), times(m, G)); }
};

TEST_P(Reduced, KeepsNamesFramesAndNumbers) {
  EXPECT_EQ(reduced.name, model.name);
  EXPECT_EQ(reduced.nframes, model.nframes);
  EXPECT_EQ(reduced.nbodies, model.nbodies);
  int moving = 1;
  for (JointIndex j = 1; j < model.njoints; ++j) {
    const JointIndex k = reduced.getJointId(model.names[j]);
    EXPECT_EQ(k == reduced.njoints, isLocked(j)) << model.names[j];
    if (isLocked(j)) continue;
    EXPECT_EQ(k, moving++);  // in the same order
    const JointModel &x = model.joints[j], &y = reduced.joints[k];
    EXPECT_EQ(x.shortname(), y.shortname());
    EXPECT_EQ(x.mimics(), y.mimics());
    for (Eigen::VectorXd Model::* list :
         {&Model::armature, &Model::rotorInertia, &Model::rotorGearRatio, &Model::damping, &Model::friction,
          &Model::lowerEffortLimit, &Model::upperEffortLimit, &Model::lowerVelocityLimit,
          &Model::upperVelocityLimit}) {
      EXPECT_EQ((reduced.*list).segment(y.idx_v(), y.nv()), (model.*list).segment(x.idx_v(), x.nv()));
    }
    for (Eigen::VectorXd Model::* list : {&Model::lowerPositionLimit, &Model::upperPositionLimit})
      EXPECT_EQ((reduced.*list).segment(y.idx_q(), y.nq()), (model.*list).segment(x.idx_q(), x.nq()));
  }
  EXPECT_EQ(reduced.njoints, moving);
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    const Frame &x = model.frames[f], &y = reduced.frames[f];
    EXPECT_EQ(x.name, y.name);
    const bool welded = x.type == JOINT && isLocked(x.parentJoint);
    EXPECT_EQ(y.type, welded ? FIXED_JOINT : x.type);
  }
}

TEST_P(Reduced, MovesLikeTheWhole) {
  Data data(reduced), whole(free);
  forwardKinematics(reduced, data, s.q, s.v, s.a);
  forwardKinematics(free, whole, q, v, a);
  computeJointJacobians(reduced, data, s.q);
  computeJointJacobians(free, whole, q);
  for (FrameIndex f = 0; f < model.nframes; ++f) {
    EXPECT_LE(distance(data.oMf[f].toHomogeneousMatrix(), whole.oMf[f].toHomogeneousMatrix()), kTol);
    for (const ReferenceFrame reference : {WORLD, LOCAL, LOCAL_WORLD_ALIGNED}) {
      EXPECT_LE(distance(getFrameVelocity(reduced, data, f, reference).toVector(),
                         getFrameVelocity(free, whole, f, reference).toVector()),
                kTol);
      EXPECT_LE(distance(getFrameJacobian(reduced, data, f, reference),
                         times(getFrameJacobian(free, whole, f, reference), G)),
                kTol);
    }
  }
  EXPECT_LE(distance(data.J, times(whole.J, G)), kTol);
  for (JointIndex j = 1; j < reduced.njoints; ++j) {
    EXPECT_LE(distance(data.a[j].toVector(), whole.a[free.jointId(reduced.names[j])].toVector()), kTol);
  }
}

TEST_P(Reduced, HasTheWholesDynamics) {
  Data data(reduced), whole(free);
  const Eigen::MatrixXd Gt = G.transpose();
  // rotors and friction are nonlinear maps of each dof's own numbers; a follower has none
  EXPECT_LE(distance(rnea(reduced, data, s.q, s.v, s.a), times(Gt, rnea(free, whole, q, v, a))), kTol);
  EXPECT_LE(
      distance(nonLinearEffects(reduced, data, s.q, s.v), times(Gt, nonLinearEffects(free, whole, q, v))),
      kTol);
  EXPECT_LE(distance(computeGeneralizedGravity(reduced, data, s.q),
                     times(Gt, computeGeneralizedGravity(free, whole, q))),
            kTol);
  EXPECT_LE(distance(crba(reduced, data, s.q), project(crba(free, whole, q))), kTol);
  const double kinetic = computeKineticEnergy(free, whole, q, v);
  EXPECT_NEAR(computeKineticEnergy(reduced, data, s.q, s.v), kinetic, kTol * std::max(1.0, kinetic));
  if (reduced.nv == 0) return;
  const Eigen::VectorXd tau = rnea(reduced, data, s.q, s.v, s.a);
  const Eigen::MatrixXd M = crba(reduced, data, s.q), Minv = computeMinverse(reduced, data, s.q);
  EXPECT_LE(distance(aba(reduced, data, s.q, s.v, tau), s.a), kTol * testing::condition(M, Minv));
}

// What is welded to the ground is the ground's: moments of mass add up, Jacobians do.
TEST_P(Reduced, HasTheWholesMass) {
  Data data(reduced), whole(free);
  if (reduced.nv == 0) return;
  jacobianCenterOfMass(free, whole, q);
  jacobianCenterOfMass(reduced, data, s.q);
  const Inertia &before = model.inertias[0], &ground = reduced.inertias[0];
  EXPECT_NEAR(whole.mass[0], data.mass[0] + ground.mass() - before.mass(), kTol * whole.mass[0]);
  EXPECT_LE(
      distance(whole.mass[0] * whole.com[0],
               data.mass[0] * data.com[0] + ground.mass() * ground.lever() - before.mass() * before.lever()),
      kTol);
  EXPECT_LE(distance(data.mass[0] * Eigen::MatrixXd(data.Jcom), whole.mass[0] * times(whole.Jcom, G)), kTol);
  if (ground.mass() != before.mass()) return;
  EXPECT_LE(distance(computeCentroidalMomentumTimeVariation(reduced, data, s.q, s.v, s.a).toVector(),
                     computeCentroidalMomentumTimeVariation(free, whole, q, v, a).toVector()),
            kTol);
}

INSTANTIATE_TEST_SUITE_P(Random, Reduced, ::testing::Range(1, 21));

TEST(ReducedModel, LockingNothingChangesNothing) {
  const Model model = testing::randomTree(5, 15, true);
  const testing::State s = testing::randomState(model, 5);
  const Model same = buildReducedModel(model, {}, s.q);
  EXPECT_EQ(same.topology(), model.topology());
  Data data(model), data2(same);
  EXPECT_EQ(rnea(model, data, s.q, s.v, s.a), rnea(same, data2, s.q, s.v, s.a));
}

TEST(ReducedModel, LockingAllLeavesAStatue) {
  const Model model = testing::randomTree(4, 9, false);
  std::vector<JointIndex> all;
  for (JointIndex j = 1; j < model.njoints; ++j) all.push_back(j);
  const testing::State s = testing::randomState(model, 4);
  const Model statue = buildReducedModel(model, all, s.q);
  EXPECT_EQ(statue.nv, 0);
  EXPECT_EQ(statue.njoints, 1);
  Data data(model), held(statue);
  forwardKinematics(model, data, s.q);
  forwardKinematics(statue, held, Eigen::VectorXd(0));
  for (FrameIndex f = 0; f < model.nframes; ++f)
    EXPECT_LE(distance(held.oMf[f].toHomogeneousMatrix(), data.oMf[f].toHomogeneousMatrix()), kTol);
}

// c follows b follows a. Locking one holds those behind it and leaves those before it free.
TEST(ReducedModel, ChainsOfFollowers) {
  Model model;
  const char* names[] = {"a", "b", "c"};
  for (JointIndex j = 0; j < 3; ++j) model.addJoint(j, JointModelRZ(), SE3(), names[j]);
  model.setMimic(3, 2, 2, 0.1);
  model.setMimic(2, 1, -3, 0.2);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.5);  // b = -1.3, c = -2.5
  const auto angle = [](const Model& m, double x) {
    Data data(m);
    forwardKinematics(m, data, Eigen::VectorXd::Constant(m.nq, x));
    const Eigen::Vector3d end = log3(data.oMf[m.frameId("c")].rotation());
    return end.z();
  };
  EXPECT_EQ(buildReducedModel(model, {1}, q).nq, 0);
  EXPECT_NEAR(angle(buildReducedModel(model, {1}, q), 0), 0.5 - 1.3 - 2.5 + 2 * PI<double>(), 1e-14);
  const Model second = buildReducedModel(model, {2}, q), third = buildReducedModel(model, {3}, q);
  EXPECT_EQ(second.njoints, 2);
  EXPECT_NEAR(angle(second, 0.7), 0.7 - 1.3 - 2.5, 1e-14);
  EXPECT_EQ(third.njoints, 3);
  EXPECT_EQ(third.nq, 1);
  EXPECT_NEAR(angle(third, 0.7), 0.7 + (-3 * 0.7 + 0.2) - 2.5 + 2 * PI<double>(), 1e-14);
}

TEST(ReducedModel, FramesKeepTheirInertia) {
  Model model;
  testing::Random random(1);
  model.addJoint(0, JointModelRX(), random.pose(), "a");
  model.addJoint(1, JointModelPY(), random.pose(), "b");
  const Inertia link = random.inertia(), hidden = random.inertia();
  model.addBodyFrame("link", 2, random.pose(), 0, link);
  model.appendBodyToJoint(2, hidden);
  const Model reduced = buildReducedModel(model, {2}, Eigen::Vector2d(0.3, 0.4));
  const Frame& frame = reduced.frames[reduced.frameId("link")];
  EXPECT_TRUE(frame.inertia.isApprox(link, 0));
  EXPECT_EQ(reduced.nbodies, 3);
  EXPECT_NEAR(reduced.inertias[1].mass(), link.mass() + hidden.mass(), 1e-15);
  const SE3 b = reduced.frames[reduced.frameId("b")].placement;
  EXPECT_TRUE(reduced.inertias[1].isApprox(frame.placement.act(link) + b.act(hidden), 1e-14));
}

TEST(ReducedModel, ShapesMoveAlong) {
  Model model;
  buildModels::humanoid(model);
  const GeometryModel shapes = buildModels::humanoidGeometries(model);
  const testing::State s = testing::randomState(model, 1);
  GeometryModel moved = shapes;
  const std::vector<JointIndex> locked = {model.jointId("left_knee"), model.jointId("head_yaw"), 1};
  const Model reduced = buildReducedModel(model, moved, locked, s.q, moved);
  Data data(model), held(reduced);
  Eigen::VectorXd q(reduced.nq);
  for (JointIndex j = 1; j < reduced.njoints; ++j)
    q[reduced.joints[j].idx_q()] = s.q[model.joints[model.jointId(reduced.names[j])].idx_q()];
  forwardKinematics(model, data, s.q);
  forwardKinematics(reduced, held, q);
  ASSERT_EQ(moved.visual.size(), shapes.visual.size());
  ASSERT_EQ(moved.collision.size(), shapes.collision.size());
  for (std::size_t i = 0; i < shapes.visual.size(); ++i) {
    const GeometryObject &x = shapes.visual[i], &y = moved.visual[i];
    EXPECT_TRUE(
        (held.oMi[y.parentJoint] * y.placement).isApprox(data.oMi[x.parentJoint] * x.placement, 1e-13));
    EXPECT_EQ(model.frames[x.parentFrame].name, reduced.frames[y.parentFrame].name);
  }
}

TEST(ReducedModel, Refuses) {
  Model model;
  buildModels::humanoid(model);
  const Eigen::VectorXd q = neutral(model);
  EXPECT_EQ(errorOf([&] { buildReducedModel(model, {99}, q); }),
            "buildReducedModel: joint index 99 does not exist, model 'humanoid' has 32 joints");
  EXPECT_EQ(errorOf([&] { buildReducedModel(model, {0}, q); }),
            "buildReducedModel: joint 0 is the universe, it cannot be locked");
  EXPECT_EQ(errorOf([&] { buildReducedModel(model, {2}, Eigen::VectorXd::Zero(3)); }),
            "buildReducedModel: q has 3 entries, model 'humanoid' needs 37 (nq)");
  EXPECT_NE(errorOf([&] {
              buildReducedModel(model, {2}, Eigen::VectorXd::Zero(37));
            }).find("buildReducedModel: the quaternion of joint 'root_joint'"),
            std::string::npos);
  Model broken = model;
  broken.friction.resize(3);
  EXPECT_NE(errorOf([&] {
              buildReducedModel(broken, {2}, q);
            }).find("buildReducedModel: a vector of model 'humanoid' has 3 entries where 36 (nv)"),
            std::string::npos);
}

}  // namespace
}  // namespace rbd
