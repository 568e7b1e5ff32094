// Goals and holding: references are continuous in position and velocity whatever happens, and end where they should.
#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <cmath>

#include "lab/experiment/actions.h"
#include "procs/planner/planner.h"

namespace lab::planner {
namespace {

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}
Config moving() {
  Experiment e;
  e.simulator.duration = 100;
  e.planner.kind = "sinusoid";
  e.planner.amplitude.value = 0.3;
  return make_config(e, arm());
}

/// A robot that follows perfectly unless it is held; checks that no reference jumps.
struct Follower {
  explicit Follower(Config c) : config(std::move(c)), state(initial(config)) {
    robot.q = config.q0;
    robot.v = Eigen::VectorXd::Zero(6);
  }
  Reference next(bool held = false, std::vector<Action> actions = {}) {
    const Output out =
        step(config, state, {.step = ++now, .actions = actions, .state = &robot, .held = held});
    events.insert(events.end(), out.events.begin(), out.events.end());
    if (last.q.size() > 0)
      for (int i = 0; i < 6; ++i) {
        const double reach = (std::abs(out.reference.v[i]) + std::abs(last.v[i]) + 1e-3) * config.dt;
        EXPECT_LE(std::abs(out.reference.q[i] - (held || was_held ? robot.q[i] : last.q[i])), reach)
            << "step " << now << " joint " << i;
      }
    if (!held) robot.q = out.reference.q;
    was_held = held;
    last = out.reference;
    return last;
  }
  Config config;
  State state;
  RobotState robot;
  Reference last;
  int64_t now = 0;
  bool was_held = false;
  std::vector<Event> events;
};

TEST(PlannerLive, AGoalBeginsAtTheCurrentReferenceAndEndsAtRest) {
  Follower f(moving());
  for (int k = 0; k < 777; ++k) f.next();
  const Reference before = f.last;
  const std::vector<double> goal{0.2, 0.4, -0.3, 0.1, 0.5, -0.2};
  const Reference at = f.next(false, {{"goal", "", "", "", goal}});
  EXPECT_TRUE(f.events.empty());
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(at.v[i], before.v[i] + before.a[i] * f.config.dt, 1e-5);
    EXPECT_NEAR(at.a[i], before.a[i], 2e-2);
  }
  for (int k = 0; k < 20000; ++k) {
    f.next();
    for (int i = 0; i < 6; ++i) ASSERT_LE(std::abs(f.last.v[i]), f.config.v_max[i] * (1 + 1e-9));
  }
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(f.last.q[i], goal[i], 1e-9);
    EXPECT_EQ(f.last.v[i], 0);
  }
}

TEST(PlannerLive, ADurationIsKept) {
  Follower f(moving());
  f.next();
  const std::vector<double> goal{0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
  f.next(false, {{"goal", "", "duration", "2", goal}});
  for (int k = 0; k < 1990; ++k) f.next();
  EXPECT_GT(std::abs(f.last.q[0] - 0.1), 1e-9);
  for (int k = 0; k < 12; ++k) f.next();
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(f.last.q[i], 0.1, 1e-9);
}

// It is refused before it is accepted; of one that was accepted all the same, from another reference, the planner makes the best.
TEST(PlannerLive, AWayThatIsTooFastIsRefusedAndIfAcceptedTakesItsTime) {
  Follower f(moving());
  for (int k = 0; k < 10; ++k) f.next();
  const Action goal{"goal", "", "duration", "0.001", {0.2, 0.4, -0.3, 0.1, 0.5, -0.2}};
  EXPECT_NE(goal_fault(f.config, goal, f.last), "");
  f.next(false, {goal});
  EXPECT_TRUE(f.events.empty());
  for (int k = 0; k < 5000; ++k) {
    f.next();
    for (int i = 0; i < 6; ++i) ASSERT_LE(std::abs(f.last.v[i]), f.config.v_max[i] * (1 + 1e-9));
  }
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(f.last.q[i], goal.values[static_cast<size_t>(i)], 1e-9);
}

TEST(PlannerLive, HeldItStaysWithTheRobotAndThenGoesOnWithoutAJump) {
  Follower f(moving());
  for (int k = 0; k < 500; ++k) f.next();
  f.robot.q += Eigen::VectorXd::Constant(6, 0.05);  // stopped somewhere else
  for (int k = 0; k < 300; ++k) {
    const Reference r = f.next(true);
    EXPECT_EQ(r.q, f.robot.q);
    for (int i = 0; i < 6; ++i) EXPECT_EQ(r.v[i], 0);
  }
  const Reference r = f.next();
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(r.v[i], 0, 1e-9);
  for (int k = 0; k < 5000; ++k) f.next();
  EXPECT_GT(std::abs(f.last.v[0]) + std::abs(f.last.a[0]), 1e-3) << "it swings again";
}

// However long the robot is held, the motion goes on from where it was.
TEST(PlannerLive, TheMotionIsPausedWhileTheRobotIsHeld) {
  Follower f(moving());
  for (int k = 0; k < 500; ++k) f.next();
  for (int k = 0; k < 7000; ++k) f.next(true);
  for (int k = 0; k < 3000; ++k) f.next();
  ASSERT_LT(f.state.ramp, 2.9) << "the ramp, in which half of its time is lost, is over";
  Reference wanted = f.last;
  f.config.motion->at(3.499 - f.state.ramp / 2, wanted);  // 0.5 s before, 2.999 s since
  EXPECT_LT((f.last.q - wanted.q).norm(), 1e-9);
  f.config.motion->at(10.499 - f.state.ramp / 2, wanted);
  EXPECT_GT((f.last.q - wanted.q).norm(), 0.1) << "without a pause";
}

// Also where the motion itself is at rest: the way back from where the robot was stopped takes its time.
TEST(PlannerLive, HeldElsewhereItComesBackToARestWithoutAJump) {
  Experiment e;
  e.planner.kind = "hold";
  Follower f(make_config(e, arm()));
  for (int k = 0; k < 10; ++k) f.next();
  f.robot.q += Eigen::VectorXd::Constant(6, 0.05);
  f.next(true);
  for (int k = 0; k < 3000; ++k) f.next();
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(f.last.q[i], f.config.q0[i], 1e-12);
}

// A goal in a given time whose peak, 15/8 of the mean speed, is just the limit: 0.5 rad in 0.9375 s at 1 rad/s.
TEST(PlannerLive, AGoalAtTheSpeedLimitIsTaken) {
  rbd::Model model = arm();
  model.upperVelocityLimit[0] = 1;
  model.lowerVelocityLimit[0] = -1;
  const Config config = make_config(Experiment(), model);
  for (const auto& [duration, taken] : {std::pair("0.9375", true), {"0.937", false}}) {
    State state = initial(config);
    std::vector<double> goal(config.q0.begin(), config.q0.end());
    goal[0] += 0.5;
    const Reference at_rest = step(config, state, {.step = 0}).reference;
    EXPECT_EQ(goal_fault(config, {"goal", "", "duration", duration, goal}, at_rest).empty(), taken)
        << duration;
  }
}

// The shortest time is that of a start at rest, 15/8 s for 1 rad at 1 rad/s: moving the other way, the arm needs more of it.
TEST(PlannerLive, AGoalWithoutATimeTakesAsLongAsItMust) {
  rbd::Model model = arm();
  model.upperVelocityLimit[0] = 1;
  model.lowerVelocityLimit[0] = -1;
  Experiment e;
  e.simulator.duration = 100;
  e.planner.kind = "sinusoid";
  e.planner.amplitude.value = JointValues::Named{{"joint1_base_yaw", -0.3}};
  e.planner.speed = 1;
  const Config config = make_config(e, model);
  for (const auto& [key, duration] : {std::pair("", ""), {"duration", "1.875"}}) {
    State state = initial(config);
    const Reference moving = step(config, state, {.step = 0}).reference;
    EXPECT_EQ(goal_fault(config, {"goal", "", key, duration, {1, 0, 0, 0, 0, 0}}, moving).empty(),
              *key == '\0');
  }
}

// v is the derivative of q and a that of v through ramp and offset: central differences, error O(dt^2); where the ramp
// begins and ends the jerk jumps by up to 30 rad/s^3, which a central difference of v sees as 30 dt / 4.
TEST(PlannerLive, VelocityAndAccelerationAreTheDerivatives) {
  Follower f(moving());
  for (int k = 0; k < 100; ++k) f.next();
  f.robot.q += Eigen::VectorXd::Constant(6, 0.02);
  for (int k = 0; k < 50; ++k) f.next(true);
  Reference r[3];
  r[0] = f.next();
  r[1] = f.next();
  const double dt = f.config.dt;
  for (int k = 0; k < 2000; ++k) {
    r[2] = f.next();
    for (int i = 0; i < 6; ++i) {
      ASSERT_NEAR(r[1].v[i], (r[2].q[i] - r[0].q[i]) / (2 * dt), 2e-5) << k;
      ASSERT_NEAR(r[1].a[i], (r[2].v[i] - r[0].v[i]) / (2 * dt), 8e-3) << k;
    }
    r[0] = r[1];
    r[1] = r[2];
  }
}

TEST(PlannerLive, AStopByAPersonHoldsInLockstepToo) {
  Follower f(moving());
  for (int k = 0; k < 200; ++k) f.next();
  f.was_held = true;
  const Reference stopped = f.next(false, {{"estop", "", "", "", {}}});
  for (int i = 0; i < 6; ++i) EXPECT_EQ(stopped.v[i], 0);
  f.was_held = true;
  const Reference again = f.next(false, {{"rearm", "", "", "", {}}});
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(again.q[i], stopped.q[i], 1e-9);
}

TEST(PlannerLive, WhoJoinsARunUnderWayStartsFromTheRobot) {
  Follower f(moving());
  f.now = 12345;
  f.robot.q = Eigen::VectorXd::Constant(6, 0.1);
  EXPECT_EQ(f.next().q, f.robot.q);
  for (int k = 0; k < 5000; ++k) f.next();
  EXPECT_LT(f.last.q.norm(), 10);
}

// From 0 with speed v back to 0 at rest, a quintic of T seconds goes v T (x - 6 x^3 + 8 x^4 - 3 x^5): at x = 1/3, where its
// slope (1 - x)^2 (1 - 3 x) (1 + 5 x) is 0, it is 16/81 v T away.
TEST(PlannerLive, AWayThatLeavesOneLimitIsRefused) {
  for (const double side : {-1.0, 1.0}) {
    rbd::Model model = arm();
    (side < 0 ? model.lowerPositionLimit : model.upperPositionLimit)[0] = side * 0.35;
    Experiment e;
    e.simulator.duration = 100;
    e.planner.kind = "sinusoid";
    e.planner.amplitude.value = JointValues::Named{{"joint1_base_yaw", side * 0.3}};
    const Config config = make_config(e, model);  // 0.3 rad/s at the start
    const double longest = 0.35 / (16. / 81 * 0.3);
    for (const double share : {0.98, 1.02}) {
      State state = initial(config);
      const std::string duration = std::to_string(share * longest);
      const std::vector<Action> actions{{"goal", "", "duration", duration, std::vector<double>(6)}};
      const Reference start = step(config, state, {.step = 0}).reference;
      EXPECT_EQ(goal_fault(config, actions[0], start).empty(), share < 1) << side << " " << share;
      // the planner takes what was accepted, where it must in the shortest time: 0.5 s
      EXPECT_TRUE(step(config, state, {.step = 0, .actions = actions}).events.empty());
      double farthest = 0;
      for (int64_t k = 1; k < 8000; ++k)
        farthest = std::max(farthest, side * step(config, state, {.step = k}).reference.q[0]);
      EXPECT_NEAR(farthest, share < 1 ? share * 0.35 : 16. / 81 * 0.3 * 0.5, 1e-6);
    }
  }
}

TEST(PlannerLive, AGoalThatIsTooFastIsRefusedWithATimeThatWouldDo) {
  const Config config = make_config({}, arm());
  State state = initial(config);
  const Reference start = step(config, state, {.step = 0}).reference;
  const auto said = [&](const std::string& duration) {
    return goal_fault(config, {"goal", "", "duration", duration, {0, 1, 0, 0, 0, 0}}, start);
  };
  const double shortest = 1.875 / config.v_max[1];  // s: of a quintic over 1 rad, at the speed limit
  EXPECT_EQ(said(std::to_string(1.01 * shortest)), "");
  const std::string fault = said(std::to_string(0.99 * shortest));
  EXPECT_NE(fault.find("joint 'joint2_shoulder': speed "), std::string::npos) << fault;
  const double would_do = std::stod(fault.substr(fault.rfind("; ") + 2));
  EXPECT_EQ(said(std::to_string(would_do)), "") << fault;
}

TEST(PlannerLive, AGoalBeyondOneLimitIsRefusedByTheDoorAndByThePlanner) {
  rbd::Model model = arm();
  model.lowerPositionLimit[1] = -0.75;
  model.upperPositionLimit[1] = 0.5;
  const Experiment e;
  const Config config = make_config(e, model);
  const auto door = [&](double q) { return why_not(e, model, {"goal", "", "", "", {0, q, 0, 0, 0, 0}}); };
  const auto planner = [&](double q) {
    State state = initial(config);
    const std::vector<Action> actions{{"goal", "", "", "", {0, q, 0, 0, 0, 0}}};
    const Output out = step(config, state, {.step = 1, .actions = actions});
    return out.events.empty() ? "" : out.events[0].why;
  };
  for (const auto& [q, text] : {std::pair(-0.875, "-0.875"), {0.625, "0.625"}}) {
    EXPECT_EQ(door(q),
              std::string("goal of joint 'joint2_shoulder' is ") + text + ", its limits are -0.75 .. 0.5");
    EXPECT_NE(planner(q).find("would leave the limits of joint 'joint2_shoulder': position"),
              std::string::npos)
        << planner(q);
  }
  for (const double q : {-0.75, 0.5}) {
    EXPECT_EQ(door(q), "");
    EXPECT_EQ(planner(q), "");
  }
}

}  // namespace
}  // namespace lab::planner
