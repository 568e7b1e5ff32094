// Times that the planner chooses: waypoints and `duration: 0`. Seen from outside only, by sampling the reference.
#include <gtest/gtest.h>
#include <rbd/model/sample_models.h>

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
    kB{-0.5, 0.1, 0.8, 0.2, -0.5, 0.3}, kC{0, 0, 0, 0, 0, 1.2};

Experiment through(std::vector<std::vector<double>> targets, double dt = 1e-3) {
  Experiment e;
  e.file = "x.yaml";
  e.simulator.dt = dt;
  e.simulator.duration = 100;
  e.simulator.q0.value = kStart;
  e.planner.kind = "waypoints";
  for (auto& target : targets) e.planner.targets.emplace_back().value = target;
  return e;
}

Reference at(const Config& config, int64_t k) {
  State state = initial(config);
  return step(config, state, {.step = k}).reference;
}

std::string refusal(const Experiment& e) {
  return test::refusal_of([&] { make_config(e, arm()); });
}

/// Along the whole motion and the rest after it: largest shares of the limits, and of what finite differences allow.
struct Seen {
  double speed = 0, acceleration = 0;  // largest of any joint; speed as a share of its limit
  double off_v = 0, off_a = 0;  // central differences against v and a, as a share of what the jerk explains
};
Seen watch(const Config& c) {
  Seen out;
  const double h = c.dt;
  const auto steps = static_cast<int64_t>(c.motion->duration / h) + 100;
  std::vector<Reference> r;
  double jerk = 0;
  for (int64_t k = 0; k <= steps; ++k) {
    r.push_back(at(c, k));
    for (int i = 0; i < 6; ++i) {
      out.speed = std::max(out.speed, std::abs(r.back().v[i]) / c.v_max[i]);
      out.acceleration = std::max(out.acceleration, std::abs(r.back().a[i]));
      if (k > 0) jerk = std::max(jerk, std::abs(r[k].a[i] - r[k - 1].a[i]) / h);
    }
  }
  // central differences are off by h^2 / 6 of the jerk; of v, where the jerk jumps (by twice the largest at most), by half
  // of h times it
  for (int64_t k = 1; k < steps; ++k)
    for (int i = 0; i < 6; ++i) {
      out.off_v = std::max(
          out.off_v, std::abs((r[k + 1].q[i] - r[k - 1].q[i]) / (2 * h) - r[k].v[i]) / (h * h / 6 * jerk));
      out.off_a = std::max(out.off_a,
                           std::abs((r[k + 1].v[i] - r[k - 1].v[i]) / (2 * h) - r[k].a[i]) / (h / 2 * jerk));
    }
  return out;
}

TEST(Waypoints, PassesThroughTheTargetsAtTheirTimes) {
  Experiment e = through({kA, kB, kC});
  e.planner.times = {1.5, 2, 4};
  const Config c = make_config(e, arm());
  const struct {
    int64_t step;
    const std::vector<double>& q;
  } rows[] = {{0, kStart}, {1500, kA}, {2000, kB}, {4000, kC}, {9000, kC}};
  for (const auto& row : rows)
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(at(c, row.step).q[i], row.q[i], 1e-14) << row.step;
  EXPECT_GT(at(c, 1500).v.norm(), 0.1) << "no rest between";
  for (int64_t k : {0, 4000, 9000}) {
    EXPECT_LE(at(c, k).v.norm(), 1e-13);
    EXPECT_LE(at(c, k).a.norm(), 1e-12);
  }
}

TEST(Waypoints, VelocityAndAccelerationAreDerivativesEverywhere) {
  for (const auto& targets :
       std::vector<std::vector<std::vector<double>>>{{kA}, {kA, kB}, {kA, kB, kC, kA, kStart}}) {
    const Seen seen = watch(make_config(through(targets, 1e-4), arm()));
    EXPECT_LE(seen.off_v, 1.05) << targets.size();
    EXPECT_LE(seen.off_a, 1.05) << targets.size();
  }
}

TEST(Waypoints, TheFastestJointMovesAtTheShareOfItsLimit) {
  for (double speed : {0.2, 0.5, 1.0})
    for (const auto& targets :
         std::vector<std::vector<std::vector<double>>>{{kC}, {kA, kB}, {kA, kB, kC, kA, kStart}}) {
      Experiment e = through(targets);
      e.planner.speed = speed;
      const Config c = make_config(e, arm());
      if (c.motion->duration == kMinTime) continue;
      const Seen seen = watch(c);
      EXPECT_LE(seen.speed, speed * (1 + 1e-12));
      // the samples miss the peak by h / 2 at most: a jerk of 1000 / s3 takes 1000 (h / 2)^2 / 2 / 6 of the limit there
      EXPECT_GE(seen.speed, speed - 2.1e-5);
      double stated = 0;
      for (int i = 0; i < 6; ++i) stated = std::max(stated, c.motion->peak_speed[i] / c.v_max[i]);
      EXPECT_NEAR(stated, speed, 1e-12);
    }
}

TEST(Waypoints, ABoundOnTheAccelerationIsKeptAndUsed) {
  Experiment e = through({kA, kB, kC, kA});
  e.planner.speed = 1;
  e.planner.acceleration.value = 7.0;
  const Seen seen = watch(make_config(e, arm()));
  EXPECT_LE(seen.acceleration, 7 * (1 + 1e-12));
  EXPECT_GE(seen.acceleration, 6.9);
  EXPECT_LT(seen.speed, 1);
}

TEST(Waypoints, MoreTimeForALongerPiece) {
  // one joint, three equal ways and then one of twice the length: 2 : 1 : 1 : 2 x 2
  const auto place = [](double x) { return std::vector<double>{x, -0.2, 0.3, 0, 0.4, -0.1}; };
  const Config c = make_config(through({place(0.4), place(0.7), place(1.0), place(1.6)}), arm());
  double arrivals[5] = {};  // at the targets
  for (int k = 1; k < 5; ++k) arrivals[k] = c.motion->rejoin_time(arrivals[k - 1] + 1e-9).value();
  EXPECT_EQ(arrivals[4], c.motion->duration);
  const double unit = arrivals[2] - arrivals[1];
  EXPECT_NEAR(arrivals[1], 2 * unit, 1e-12);
  EXPECT_NEAR(arrivals[3] - arrivals[2], unit, 1e-12);
  EXPECT_NEAR(arrivals[4] - arrivals[3], 4 * unit, 1e-12);
}

TEST(Waypoints, LedAwayItComesBackToTheNextTargetWithoutAJump) {
  Experiment e = through({kA, kB, kC});
  e.planner.times = {1.5, 2, 4};
  const Config c = make_config(e, arm());
  State state = initial(c);
  Reference last = step(c, state, {.step = 0}).reference;
  double jump = 0, missed = 1;
  for (int64_t k = 1; k < 12000; ++k) {
    std::vector<Action> actions;
    if (k == 1600) actions = {{"goal", "", "", "", kStart}};  // after the first target, before the second
    if (k == 5000) actions = {{"set", "planner", "motion", "on", {}}};
    const Output out = step(c, state, {.step = k, .actions = actions});
    ASSERT_TRUE(out.events.empty()) << out.events[0].why;
    const Reference& r = out.reference;
    double away = 0;
    for (int i = 0; i < 6; ++i) {
      jump = std::max(jump, std::abs(r.v[i] - last.v[i] - (r.a[i] + last.a[i]) / 2 * c.dt));
      away = std::max(away, std::abs(r.q[i] - kB[i]));
    }
    if (k > 5000) missed = std::min(missed, away);
    last = r;
  }
  EXPECT_LE(missed, 4 * c.dt / 2) << "passes the second target, at 4 rad/s at most, between two samples";
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(last.q[i], kC[i], 1e-12);
  EXPECT_LE(jump, 1e-3) << "a jump of the velocity, or of the acceleration by 2 rad/s2";
}

TEST(Waypoints, WhatCannotBeIsRefusedWhereItStands) {
  Experiment e = through({});
  EXPECT_EQ(refusal(e), "x.yaml: planner.targets: is missing; waypoints needs at least one");
  e = through({kA, kA});
  e.where = {{"planner.targets", "x.yaml:3"}, {"planner.targets[1]", "x.yaml:5"}};
  EXPECT_EQ(refusal(e),
            "x.yaml:5: planner.targets[1]: is where the robot is already, and waypoints do not rest; leave "
            "it out, give planner.times, "
            "or use point_to_point");
  e.planner.times = {1};
  EXPECT_EQ(refusal(e), "x.yaml: planner.times: has 1 numbers, but there are 2 targets; give one per target");
  e.planner.times = {1, 1};
  e.where["planner.times[1]"] = "x.yaml:8";
  EXPECT_EQ(refusal(e),
            "x.yaml:8: planner.times[1]: 1 s is not after 1 s; times count from the start and must rise");
  e.planner.times = {1, 2};
  EXPECT_EQ(refusal(e), "accepted");
  e = through({kA, std::vector<double>(6, 4.0)});
  EXPECT_EQ(refusal(e).rfind(
                "x.yaml: planner.targets[1]: joint 'joint1_base_yaw' cannot be at 4; its limits are", 0),
            0u)
      << refusal(e);
  // targets inside, the curve between them not
  const auto yaw = [](double x) { return std::vector<double>{x, 0, 0, 0, 0, 0}; };
  e = through({yaw(0), yaw(3.1), yaw(3.12), yaw(0)});
  e.where = {{"planner.targets[3]", "x.yaml:6"}};
  EXPECT_EQ(
      refusal(e).rfind("x.yaml:6: planner.targets[3]: joint 'joint1_base_yaw' would swing out to 3.", 0), 0u)
      << refusal(e);
  EXPECT_NE(refusal(e).find("its limit is 3.14159"), std::string::npos) << refusal(e);
}

TEST(ShortestDuration, TakesTheSpeedOrTheAccelerationThatIsAllowed) {
  for (const char* kind : {"cubic", "quintic"}) {
    Experiment e = through({});
    e.planner.kind = kind;
    e.planner.goal.value = kB;
    e.planner.speed = 0.2;
    Config c = make_config(e, arm());
    EXPECT_GT(c.motion->duration, kMinTime);
    EXPECT_TRUE(c.motion->chosen_time);
    Seen seen = watch(c);
    EXPECT_LE(seen.speed, 0.2 * (1 + 1e-12)) << kind;
    EXPECT_GE(seen.speed, 0.2 * (1 - 1e-5)) << kind;
    e.planner.acceleration.value = 2.0;
    c = make_config(e, arm());
    seen = watch(c);
    EXPECT_LE(seen.acceleration, 2 * (1 + 1e-12)) << kind;
    EXPECT_GE(seen.acceleration, 2 * (1 - 1e-5)) << kind;
    e.planner.duration = 7;
    EXPECT_EQ(make_config(e, arm()).motion->duration, 7) << "what is given is kept";
  }
}

}  // namespace
}  // namespace lab::planner
