// The planner's motions: boundary conditions, derivatives by finite differences, refusals.
#include "procs/planner/planner.h"

#include <gtest/gtest.h>
#include <rbd/model/sample_models.h>

#include <cmath>

#include "tests/support/refusal.h"

namespace lab::planner {
namespace {

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

Experiment reach(const std::string& kind) {
  Experiment e;
  e.simulator.dt = 1e-5;
  e.simulator.duration = e.planner.duration = 0.5;
  e.planner.kind = kind;
  e.simulator.q0.value = std::vector<double>{0.1, -0.2, 0.3, 0, 0.4, -0.1};
  e.planner.goal.value = std::vector<double>{0.5, 0.3, -0.4, 0.2, 0.5, -0.3};
  e.planner.amplitude.value = 0.4;
  e.planner.phase.value = std::vector<double>{0, 0.5, 1, -1, 2, 3};
  return e;
}

Eigen::VectorXd given(const JointValues& values) {
  const auto& list = std::get<std::vector<double>>(values.value);
  return Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
}

Reference at(const Config& config, int64_t k) {
  State state = initial(config);
  return step(config, state, {.step = k}).reference;
}

std::string refusal(const Experiment& e, const rbd::Model& model) {
  return test::refusal_of([&] { make_config(e, model); });
}

TEST(Planner, PolynomialsStartAndEndAtRest) {
  for (const char* kind : {"cubic", "quintic"}) {
    const Config config = make_config(reach(kind), arm());
    const Eigen::VectorXd goal = given(reach(kind).planner.goal);
    const Reference first = at(config, 0), last = at(config, 50000), later = at(config, 60000);
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(first.q[i], config.q0[i]);
      EXPECT_EQ(first.v[i], 0);
      EXPECT_NEAR(last.q[i], goal[i], 1e-15);
      EXPECT_NEAR(last.v[i], 0, 1e-14);
      EXPECT_EQ(later.q[i], goal[i]);
      EXPECT_EQ(later.v[i], 0);
      EXPECT_EQ(later.a[i], 0);
      // a cubic's acceleration jumps by 6 / T^2 of the way, a quintic's does not
      const double jump = kind == std::string("cubic") ? 6 / 0.25 * (goal[i] - config.q0[i]) : 0;
      EXPECT_NEAR(first.a[i], jump, 1e-12);
      EXPECT_NEAR(last.a[i], -jump, 1e-12);
    }
  }
}

TEST(Planner, HalfWayIsHalfTheWay) {
  for (const char* kind : {"cubic", "quintic"}) {
    const Config config = make_config(reach(kind), arm());
    const Eigen::VectorXd goal = given(reach(kind).planner.goal);
    const Reference middle = at(config, 25000);
    for (int i = 0; i < 6; ++i) {
      const double way = goal[i] - config.q0[i];
      EXPECT_NEAR(middle.q[i], config.q0[i] + way / 2, 1e-15);
      EXPECT_NEAR(middle.v[i], (kind == std::string("cubic") ? 1.5 : 1.875) * way / 0.5, 1e-13);
      EXPECT_NEAR(middle.a[i], 0, 1e-12);
    }
  }
}

TEST(Planner, VelocityAndAccelerationAreDerivatives) {
  for (const char* kind : {"hold", "cubic", "quintic", "sinusoid"}) {
    const Config config = make_config(reach(kind), arm());
    for (int64_t k = 100; k < 49900; k += 777) {
      const Reference before = at(config, k - 1), now = at(config, k), after = at(config, k + 1);
      for (int i = 0; i < 6; ++i) {
        // central differences at h = 1e-5 are off by h^2 / 6 of the third derivative (quintic: 60 / T^3 of
        // the way, 336 here) and, for a, of the fourth of q (360 / T^4 of the way, 4032 here), plus rounding
        EXPECT_NEAR((after.q[i] - before.q[i]) / 2e-5, now.v[i], 1e-8) << kind << k;
        EXPECT_NEAR((after.v[i] - before.v[i]) / 2e-5, now.a[i], 8e-8) << kind << k;
      }
    }
  }
}

TEST(Planner, SinusoidsHaveOneAndMoreRadiansPerSecond) {
  Experiment e = reach("sinusoid");
  e.simulator.dt = 0.01;
  const Config config = make_config(e, arm());
  const Eigen::VectorXd phase = given(e.planner.phase);
  const Reference r = at(config, 123);
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(r.q[i], config.q0[i] + 0.4 * std::sin((1 + 0.3 * i) * 1.23 + phase[i]), 1e-15);
  EXPECT_EQ(r.step, 123);
}

TEST(Planner, RefusesWhatCannotBe) {
  const rbd::Model model = arm();
  Experiment e = reach("cubic");
  e.file = "x.yaml";
  e.planner.goal = {};
  EXPECT_EQ(refusal(e, model), "x.yaml: planner.goal: is missing; a cubic needs one");
  e.where["planner.kind"] = "x.yaml:5";  // who needs it
  EXPECT_EQ(refusal(e, model), "x.yaml:5: planner.goal: is missing; a cubic needs one");
  e.planner.goal.value = JointValues::Named{{"joint2_sholder", 1}};
  e.where["planner.goal"] = "x.yaml:7";
  EXPECT_EQ(refusal(e, model),
            "x.yaml:7: planner.goal.joint2_sholder: 'manipulator' has no such joint; did you mean "
            "'joint2_shoulder'?");
  e.planner.goal.value = std::vector<double>{1, 2};
  EXPECT_NE(refusal(e, model).find("has 2 numbers, but 'manipulator' has 6 joints"), std::string::npos);
  e.planner.goal.value = 100.0;
  EXPECT_NE(refusal(e, model).find("cannot be at 100; its limits are"), std::string::npos)
      << refusal(e, model);
  e.planner.kind = "cubik";
  EXPECT_EQ(refusal(e, model),
            "x.yaml:5: planner.kind: 'cubik' is not known; use one of hold, cubic, quintic, sinusoid, "
            "point_to_point, waypoints, line, circle");
  e.planner.kind = "sinusoid";
  e.planner.amplitude.value = 50.0;
  EXPECT_NE(refusal(e, model).find("would swing over"), std::string::npos) << refusal(e, model);
}

TEST(Planner, AFloatingBaseCanOnlyHold) {
  rbd::Model model;
  rbd::buildModels::humanoid(model);
  Experiment e;
  e.planner.kind = "sinusoid";
  EXPECT_NE(refusal(e, model).find("floats; only hold is possible"), std::string::npos);
  e.planner.kind = "hold";
  const Reference r = at(make_config(e, model), 5);
  EXPECT_EQ(r.q.size(), model.nq);
  EXPECT_EQ(r.q[6], 1);
  EXPECT_EQ(r.v.size(), model.nv);
}

TEST(Planner, UnknownActionsAreSaid) {
  const Config config = make_config(reach("hold"), arm());
  State state = initial(config);
  const std::vector<Action> actions{{"goal", "", "", "", {1}}, {"push", "", "", "", {}}};
  const Output out = step(config, state, {.step = 0, .actions = actions});
  ASSERT_EQ(out.events.size(), 1u);
  EXPECT_EQ(out.events[0].why, "'goal': has 1 values, expected 6");
}

// Both ends of the swing, each alone beyond a limit by 0.1, and both within: the swing of every joint is offset -+ |amplitude|.
TEST(Planner, ASwingBeyondOneLimitIsRefused) {
  Experiment e = reach("sinusoid");
  e.file = "x.yaml";
  e.planner.phase = {};
  for (const double amplitude : {0.5, -0.5}) {
    e.planner.amplitude.value = JointValues::Named{{"joint2_shoulder", amplitude}};
    const auto refused = [&](double offset) {
      rbd::Model model = arm();
      model.lowerPositionLimit[1] = -0.75;
      model.upperPositionLimit[1] = 0.75;
      e.planner.offset.value = JointValues::Named{{"joint2_shoulder", offset}};
      return refusal(e, model);
    };
    const std::string who = "x.yaml: planner.amplitude: joint 'joint2_shoulder' would swing over ";
    EXPECT_EQ(refused(-0.375), who + "-0.875 .. 0.125; its limits are -0.75 .. 0.75");
    EXPECT_EQ(refused(0.375), who + "-0.125 .. 0.875; its limits are -0.75 .. 0.75");
    for (const double offset : {-0.25, 0.25}) EXPECT_EQ(refused(offset), "accepted");
  }
}

TEST(Planner, AStartOrAGoalBelowALimitIsRefused) {
  rbd::Model model = arm();
  model.lowerPositionLimit[1] = -0.75;
  model.upperPositionLimit[1] = 0.75;
  Experiment e = reach("cubic");
  e.file = "x.yaml";
  const std::string why = ": joint 'joint2_shoulder' cannot be at -0.875; its limits are -0.75 .. 0.75";
  e.planner.goal.value = JointValues::Named{{"joint2_shoulder", -0.875}};
  EXPECT_EQ(refusal(e, model), "x.yaml: planner.goal" + why);
  e.planner.goal.value = JointValues::Named{{"joint2_shoulder", -0.75}};
  EXPECT_EQ(refusal(e, model), "accepted");
  e.simulator.q0.value = JointValues::Named{{"joint2_shoulder", -0.875}};
  EXPECT_EQ(refusal(e, model), "x.yaml: simulator.q0" + why);
}

}  // namespace
}  // namespace lab::planner
