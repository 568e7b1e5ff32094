// Point-to-point cycles: the targets are met on time, within the speed, and nothing jumps at any switch: start, arrival,
// departure, a new round, a goal that comes between, the way back, a hold.
#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <cmath>

#include "procs/planner/planner.h"
#include "tests/support/refusal.h"

namespace lab::planner {
namespace {

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

const std::vector<double> kStart{0.1, -0.2, 0.3, 0, 0.4, -0.1}, kA{0.5, 0.3, -0.4, 0.2, 0.5, -0.3},
    kB{-0.5, 0.1, 0.8, 0.2, -0.5, 0.3}, kC{0, 0, 0, 0, 0, 1.2}, kAside{0.3, -0.6, 0.2, 0.7, 0, -0.4};

Experiment cycle(double dt = 1e-3) {
  Experiment e;
  e.simulator.dt = dt;
  e.simulator.duration = 1000;
  e.simulator.q0.value = kStart;
  e.planner.kind = "point_to_point";
  e.planner.dwell = 0.25;
  e.planner.targets.resize(3);
  e.planner.targets[0].value = kA;
  e.planner.targets[1].value = kB;
  e.planner.targets[2].value = kC;
  return e;
}

/// A robot that follows perfectly. Every reference is held against the one before by finite differences, without any
/// knowledge of where the switches are. The jerk of a quintic from rest to rest is at most 60 d / T^3, here with d <= 1.5
/// and T >= 0.5: a step of q, v or a beyond what kJerk allows is a jump.
struct Follower {
  explicit Follower(const Experiment& e) : config(make_config(e, arm())), state(initial(config)) {
    robot.q = config.q0;
    robot.v = Eigen::VectorXd::Zero(6);
  }
  Reference next(std::vector<Action> actions = {}, bool held = false) {
    const Output out =
        step(config, state, {.step = ++now, .actions = actions, .state = &robot, .held = held});
    events.insert(events.end(), out.events.begin(), out.events.end());
    const double h = config.dt;
    const Reference& r = out.reference;
    if (last.q.size() > 0)
      for (int i = 0; i < 6; ++i) {
        worst_q =
            std::max(worst_q, std::abs(r.q[i] - last.q[i] - h * (r.v[i] + last.v[i]) / 2) / (h * h * h));
        worst_v = std::max(worst_v, std::abs(r.v[i] - last.v[i] - h * (r.a[i] + last.a[i]) / 2) / (h * h));
        worst_a = std::max(worst_a, std::abs(r.a[i] - last.a[i]) / h);
        fastest = std::max(fastest, std::abs(r.v[i]) / config.v_max[i]);
      }
    last = r;
    robot.q = r.q;
    robot.v = r.v;
    return r;
  }
  void run(double seconds) {
    for (double t = 0; t < seconds; t += config.dt) next();
  }
  /// The trapezoidal rule is off by h^3 q''' / 12 and h^2 (change of a over a kink of the jerk) / 4; a itself moves by
  /// h q'''. A jump of size s would show as s / h^3, s / h^2 and s / h: thousands of times more at h = 1e-3.
  void expect_no_jump() const {
    EXPECT_LT(worst_q, kJerk / 2);
    EXPECT_LT(worst_v, kJerk / 2);
    EXPECT_LT(worst_a, kJerk);
  }
  static constexpr double kJerk = 60 * 1.5 / (0.5 * 0.5 * 0.5);
  Config config;
  State state;
  RobotState robot;
  Reference last;
  int64_t now = -1;
  double worst_q = 0, worst_v = 0, worst_a = 0, fastest = 0;
  std::vector<Event> events;
};

Reference at(const Config& config, double t) {
  State state = initial(config);
  return step(config, state, {.step = std::llround(t / config.dt)}).reference;
}

void expect_rest(const Reference& r, const std::vector<double>& q) {
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(r.q[i], q[i], 1e-12) << i;
    EXPECT_NEAR(r.v[i], 0, 1e-12) << i;
    EXPECT_NEAR(r.a[i], 0, 1e-9) << i;
  }
}

/// The time that a quintic from rest to rest needs when its peak speed, 15/8 of the mean, is half of the limit.
double way_time(const Config& c, const std::vector<double>& from, const std::vector<double>& to) {
  double T = 0.5;
  for (int i = 0; i < 6; ++i) T = std::max(T, 15.0 / 8 * std::abs(to[i] - from[i]) / (0.5 * c.v_max[i]));
  return T;
}

TEST(PointToPoint, VisitsTheTargetsInTurnRoundAndRound) {
  const Config c = make_config(cycle(), arm());
  double t = 0;
  std::vector<double> from = kStart;
  for (int round = 0; round < 5; ++round)
    for (const auto& target : {kA, kB, kC}) {
      t += way_time(c, from, target);
      expect_rest(at(c, t + 0.01), target);  // arrived ..
      expect_rest(at(c, t + 0.24), target);  // .. and still there
      EXPECT_GT((at(c, t + 0.35).q - at(c, t).q).norm(), 1e-3) << "gone on";
      t += 0.25;
      from = target;
    }
}

TEST(PointToPoint, OnceItStaysAtTheLast) {
  Experiment e = cycle();
  e.planner.cycle = false;
  const Config c = make_config(e, arm());
  expect_rest(at(c, 100), kC);
  expect_rest(at(c, 900), kC);
}

TEST(PointToPoint, NothingJumpsAndNothingIsTooFast) {
  for (double speed : {0.2, 0.5, 1.0}) {
    Experiment e = cycle();
    e.planner.speed = speed;
    Follower f(e);
    f.run(20);
    f.expect_no_jump();
    EXPECT_LE(f.fastest, speed * (1 + 1e-9));
    if (speed == 0.2) {
      EXPECT_NEAR(f.fastest, 0.2, 1e-5) << "no slower than it must be";
    }
  }
}

TEST(PointToPoint, AGoalComesBetweenAnywhereAndTheCycleGoesOnFromThere) {
  for (double when : {0.2, 0.4, 0.63, 0.9, 1.7, 2.9, 4.44}) {  // on ways and at rests
    Follower f(cycle());
    f.run(when);
    f.next({{"goal", "", "", "", kAside}});
    f.run(when < 1 ? 5.0 : 0.3);  // there already, or still under way
    f.next({{"set", "planner", "motion", "on", {}}});
    f.run(12);
    EXPECT_TRUE(f.events.empty()) << f.events[0].why;
    f.expect_no_jump();
    EXPECT_LE(f.fastest, 1);
    EXPECT_FALSE(f.state.detour && !f.state.detour->resume_time) << "the cycle is on again";
  }
}

TEST(PointToPoint, TheWayBackLeadsToTheTargetThatWasNext) {
  Follower f(cycle());
  const double arrives_a = way_time(f.config, kStart, kA);
  f.run(arrives_a / 2);  // on the way to the first target
  f.next({{"goal", "", "duration", "1", kAside}});
  f.run(1.2);
  expect_rest(f.last, kAside);
  f.next({{"set", "planner", "motion", "on", {}}});
  f.run(way_time(f.config, kAside, kA) + 0.01);
  expect_rest(f.last, kA);
  f.run(0.25 + way_time(f.config, kA, kB));
  expect_rest(f.last, kB);
  f.next({{"goal", "", "duration", "1", kAside}});  // resting at the second: it has been visited
  f.run(1.2);
  f.next({{"set", "planner", "motion", "on", {}}});
  f.run(way_time(f.config, kAside, kC) + 0.01);
  expect_rest(f.last, kC);
  f.run(0.25 + way_time(f.config, kC, kA));
  expect_rest(f.last, kA);
}

TEST(PointToPoint, AnyMotionCanBeComeBackTo) {
  Experiment e = cycle();
  e.planner.kind = "sinusoid";
  e.planner.amplitude.value = 0.3;
  Follower f(e);
  f.run(3);
  f.next({{"goal", "", "", "", kAside}});
  f.run(4);
  f.next({{"set", "planner", "motion", "on", {}}});
  f.run(4);
  EXPECT_TRUE(f.events.empty());
  f.expect_no_jump();
  EXPECT_GT(f.last.v.norm(), 1e-2) << "it swings again";
}

TEST(PointToPoint, HeldOnTheWayItGoesOnFromWhereTheRobotIs) {
  Follower f(cycle());
  f.run(0.7);
  for (int k = 0; k < 300; ++k)
    f.next({}, true);  // brought to rest at once: a jump of v that is the robot's, not ours
  f.worst_q = f.worst_v = f.worst_a = 0;
  f.run(15);
  f.expect_no_jump();
}

TEST(PointToPoint, WhatMakesNoSenseIsRefused) {
  const auto refusal = [](const Experiment& e) { return test::refusal_of([&] { make_config(e, arm()); }); };
  Experiment e = cycle();
  e.file = "x.yaml";
  e.planner.targets.clear();
  EXPECT_EQ(refusal(e), "x.yaml: planner.targets: is missing; point_to_point needs at least one");
  e = cycle();
  e.where = {{"planner.targets", "x.yaml:3"}, {"planner.targets[1]", "x.yaml:5"}};
  e.planner.targets[1].value = std::vector<double>{1, 2};
  EXPECT_TRUE(refusal(e).starts_with("x.yaml:5: planner.targets[1]: has 2 numbers")) << refusal(e);
  e.planner.targets[1] = {};
  e.planner.targets[2].value = 50.0;
  EXPECT_TRUE(refusal(e).starts_with("x.yaml:3: planner.targets[2]: joint ")) << refusal(e);
  Follower f(cycle());
  f.next({{"set", "planner", "motion", "off", {}}});
  ASSERT_EQ(f.events.size(), 1u);
  EXPECT_EQ(f.events[0].why, "'set motion': the planner knows only motion=on");
}

TEST(PointToPoint, TargetsThatAreOneAndTheSameAreARest) {
  for (double dwell : {0.0, 0.5}) {
    Experiment e = cycle();
    e.planner.dwell = dwell;
    for (JointValues& target : e.planner.targets) target.value = kStart;
    const Config c = make_config(e, arm());
    for (double t : {0.0, 0.3, 1.0, 50.0}) expect_rest(at(c, t), kStart);
  }
}

}  // namespace
}  // namespace lab::planner
