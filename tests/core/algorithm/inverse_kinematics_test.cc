// Inverse kinematics by second roads: forward kinematics, closed formulas of planar arms, distances that
// geometry gives, and neighbours that must not be better.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::kEps;

struct Residual {
  double position = 0, rotation = 0, cost = 0;
};

// What is left of the way to the targets, by forward kinematics.
Residual residual(const Model& model, const std::vector<FrameTarget>& targets, const Eigen::VectorXd& q,
                  double length = IkOptions().length) {
  Data data(model);
  forwardKinematics(model, data, q);
  Residual out;
  for (const FrameTarget& target : targets) {
    const SE3 error = data.oMf[target.frame].actInv(target.pose);
    const double p = error.translation().norm();
    const double r = target.rotation ? log3(Eigen::Quaterniond(error.rotation()).normalized()).norm() : 0;
    out.position = std::max(out.position, p);
    out.rotation = std::max(out.rotation, r);
    out.cost += (p * p + length * length * r * r) / 2;
  }
  return out;
}

bool insideLimits(const Model& model, const Eigen::VectorXd& q) {
  return ((q - model.lowerPositionLimit).array() >= 0).all() &&
         ((model.upperPositionLimit - q).array() >= 0).all();
}

// Every number that adds may go from -2 to 2, a joint's quaternion as it likes.
void setLimits(Model& model) {
  for (const JointModel& joint : model.joints) {
    if (joint.manifold() != Manifold::Angles && joint.manifold() != Manifold::Lengths) continue;
    for (int k = joint.idx_q(); k < joint.idx_q() + joint.nq(); ++k) {
      model.lowerPositionLimit[k] = -2;
      model.upperPositionLimit[k] = 2;
    }
  }
}

// Where the frames stand in a configuration drawn from `engine`: targets that can be reached.
std::vector<FrameTarget> reachable(const Model& model, const std::vector<FrameIndex>& frames, bool rotation,
                                   std::mt19937_64& engine) {
  Data data(model);
  forwardKinematics(model, data, randomConfiguration(model, engine));
  std::vector<FrameTarget> out;
  for (const FrameIndex frame : frames) out.push_back({frame, data.oMf[frame], rotation});
  return out;
}

void expectReached(const Model& model, const std::vector<FrameTarget>& targets, IkScratch& scratch,
                   std::mt19937_64& engine) {
  const IkOptions options;
  Eigen::VectorXd q = randomConfiguration(model, engine);
  const IkResult result = inverseKinematics(model, scratch, targets, options, q);
  EXPECT_TRUE(result) << describe(model, result);
  const Residual left = residual(model, targets, q);
  EXPECT_LE(left.position, options.position_tolerance * (1 + 1e-6));
  EXPECT_LE(left.rotation, options.rotation_tolerance * (1 + 1e-6));
  EXPECT_NEAR(left.position, result.position_error, 1e3 * kEps * 10);  // places of order 10 m
  // the rotation error comes from a quaternion whose w is near 1: its vector part has the accuracy of eps
  EXPECT_NEAR(left.rotation, result.rotation_error, 1e3 * kEps);
  EXPECT_TRUE(insideLimits(model, q)) << q.transpose();
  EXPECT_TRUE(isNormalized(model, q));
}

TEST(InverseKinematics, RandomTreesReachWhatTheyCan) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Model model = testing::randomTree(seed, 6 + static_cast<int>(seed % 6), seed % 4 == 2);
    if (seed % 2 == 0) setLimits(model);
    IkScratch scratch(model);
    std::mt19937_64 engine(seed);
    for (int n = 0; n < 5; ++n) {
      for (const bool rotation : {false, true})
        expectReached(model, reachable(model, {model.nframes - 1 - n}, rotation, engine), scratch, engine);
    }
  }
}

TEST(InverseKinematics, SampleRobots) {
  std::mt19937_64 engine(7);
  Model arm, humanoid;
  buildModels::manipulator(arm);
  buildModels::humanoid(humanoid);
  IkScratch scratch(arm), other(humanoid, 3);
  const FrameIndex head = humanoid.nframes - 1;
  for (int n = 0; n < 50; ++n) {
    SCOPED_TRACE(n);
    for (const bool rotation : {false, true})
      expectReached(arm, reachable(arm, {arm.frameId("arm_tool_link")}, rotation, engine), scratch, engine);
    expectReached(humanoid, reachable(humanoid, {head}, true, engine), other, engine);
    expectReached(humanoid, reachable(humanoid, {head, head / 2, head / 4}, false, engine), other, engine);
  }
}

// Links of the given lengths in the x-y plane, a frame "tip" at the end.
Model planarArm(const std::vector<double>& lengths) {
  Model model;
  const auto along = [](double x) { return SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, 0, 0)); };
  double last = 0;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const std::string name = "joint" + std::to_string(k + 1);
    model.addJoint(static_cast<JointIndex>(k), JointModelRZ(), along(last), name);
    last = lengths[k];
  }
  model.addFrame(Frame("tip", model.njoints - 1, along(last), OP_FRAME));
  return model;
}

FrameTarget point(const Model& model, double x, double y, double z = 0) {
  return {model.frameId("tip"), SE3(Eigen::Matrix3d::Identity(), {x, y, z}), false};
}

// Both ways of a two-link arm to x, y (law of cosines): sign +1 or -1 is that of the elbow's angle.
Eigen::Vector2d twoLinks(double l1, double l2, double x, double y, double sign) {
  const double elbow = sign * std::acos((x * x + y * y - l1 * l1 - l2 * l2) / (2 * l1 * l2));
  return {std::atan2(y, x) - std::atan2(l2 * std::sin(elbow), l1 + l2 * std::cos(elbow)), elbow};
}

TEST(InverseKinematics, TwoLinkArmBothElbows) {
  const double l1 = 0.5, l2 = 0.4;
  const Model model = planarArm({l1, l2});
  IkScratch scratch(model);
  IkOptions options;
  options.position_tolerance = 1e-11;
  testing::Random random(3);
  for (int n = 0; n < 30; ++n) {
    const double radius = random.in(0.2, 0.85), angle = random.in(-3, 3);
    const FrameTarget target = point(model, radius * std::cos(angle), radius * std::sin(angle));
    for (const double elbow : {1.0, -1.0}) {
      const Eigen::Vector2d want =
          twoLinks(l1, l2, target.pose.translation().x(), target.pose.translation().y(), elbow);
      Eigen::VectorXd q = want + Eigen::Vector2d(random.in(-0.2, 0.2), random.in(-0.1, 0.1));
      const IkResult result = inverseKinematics(model, scratch, target, options, q);
      EXPECT_TRUE(result) << describe(model, result);
      EXPECT_EQ(result.starts, 1);
      // det J = l1 l2 sin(elbow) and |J| < 2: an error of the tip is at most this much larger in the joints
      const double worse = 2 / (l1 * l2 * std::abs(std::sin(want[1])));
      EXPECT_LE((q - want).norm(), worse * options.position_tolerance) << want.transpose();
    }
  }
}

// The nearest point of a two-link arm is known: on the circle of the stretched arm, or of the folded one.
TEST(InverseKinematics, OutOfReachStopsAtTheBoundary) {
  const double l1 = 0.5, l2 = 0.3;
  const Model model = planarArm({l1, l2});
  IkScratch scratch(model);
  IkOptions options;
  options.position_tolerance = 1e-9;
  options.iterations = 2000;  // the last of the way is slow where the arm is folded
  testing::Random random(4);
  for (int n = 0; n < 20; ++n) {
    const double angle = random.in(-3, 3), far = 0.8 + std::pow(10, random.in(-3, 3)),
                 near = random.in(0.01, 0.19);
    const double z = random.in(-0.6, 0.6);
    const auto solve = [&](double radius, double height, double distance, IkStop stop) {
      const FrameTarget target = point(model, radius * std::cos(angle), radius * std::sin(angle), height);
      Eigen::VectorXd q = random.vec(2, 3);
      const IkResult result = inverseKinematics(model, scratch, target, options, q);
      EXPECT_EQ(result.stop, stop) << describe(model, result);
      EXPECT_NEAR(result.position_error, distance, 1e-9 + 1e-14 * radius);
      EXPECT_NEAR(residual(model, {target}, q).position, distance, 1e-9 + 1e-14 * radius);
    };
    solve(far, 0, far - 0.8, IkStop::OutOfReach);
    solve(near, 0, 0.2 - near, IkStop::Stalled);
    solve(0.5, z, std::abs(z), IkStop::Stalled);  // beside the plane, but not beyond the arm's length
  }
  // on the boundary itself the arm is singular, and reaches all the same
  Eigen::VectorXd q = Eigen::Vector2d(1, 1);
  const FrameTarget edge = point(model, 0.8, 0);
  const IkResult result = inverseKinematics(model, scratch, edge, IkOptions(), q);
  EXPECT_TRUE(result) << describe(model, result);
  // the tip is a^2 l1 l2 / (2 (l1 + l2)) short when the elbow stands at a
  EXPECT_LE(std::abs(q[1]), std::sqrt(2 * 0.8 / (l1 * l2) * 1e-6));
}

// Stretched, with the target between shoulder and tip: no joint moves the tip towards it.
TEST(InverseKinematics, ASingularStartStaysWithoutRestarts) {
  const Model model = planarArm({0.5, 0.4});
  IkScratch scratch(model);
  IkOptions options;
  options.restarts = 0;
  const FrameTarget target = point(model, 0.6, 0);
  Eigen::VectorXd q = Eigen::Vector2d::Zero();
  IkResult result = inverseKinematics(model, scratch, target, options, q);
  EXPECT_EQ(result.stop, IkStop::Stalled);
  EXPECT_EQ(
      describe(model, result),
      "stalled at a singularity or a local minimum: 0.3 m from the target, after 1 start and 0 iterations");
  EXPECT_EQ(q, Eigen::VectorXd(Eigen::Vector2d::Zero()));

  options.restarts = 5;
  result = inverseKinematics(model, scratch, target, options, q);
  EXPECT_TRUE(result) << describe(model, result);
  EXPECT_EQ(result.starts, 2);
  EXPECT_LE(residual(model, {target}, q).position, options.position_tolerance * (1 + 1e-6));

  options.iterations = 2;
  options.restarts = 0;
  q = Eigen::Vector2d(0.1, 2);
  EXPECT_EQ(inverseKinematics(model, scratch, target, options, q).stop, IkStop::IterationsUsedUp);
}

TEST(InverseKinematics, AJointAtItsLimitIsNamed) {
  const double l1 = 0.5, l2 = 0.4;
  Model model = planarArm({l1, l2});
  model.lowerPositionLimit[1] = 0.5;
  model.upperPositionLimit[1] = 2.5;
  IkScratch scratch(model);
  // the farthest circle that the elbow allows
  const double reach = std::sqrt(l1 * l1 + l2 * l2 + 2 * l1 * l2 * std::cos(0.5));
  ASSERT_LT(reach, 0.88);
  Eigen::VectorXd q = Eigen::Vector2d(-2, 1);
  IkResult result = inverseKinematics(model, scratch, point(model, 0, 0.89), IkOptions(), q);
  EXPECT_EQ(result.stop, IkStop::AtLimits);
  EXPECT_EQ(model.names[result.limit], "joint2");
  EXPECT_NEAR(result.position_error, 0.89 - reach, 1e-12);
  EXPECT_EQ(q[1], 0.5);
  EXPECT_EQ(describe(model, result).substr(0, 28), "joint 'joint2' is at its lim");

  // a start on the forbidden side, also beyond the limit, ends on the allowed one
  q = twoLinks(l1, l2, 0.4, 0.3, -1);
  ASSERT_LT(q[1], 0);
  result = inverseKinematics(model, scratch, point(model, 0.4, 0.3), IkOptions(), q);
  EXPECT_TRUE(result) << describe(model, result);
  EXPECT_LE((q - twoLinks(l1, l2, 0.4, 0.3, 1)).norm(), 1e-5);
}

// Limits of joints whose velocities are not the rates of their numbers.
TEST(InverseKinematics, ABoundedBaseStopsAtItsWall) {
  for (const bool planar : {false, true}) {
    Model model;
    if (planar) {
      model.addJoint(0, JointModelPlanar(), SE3(), "base");
    } else {
      model.addJoint(0, JointModelFreeFlyer(), SE3(), "base");
    }
    model.lowerPositionLimit.head<2>().setConstant(-0.25);
    model.upperPositionLimit.head<2>().setConstant(0.25);
    IkScratch scratch(model);
    const FrameTarget target{model.frameId("base"), SE3(exp3({0, 0, 1}), {0.5, -0.1, 0}), true};
    for (unsigned seed = 0; seed < 10; ++seed) {
      Eigen::VectorXd q = randomConfiguration(model, seed);
      const IkResult result = inverseKinematics(model, scratch, target, IkOptions(), q);
      // proven when the wall bounds every direction, otherwise seen
      EXPECT_EQ(result.stop, planar ? IkStop::OutOfReach : IkStop::AtLimits) << describe(model, result);
      EXPECT_NEAR(result.position_error, 0.25, 1e-10);
      EXPECT_NEAR(result.rotation_error, 0, 1e-6);
      EXPECT_TRUE(insideLimits(model, q));
    }
  }
}

// Targets moved where they may be out of reach: nothing near the answer, inside the limits, is better.
TEST(InverseKinematics, NoNeighbourIsBetter) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Model model = testing::randomTree(seed, 5, false);
    setLimits(model);
    IkScratch scratch(model);
    testing::Random random(seed);
    std::vector<FrameTarget> targets = reachable(model, {model.nframes - 1}, true, random.engine);
    targets[0].pose = SE3(Eigen::Matrix3d::Identity(), random.vec3(3)) * targets[0].pose;
    IkOptions options;
    options.restarts = 0;
    options.iterations = 1000;
    Eigen::VectorXd q = randomConfiguration(model, random.engine);
    const IkResult result = inverseKinematics(model, scratch, targets, options, q);
    ASSERT_NE(result.stop, IkStop::IterationsUsedUp);
    EXPECT_TRUE(insideLimits(model, q));
    const double cost = residual(model, targets, q).cost;
    for (int n = 0; n < 200; ++n) {
      Eigen::VectorXd beside = integrate(model, q, random.vec(model.nv, 1e-4));
      beside = beside.cwiseMax(model.lowerPositionLimit).cwiseMin(model.upperPositionLimit);
      // the slope that counts as none: 1e-8 |J| |e|, |J| at most about 10 sqrt(nv)
      EXPECT_GE(residual(model, targets, beside).cost, cost - 1e-4 * 1e-8 * 100 * (1 + cost)) << n;
    }
  }
}

// Three links have one freedom left: its family of solutions is the angle of the last link, the first two by
// closed formula.
TEST(InverseKinematics, RestTakesWhatFreedomIsLeft) {
  const std::vector<double> l = {0.5, 0.4, 0.3};
  const Model model = planarArm(l);
  IkScratch scratch(model);
  const FrameTarget target = point(model, 0.6, 0.3);
  for (const Eigen::Vector3d& weight : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 0, 0.3)}) {
    IkOptions options;
    options.rest = Eigen::Vector3d(-0.5, 1.2, 0.4);
    options.rest_weight = weight;
    const auto away = [&](const Eigen::Vector3d& q) { return weight.dot((q - options.rest).cwiseAbs2()); };
    Eigen::VectorXd q = Eigen::Vector3d(-0.3, 0.8, 1.0), free = q;
    const IkResult result = inverseKinematics(model, scratch, target, options, q);
    ASSERT_TRUE(result) << describe(model, result);
    EXPECT_LE(residual(model, {target}, q).position, options.position_tolerance * (1 + 1e-6));
    double best = INFINITY;
    for (int n = -3000; n < 3000; ++n) {
      const double phi = n * PI<double>() / 3000, x = 0.6 - l[2] * std::cos(phi),
                   y = 0.3 - l[2] * std::sin(phi);
      const Eigen::Vector2d two = twoLinks(l[0], l[1], x, y, 1);
      if (!two.allFinite()) continue;
      const double turn = phi - two.sum();
      best = std::min(best, away({two[0], two[1], std::remainder(turn, 2 * PI<double>())}));
    }
    // the grid's best is at most a step (1e-3) beside the minimum, where the cost is flat; the steps of the
    // search end at 1e-6
    EXPECT_NEAR(away(q), best, 2e-5);
    IkOptions without;
    ASSERT_TRUE(inverseKinematics(model, scratch, target, without, free));
    EXPECT_GT(away(free), 1.5 * away(q));
  }
}

TEST(InverseKinematics, SameSeedSameBytes) {
  Model model;
  buildModels::manipulator(model);
  IkScratch fresh(model), used(model);
  std::mt19937_64 engine(9);
  const std::vector<FrameTarget> targets = reachable(model, {model.frameId("arm_tool_link")}, true, engine);
  IkOptions options;
  int restarted = 0, differ = 0;
  for (unsigned n = 0; n < 10; ++n) {
    options.seed = n;
    const Eigen::VectorXd start = randomConfiguration(model, engine);
    Eigen::VectorXd a = start, b = start, c = start;
    const IkResult first = inverseKinematics(model, fresh, targets, options, a);
    (void)inverseKinematics(model, used, reachable(model, {5}, true, engine), options, c);
    const IkResult second = inverseKinematics(model, used, targets, options, b);
    EXPECT_EQ(a, b);
    EXPECT_EQ(first.iterations, second.iterations);
    options.seed = n + 1000;
    (void)inverseKinematics(model, used, targets, options, c = start);
    restarted += first.starts > 1;
    differ += a != c;
  }
  EXPECT_GT(restarted, 0);
  EXPECT_GT(differ, 0);  // another seed, another way
  EXPECT_LE(differ, restarted);
}

TEST(InverseKinematics, OddTargetsGiveNumbers) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Model model = testing::randomTree(seed, 6, seed % 2 == 0);
    IkScratch scratch(model);
    IkOptions options;
    options.restarts = 1;
    std::mt19937_64 engine(seed);
    const Eigen::VectorXd start = randomConfiguration(model, engine);
    Data data(model);
    forwardKinematics(model, data, start);
    const FrameIndex tip = model.nframes - 1;
    const SE3 here = data.oMf[tip];
    const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
    for (const SE3& pose : {here, SE3(here.rotation() * flip, here.translation()), SE3(flip, {1e9, 0, 0}),
                            SE3(flip, {-1e100, 1e100, 1e100}), SE3(flip, {1e-300, 0, 0})}) {
      for (const FrameIndex frame : {tip, 0}) {
        Eigen::VectorXd q = start;
        const IkResult result = inverseKinematics(model, scratch, {frame, pose, true}, options, q);
        EXPECT_TRUE(q.allFinite());
        EXPECT_TRUE(std::isfinite(result.position_error) && std::isfinite(result.rotation_error));
        if (frame == tip && pose.isApprox(here, 0)) {
          EXPECT_TRUE(result);
          EXPECT_EQ(result.iterations, 0);
        }
      }
    }
  }
}

std::string refusal(const Model& model, IkScratch& scratch, const std::vector<FrameTarget>& targets,
                    const IkOptions& options, Eigen::VectorXd q) {
  try {
    (void)inverseKinematics(model, scratch, targets, options, q);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "(accepted)";
}

TEST(InverseKinematics, MistakesAreNamed) {
  const Model model = planarArm({0.5, 0.4});
  IkScratch scratch(model);
  const Eigen::VectorXd q = Eigen::Vector2d(0, 0), three = Eigen::Vector3d(0, 0, 0);
  const FrameTarget good = point(model, 0.5, 0);
  const auto says = [&](const std::string& text, const std::vector<FrameTarget>& targets,
                        const std::function<void(IkOptions&)>& change, const Eigen::VectorXd& start) {
    IkOptions options;
    change(options);
    const std::string what = refusal(model, scratch, targets, options, start);
    EXPECT_NE(what.find("inverseKinematics: " + text), std::string::npos) << what;
  };
  const auto none = [](IkOptions&) {};
  says("q has 3 entries", {good}, none, three);
  says("no target", {}, none, q);
  says("2 targets, this IkScratch was made for 1", {good, good}, none, q);
  says("frame index 9 does not exist", {{9, SE3(), true}}, none, q);
  says("the target position of frame 'tip' is not finite", {point(model, NAN, 0)}, none, q);
  says("the target of frame 'tip' is not a rotation",
       {{good.frame, SE3(2 * Eigen::Matrix3d::Identity(), {0, 0, 0}), true}}, none, q);
  says(
      "position_tolerance is 0.000000, it must be positive", {good},
      [](IkOptions& o) { o.position_tolerance = 0; }, q);
  says("length is nan", {good}, [](IkOptions& o) { o.length = NAN; }, q);
  says("rest has 3 entries", {good}, [&](IkOptions& o) { o.rest = three; }, q);
  says(
      "rest_weight must be between 0 and 1", {good},
      [&](IkOptions& o) { o.rest_weight = Eigen::Vector2d(2, 0); }, q);
  says("iterations and restarts", {good}, [](IkOptions& o) { o.restarts = -1; }, q);
  Model other;
  buildModels::manipulator(other);
  IkScratch foreign(other);
  EXPECT_NE(refusal(model, foreign, {good}, IkOptions(), q).find("this Data was made for another model"),
            std::string::npos);
}

}  // namespace
}  // namespace rbd
