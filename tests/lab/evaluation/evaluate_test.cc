// Metrics against series made by hand, and energy against friction's work.
#include "lab/evaluation/evaluate.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "procs/solo/direct.h"
#include "tests/lab/evaluation/by_hand.h"
#include "tests/support/paths.h"
#include "tests/support/refusal.h"

namespace lab {
namespace {

using nlohmann::json;

using test::by_hand;

TEST(Evaluate, FiguresOfASeriesByHand) {
  lab::Run run = by_hand({0.3, -0.4, 0, 0.005}, {0, 0.3, 0, -0.002});
  test::edit(run, 2, [](RunStep& step) { step.state.tau = Eigen::Vector2d(3, -4); });
  run.model.upperEffortLimit << 6, 7;
  run.model.lowerEffortLimit << -6, -5;
  const json out = evaluate(run, {});
  EXPECT_DOUBLE_EQ(out["max_error"], 0.4);
  EXPECT_NEAR(out["mean_error"], (0.3 + 0.4 + 0.005 + 0.3 + 0.002) / 8, 1e-15);
  EXPECT_NEAR(out["rms_error"], std::sqrt((0.09 + 0.16 + 25e-6 + 0.09 + 4e-6) / 8), 1e-15);
  EXPECT_DOUBLE_EQ(out["final_error"], 0.005);
  EXPECT_NEAR(out["handbook_error"], (0.3 + 0.5 + std::sqrt(29e-6)) / 2 / 4, 1e-15);
  EXPECT_EQ(out["handbook_grade"], "needs_tuning");
  EXPECT_DOUBLE_EQ(out["max_effort"], 4);
  EXPECT_NEAR(out["rms_effort"], std::sqrt(25.0 / 6), 1e-15);  // three steps were driven, two joints
  EXPECT_DOUBLE_EQ(out["max_effort_share"], 0.8);
  EXPECT_NEAR(out["settling_time"], 0.2, 1e-15);
  EXPECT_EQ(out["joints"][1]["name"], "two");
  EXPECT_DOUBLE_EQ(out["joints"][1]["max_error"], 0.3);
  EXPECT_TRUE(out["passed"]);
}

TEST(Evaluate, LeavingTheBandAgainIsNotSettled) {
  // joint one is in, out, in for good from step 3; joint two goes out at the very end
  json out = evaluate(by_hand({0.009, 0.001, 0.02, 0.01, 0, 0}, {0, 0, 0, 0, 0, 0.011}), {});
  EXPECT_NEAR(out["joints"][0]["settling_time"], 0.3, 1e-15);
  EXPECT_TRUE(out["joints"][1]["settling_time"].is_null());
  EXPECT_TRUE(out["settling_time"].is_null());
  out = evaluate(by_hand({0.02, 0, 0}, {0, 0, 0}), {});
  EXPECT_NEAR(out["settling_time"], 0.1, 1e-15);
}

TEST(Evaluate, GradesAsTheHandbookDoes) {
  const std::pair<double, const char*> grades[] = {
      {0.0099, "excellent"}, {0.0101, "good"}, {0.049, "good"}, {0.051, "needs_tuning"}};
  for (const auto& [figure, grade] : grades)  // norm((2 f, 0)) / 2 = f
    EXPECT_EQ(evaluate(by_hand({2 * figure, 2 * figure}, {0, 0}), {})["handbook_grade"], grade);
}

TEST(Evaluate, Verdicts) {
  const lab::Run run = by_hand({0.02, 0.02}, {0, 0});
  const auto passed = [&](const char* metric, Bound bound) {
    return evaluate(run, {{metric, bound}})["passed"].get<bool>();
  };
  EXPECT_TRUE(passed("max_error", {.min = {}, .max = 0.02}));
  EXPECT_FALSE(passed("max_error", {.min = {}, .max = 0.019}));
  EXPECT_FALSE(passed("max_error", {.min = 0.021, .max = {}}));
  EXPECT_TRUE(passed("max_error.two", {.min = {}, .max = 0}));
  EXPECT_FALSE(passed("max_error.one", {.min = {}, .max = 0}));
  EXPECT_FALSE(passed("settling_time", {.min = {}, .max = 1e9}));  // it never settles
  const json verdict = evaluate(run, {{"max_error", {.min = 0.001, .max = 0.1}}})["verdicts"][0];
  EXPECT_EQ(verdict["metric"], "max_error");
  EXPECT_EQ(verdict["value"], 0.02);
  EXPECT_EQ(verdict["ok"], true);
}

TEST(Evaluate, AShortOrEmptyRunDoesNotPass) {
  lab::Run run = by_hand({0, 0, 0}, {0, 0, 0});
  EXPECT_TRUE(evaluate(run, {})["passed"]);
  run.last_step = 3;
  EXPECT_FALSE(evaluate(run, {})["passed"]);
  run.last_step = 2;
  run.aborted = true;
  EXPECT_FALSE(evaluate(run, {})["passed"]);
  run.steps = {};
  const json out = evaluate(run, {{"max_error", {.min = {}, .max = 1}}});
  EXPECT_FALSE(out["passed"]);
  EXPECT_EQ(out["verdicts"][0]["ok"], false);
}

TEST(Evaluate, NoMetricIsEverNotANumber) {
  lab::Run run = by_hand({1e200, 1e200}, {0, 0});  // finite, but not its square
  EXPECT_EQ(evaluate(run, {})["max_error"], 1e200);
  EXPECT_TRUE(evaluate(run, {})["rms_error"].is_null());
  EXPECT_TRUE(evaluate(run, {})["handbook_error"].is_null());
  EXPECT_FALSE(evaluate(run, {{"rms_error", {.min = 0, .max = {}}}})["passed"]);
  run = by_hand({0, 0}, {0, 0});
  test::edit(run, 1, [](RunStep& step) { step.state.step = 2; });  // thinned: work between cannot be known
  EXPECT_TRUE(evaluate(run, {})["energy_drift"].is_null());
}

TEST(Evaluate, EnergyBalancesWithWorkAndFriction) {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  Experiment e;
  e.simulator.dt = 1e-3;
  e.simulator.duration = 2;
  e.simulator.integrator = "rk4";
  e.simulator.q0.value = std::vector<double>{0.1, 0.5, -0.5, 0.2, 0.3, 0.1};
  e.simulator.damping.value = 0.8;
  e.simulator.friction.value = 0.3;
  e.controller.kind = "pd";
  e.controller.kp.value = 20.0;
  e.controller.kd.value = 1.0;
  const json out = evaluate(*solo::run_direct(e, model), {});
  const double first = out["energy_first"], last = out["energy_last"], work = out["work"];
  EXPECT_GT(std::abs(last - first), 1);  // J
  // The trapezoidal rule on friction's power, whose tanh turns within 0.01 rad/s, is the coarsest part
  EXPECT_LT(out["energy_drift"].get<double>(), 1e-3) << out["energy_drift"];
  EXPECT_NEAR(last - first, work, 1e-3);
}

// pushes, payloads that come and go, soft stops that spring and damp: all at once, and all in the account
TEST(Evaluate, EnergyBalancesUnderDisturbances) {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  Experiment e;
  e.simulator.duration = 2;
  e.simulator.integrator = "rk4";
  e.simulator.q0.value =
      std::vector<double>{2.9, 0.5, -0.5, 0.2, 0.3, 0.1};  // the base begins inside its stop
  e.simulator.limit_repulsion = {.stiffness = {200.0}, .damping = {30.0}, .margin = {0.5}};
  e.simulator.pushes = {
      {.time = 0.2, .duration = 0.5, .frame = "effector_body", .force = {10, 20, 5}, .torque = {1, -2, 3}},
      {.time = 0.5, .duration = 5, .frame = "joint3_elbow", .force = {0, -10, 0}, .torque = {0, 4, 0}}};
  e.simulator.payloads = {{.time = 0, .frame = "effector_body", .mass = 1, .com = {0, 0.1, 0.1}},
                          {.time = 0.8, .frame = "joint3_elbow", .mass = 3, .com = {0, 0, 0.2}},
                          {.time = 1.1, .frame = "effector_body", .mass = 2, .com = {0.1, 0, 0}},
                          {.time = 1.5, .frame = "joint3_elbow", .mass = 0}};
  e.controller.kind = "none";
  const auto drift = [&](double dt, bool with_account) {
    e.simulator.dt = dt;
    lab::Run run = *solo::run_direct(e, model);
    if (!with_account)
      test::edit(run, [](size_t, RunStep& step) { step.stored_energy = step.external_work = 0; });
    return evaluate(run, {})["energy_drift"].get<double>();
  };
  EXPECT_GT(drift(1e-3, false), 10) << "J: there is something to account for";
  // what is left is the trapezoidal rule's, and rk4's where a stop sets in with a kink: both of second order, the second
  // with a factor that depends on where within a step that happens
  const double coarse = drift(1e-3, true), fine = drift(1.25e-4, true);
  EXPECT_LT(coarse, 0.01);
  EXPECT_NEAR(std::log2(coarse / fine) / 3, 2, 0.5) << coarse << " " << fine;
}

TEST(Evaluate, ExpectationsMustExist) {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  Experiment e;
  e.file = "x.yaml";
  const auto message = [&](const std::string& metric) {
    e.expect = {{metric, {}}};
    return test::refusal_of([&] { check_expect(e, model); });
  };
  EXPECT_EQ(message("max_error.joint2_shoulder"), "accepted");
  EXPECT_EQ(message("max_eror"),
            "x.yaml: expect.max_eror: there is no metric 'max_eror'; did you mean 'max_error'?");
  EXPECT_EQ(message("work.joint2_shoulder"),
            "x.yaml: expect.work.joint2_shoulder: 'work' is not kept per joint");
  EXPECT_EQ(message("max_error.joint2_sholder"),
            "x.yaml: expect.max_error.joint2_sholder: 'manipulator' has no such joint; did you mean "
            "'joint2_shoulder'?");
}

TEST(Evaluate, TheToolMustExist) {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  Experiment e;
  e.file = "x.yaml";
  e.evaluation.frame = "arm_tool_lnk";
  try {
    check_evaluation(e, model);
    FAIL() << "accepted";
  } catch (const ExperimentError& error) {
    EXPECT_STREQ(
        error.what(),
        "x.yaml: evaluation.frame: 'manipulator' has no frame 'arm_tool_lnk'; did you mean 'arm_tool_link'?");
  }
  e.evaluation.frame = "arm_tool_link";
  check_evaluation(e, model);
}

// a metric that can be expected is in the metrics of a run, in the table of docs/experiments.md and on docs/metrics.md
TEST(Evaluate, EveryMetricIsThereAndExplained) {
  const auto page = [](const char* name) {
    std::ifstream in(lab::source_path("docs/") + name);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string experiments = page("experiments.md"), formulas = page("metrics.md");
  const json out = evaluate(by_hand({0, 0}, {0, 0}), {});
  for (const Metric& metric : metrics()) {
    EXPECT_TRUE(out.contains(metric.name)) << metric.name;
    EXPECT_EQ(out["joints"][0].contains(metric.name), metric.per_joint) << metric.name;
    EXPECT_NE(experiments.find(std::string("| `") + metric.name + "` | " + metric.unit + " | " + metric.what +
                               " |\n"),
              std::string::npos)
        << metric.name;
    EXPECT_NE(formulas.find(std::string("`") + metric.name + "`"), std::string::npos) << metric.name;
  }
}

}  // namespace
}  // namespace lab
