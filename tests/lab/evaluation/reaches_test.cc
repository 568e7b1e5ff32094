// Reaches and tools of signals made by hand, whose answers are known.
#include "lab/evaluation/reaches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/lab/evaluation/by_hand.h"

namespace lab {
namespace {

using nlohmann::json;

/// Joint one moves 0, 0, 0.5 and rests at 1 from step 3 on, while the robot does what it likes; joint two stays.
lab::Run one_reach(const std::vector<double>& actual) {
  std::vector<double> wanted(actual.size(), 1);
  wanted[0] = wanted[1] = 0, wanted[2] = 0.5;
  lab::Run run = test::by_hand(wanted, std::vector<double>(actual.size(), 0));
  test::edit(run, [&](size_t k, RunStep& step) {
    if (k == 2) step.reference.v[0] = 5;
    step.state.q[0] = actual[k];
  });
  return run;
}

TEST(Reaches, FiguresOfOneReachByHand) {
  // from arrival on: short, 0.2 over, inside, 0.05 over again, inside for good; 3 of the last tenth (of 10: one)
  const lab::Run run =
      one_reach({0, 0, 0.3, 0.9, 1.2, 1.004, 1.05, 0.995, 1.009, 0.991, 1.002, 1.001, 0.997});
  const json out = evaluate(run, {});
  ASSERT_EQ(out["reach_count"], 1);
  const json& reach = out["reaches"][0];
  EXPECT_NEAR(reach["begin"], 0.1, 1e-15);
  EXPECT_NEAR(reach["arrival"], 0.3, 1e-15);
  EXPECT_NEAR(reach["end"], 1.2, 1e-15);
  EXPECT_NEAR(out["reach_settling_max"], 0.4, 1e-12);  // not 0.2, where it was inside for one step
  EXPECT_NEAR(out["overshoot_max"], 0.2, 1e-15);
  EXPECT_NEAR(out["overshoot_share_max"], 0.2, 1e-15);
  EXPECT_NEAR(out["steady_error_max"], 0.003, 1e-15);
  EXPECT_EQ(out["joints"][0]["reach_settling_max"], out["reach_settling_max"]);
  EXPECT_EQ(out["joints"][1]["reach_settling_max"], 0);
  EXPECT_TRUE(out["joints"][1]["overshoot_max"].is_null());  // it had no way to go
  EXPECT_TRUE(evaluate(run, {{"reach_settling_max", {.min = {}, .max = 0.41}}})["passed"]);
  EXPECT_FALSE(evaluate(run, {{"reach_settling_max.one", {.min = {}, .max = 0.39}}})["passed"]);
}

TEST(Reaches, ALateExcursionIsNotSettledEarly) {
  json out = evaluate(one_reach({0, 0, 0.5, 1, 1, 1, 1, 1, 1, 1, 1.011, 1}), {});
  EXPECT_NEAR(out["reach_settling_max"], 0.8, 1e-12);
  out = evaluate(one_reach({0, 0, 0.5, 1, 1, 1, 1, 1, 1, 1, 1, 1.011}), {});
  EXPECT_TRUE(out["reach_settling_max"].is_null());
  EXPECT_TRUE(out["reach_settling_mean"].is_null());
  lab::Run run = one_reach({0, 0, 0.5, 1, 1, 1, 1, 1, 1, 1, 1, 1.011});
  run.band = 0.02;
  EXPECT_EQ(evaluate(run, {})["reach_settling_max"], 0);
}

TEST(Reaches, EachMotionAndRestIsOne) {
  // 0 -> 1 -> 0.4 (negative way), by jumps, and back to 0.4 without a rest in between: no new place
  lab::Run run = test::by_hand({0, 1, 1, 1, 0.4, 0.4, 0.4, 0.5, 0.4, 0.4}, std::vector<double>(10, 0));
  const double actual[] = {0, 0.5, 1, 1, 0.7, 0.3, 0.4, 0.4, 0.4, 0.4};
  test::edit(run, [&](size_t k, RunStep& step) {
    if (k == 7) step.reference.v[0] = 1;
    step.state.q[0] = actual[k];
  });
  const std::vector<Reach> all = reaches(run);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].arrival, 1u);
  EXPECT_EQ(all[0].end, 3u);
  EXPECT_EQ(all[1].begin, 3u);
  EXPECT_EQ(all[1].arrival, 4u);
  EXPECT_EQ(all[1].end, 6u);
  EXPECT_NEAR(all[0].joints[0].settling, 0.1, 1e-12);
  EXPECT_NEAR(all[1].joints[0].displacement, -0.6, 1e-15);
  EXPECT_NEAR(all[1].joints[0].overshoot, 0.1, 1e-15);
  EXPECT_NEAR(all[1].joints[0].overshoot_share, 1.0 / 6, 1e-15);
  EXPECT_NEAR(evaluate(run, {})["reach_settling_mean"], (0.1 + 0.2) / 2, 1e-12);
}

TEST(Reaches, NoneWithoutRestOrWithoutMotion) {
  EXPECT_EQ(evaluate(test::by_hand({0, 0, 0}, {1, 1, 1}), {})["reach_count"], 0);
  lab::Run run = test::by_hand({0, 0.1, 0.2, 0.3}, {0, 0, 0, 0});
  test::edit(run, [](size_t, RunStep& step) { step.reference.v[0] = 1; });
  const json out = evaluate(run, {});
  EXPECT_EQ(out["reach_count"], 0);
  EXPECT_TRUE(out["reach_settling_max"].is_null());
  test::edit(run, 3, [](RunStep& step) { step.reference.v[0] = 0; });  // it arrives with the last step
  EXPECT_EQ(evaluate(run, {})["reach_count"], 1);
}

// the step response of a damped oscillator: its overshoot and extremes are in every textbook
TEST(Reaches, SecondOrderStepResponse) {
  const double zeta = 0.3, w = 4, dt = 1e-3, wd = w * std::sqrt(1 - zeta * zeta);
  const size_t n = 6000;
  lab::Run run = test::by_hand(std::vector<double>(n, 1), std::vector<double>(n, 0));
  run.dt = dt;
  const auto error = [&](double t) {
    return -std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t));
  };
  test::edit(run, [&](size_t k, RunStep& step) {
    if (k == 0)
      step.reference.q[0] = 0;  // the step: the target is there from step 1 on
    else
      step.state.q[0] = 1 + error(static_cast<double>(k - 1) * dt);
  });
  const Reach::Joint joint = reaches(run).at(0).joints[0];
  // a sample is at most dt / 2 from the peak, where the second derivative is below w^2
  EXPECT_NEAR(joint.overshoot, std::exp(-zeta * std::numbers::pi * w / wd), w * w * dt * dt / 8);
  // the extremes are half periods apart and shrink by the same factor: after the last one outside the band the error
  // crosses the band once more, found by bisection
  int last = 0;
  while (std::exp(-zeta * w * (last + 1) * std::numbers::pi / wd) > run.band) ++last;
  double outside = last * std::numbers::pi / wd, inside = (last + 0.5) * std::numbers::pi / wd;
  for (int i = 0; i < 60; ++i) {
    const double middle = (outside + inside) / 2;
    (std::abs(error(middle)) > run.band ? outside : inside) = middle;
  }
  EXPECT_NEAR(joint.settling, inside, dt);
  EXPECT_LT(joint.steady_error, 1e-2);
}

TEST(Tool, ErrorAndTurnOfAPlanarArm) {
  // tip at (cos a + cos(a + b), sin a + sin(a + b)): the robot at 0, 0 has it at (2, 0)
  const double a = 0.4, b = -0.3;
  lab::Run run = test::by_hand({0, a}, {0, b});
  const double x = std::cos(a) + std::cos(a + b) - 2, y = std::sin(a) + std::sin(a + b);
  json out = evaluate(run, {});
  EXPECT_EQ(out["tool_frame"], "tip");  // the last link, not the last frame
  EXPECT_NEAR(out["max_tool_error"], std::hypot(x, y), 1e-15);
  EXPECT_NEAR(out["mean_tool_error"], std::hypot(x, y) / 2, 1e-15);
  EXPECT_NEAR(out["rms_tool_error"], std::hypot(x, y) / std::sqrt(2), 1e-15);
  EXPECT_NEAR(out["final_tool_error"], std::hypot(x, y), 1e-15);
  EXPECT_NEAR(out["max_tool_turn"], std::abs(a + b), 1e-15);
  run.tool = "upper";
  out = evaluate(run, {});
  EXPECT_NEAR(out["max_tool_error"], 2 * std::sin(a / 2), 1e-15);  // a chord of the unit circle
  EXPECT_NEAR(out["max_tool_turn"], a, 1e-15);
}

TEST(Evaluate, MarginsAndSharesOfLimits) {
  lab::Run run = test::by_hand({0, 0, 0}, {0, 0, 0});
  EXPECT_TRUE(evaluate(run, {})["min_position_margin"].is_null());
  EXPECT_EQ(evaluate(run, {})["max_speed_share"], 0);
  run.model.lowerPositionLimit << -1, -2;
  run.model.upperPositionLimit << 1, 0.25;
  run.model.upperVelocityLimit << 4, 2;
  run.model.lowerVelocityLimit << -4, -2;
  run.model.upperEffortLimit << 10, 10;
  run.model.lowerEffortLimit << -5, -10;
  test::edit(run, 1, [](RunStep& step) {
    step.state.q << 0.9, 0;
    step.state.v << -3, 1;
    step.state.tau << -4, 3;  // a share of the limit on its own side
  });
  test::edit(run, 2, [](RunStep& step) { step.state.q << 0, 0.3; });
  const json out = evaluate(run, {});
  EXPECT_NEAR(out["min_position_margin"], -0.05, 1e-15);
  EXPECT_NEAR(out["joints"][0]["min_position_margin"], 0.1, 1e-15);
  EXPECT_DOUBLE_EQ(out["max_speed_share"], 0.75);
  EXPECT_DOUBLE_EQ(out["max_effort_share"], 0.8);
  EXPECT_TRUE(evaluate(run, {{"min_position_margin.one", {.min = 0.05, .max = {}}}})["passed"]);
}

}  // namespace
}  // namespace lab
