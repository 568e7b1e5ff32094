// Every experiment of experiments/, run without processes: it must be accepted, meet what it expects, and give the figures
// that the catalogue in docs/experiments.md says it gives.
#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "lab/check/check.h"
#include "lab/evaluation/metrics.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/robot.h"
#include "procs/controller/controller.h"
#include "procs/planner/planner.h"
#include "procs/solo/direct.h"
#include "tests/support/paths.h"

namespace lab {
namespace {

const std::string kFolder = lab::source_path("experiments/");

std::string page() {
  std::stringstream text;
  text << std::ifstream(lab::source_path("docs/experiments.md")).rdbuf();
  return text.str();
}

/// The row of the catalogue that begins with a picture of this experiment; empty if there is none.
std::string catalogue_row(const std::string& name) {
  const std::string text = page();
  const size_t at = text.find("\n| ![](pictures/catalogue/" + name + ".png) | [" + name +
                              "](../experiments/" + name + ".yaml)<br>");
  return at == std::string::npos ? "" : text.substr(at + 1, text.find('\n', at + 1) - at - 1);
}

nlohmann::json outcome(const std::string& name, const std::vector<std::string>& set = {}) {
  const Experiment e = load_experiment(kFolder + name, set);
  const Robot robot = load_robot(e);
  for (const std::string& warning : check(e, robot)) std::cout << warning << "\n";
  return evaluate(*solo::run_direct(e, robot.model), e.expect);
}

class Experiments : public testing::TestWithParam<std::string> {};

TEST_P(Experiments, MeetsItsExpectations) {
  const Experiment e = load_experiment(kFolder + GetParam());
  if (e.robot.model.starts_with("package://")) {
    try {
      load_robot(e);
    } catch (const ExperimentError& error) {
      if (std::string(error.what()).find("scripts/lab robots") == std::string::npos) throw;
      GTEST_SKIP() << error.what();
    }
  }
  const nlohmann::json result = outcome(GetParam());
  EXPECT_FALSE(e.expect.empty());
  EXPECT_TRUE(result["passed"]) << result.dump(1);
  const std::string row = catalogue_row(e.name);
  const std::regex figure("`([a-z_]+(?:\\.[A-Za-z0-9_]+)?)` (-?[0-9.]+(?:e-?[0-9]+)?)");
  int figures = 0;
  for (std::sregex_iterator it(row.begin(), row.end(), figure), none; it != none; ++it, ++figures) {
    const nlohmann::json value = value_of(result, (*it)[1]);
    ASSERT_TRUE(value.is_number()) << it->str();
    const double written = std::stod((*it)[2]);
    EXPECT_NEAR(value.get<double>(), written, 0.01 * std::abs(written))
        << it->str() << ", in docs/experiments.md";
  }
  EXPECT_GT(figures, 0) << "docs/experiments.md: no row with figures of " << e.name << ", but '" << row
                        << "'";
  if (std::getenv("LAB_VERBOSE")) std::cout << GetParam() << result.dump(1) << "\n";
}

/// Of robots that are there, or of those that scripts/lab robots fetches.
std::vector<std::string> all_experiments(bool fetched) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder))
    if (entry.path().extension() == ".yaml")
      if (const Experiment e = load_experiment(entry.path());
          e.simulator.clock == "lockstep" && e.robot.model.starts_with("package://") == fetched)
        names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::string name_of(const testing::TestParamInfo<std::string>& info) {
  return info.param.substr(0, info.param.find('.'));
}
INSTANTIATE_TEST_SUITE_P(All, Experiments, testing::ValuesIn(all_experiments(false)), name_of);
INSTANTIATE_TEST_SUITE_P(Robots, Experiments, testing::ValuesIn(all_experiments(true)), name_of);

// the handbook's claim: with the same gains, knowing the model is worth more than a factor of ten
TEST(Experiments, ComputedTorqueTracksTenTimesBetterThanPd) {
  for (const char* robot : {"sinusoid", "arm3_sinusoid"}) {
    const auto ct = outcome(std::string(robot) + "_ct.yaml"), pd = outcome(std::string(robot) + "_pd.yaml");
    EXPECT_LT(10 * ct["max_error"].get<double>(), pd["max_error"].get<double>()) << robot;
    const auto e = load_experiment(kFolder + robot + "_ct.yaml"),
               f = load_experiment(kFolder + robot + "_pd.yaml");
    EXPECT_EQ(e.controller.kp, f.controller.kp);
    EXPECT_EQ(e.controller.kd, f.controller.kd);
  }
}

// every file of the catalogue exists, and every file is in it (those of the lockstep have figures besides, see above)
TEST(Experiments, TheCatalogueListsAllOfThemAndNothingElse) {
  std::set<std::string> files, listed;
  for (const char* folder : {"", "sweeps/"})
    for (const auto& entry : std::filesystem::directory_iterator(kFolder + folder))
      if (entry.is_regular_file()) files.insert(folder + entry.path().filename().string());
  const std::string text = page(), catalogue = text.substr(text.find("\n## Catalogue\n"));
  const std::regex link(R"(\[([a-z0-9_]+)\]\(\.\./experiments/([a-z0-9_/]+\.yaml)\))");
  for (std::sregex_iterator it(catalogue.begin(), catalogue.end(), link), none; it != none; ++it)
    listed.insert((*it)[2]);
  EXPECT_EQ(files, listed);
}

TEST(Experiments, DisturbancesThatAreNotAsWrittenAreTold) {
  const auto warnings = [](const std::string& set) {
    const Experiment e = load_experiment(kFolder + "pushed.yaml", {set});
    std::string all;
    for (const std::string& warning : check(e, load_robot(e))) all += warning;
    return all;
  };
  EXPECT_EQ(warnings("simulator.delay=0.003"), "");
  EXPECT_EQ(warnings("simulator.delay=0.0024"),
            "--set: simulator.delay: warning: is not a whole number of steps; the delay is 0.002 s");
  EXPECT_EQ(warnings("simulator.payloads=[{time: 4, frame: effector_body, mass: 1}]"),
            "--set: simulator.payloads[0].time: warning: 4 s is after the end of the run: it never happens");
  EXPECT_EQ(warnings("simulator.payloads=[{time: 3.999, frame: effector_body, mass: 1}]"), "");
  EXPECT_EQ(warnings("simulator.limit_repulsion.stiffness=1000"), "");
  EXPECT_NE(warnings("simulator.limit_repulsion.stiffness=1e6")
                .find("simulator.limit_repulsion.stiffness: warning: the soft stops are at"),
            std::string::npos);
}

// .. but only if it knows it: masses wrong by half cost a factor of hundreds, a PD with gravity's compensation about five
TEST(Experiments, MassesWrongByHalfAreAnotherController) {
  const auto error = [](const std::vector<std::string>& set) {
    return outcome("wrong_masses.yaml", set)["max_error"].get<double>();
  };
  const std::string right = "controller.model.mass_scale=1", gravity = "controller.kind=pd_gravity";
  const double ct = error({}) / error({right}), pd = error({gravity}) / error({gravity, right});
  EXPECT_GT(ct, 300);
  EXPECT_LT(ct, 600);
  EXPECT_GT(pd, 4);
  EXPECT_LT(pd, 8);
  EXPECT_EQ(error({right}),
            outcome("sinusoid_ct.yaml")["max_error"].get<double>());  // the same path and gains
}

// the tool ends 20 N / 1000 N/m below where it was, not turned; after 3 s the slowest spring and damper (40 / 10 per s) has
// left exp(-12) of the way
TEST(Experiments, TheHeldToolGivesWayByForceOverStiffness) {
  const Experiment e = load_experiment(kFolder + "impedance.yaml");
  const Robot robot = load_robot(e);
  const auto run = *solo::run_direct(e, robot.model);
  const auto tool = [&](const RobotState& state) {
    rbd::Data data(robot.model);
    rbd::forwardKinematics(robot.model, data, state.q);
    return data.oMf[robot.model.frameId("arm_tool_link")];
  };
  const rbd::SE3 first = tool(run.steps[0].state), last = tool(run.steps.back().state);
  EXPECT_LT((last.translation() - first.translation() - Eigen::Vector3d(0, 0, -0.02)).norm(), 1e-6);
  EXPECT_LT((last.rotation() - first.rotation()).norm(), 1e-5);
}

TEST(Experiments, DocumentListsEveryController) {
  std::string table = "| kind | effort |\n|---|---|\n";
  for (const controller::Kind& kind : controller::kinds())
    table += "| `" + std::string(kind.name) + "` | " + kind.what + " |\n";
  EXPECT_NE(page().find(table + "\n"), std::string::npos) << "docs/experiments.md should have\n" << table;
}

TEST(Experiments, DocumentListsEveryMotion) {
  std::string table = "| kind | motion |\n|---|---|\n";
  for (const planner::Kind& kind : planner::kinds())
    table += "| `" + std::string(kind.name) + "` | " + kind.what + " |\n";
  EXPECT_NE(page().find(table + "\n"), std::string::npos) << "docs/experiments.md should have\n" << table;
}

// why the handbook's arm has armature here
TEST(Experiments, TheHandbooksArmExplodesWithoutArmature) {
  const auto result = outcome("arm3_cubic_pd.yaml", {"robot.armature=0"});
  EXPECT_GT(result["max_error"].get<double>(), 10) << result.dump(1);
  EXPECT_FALSE(result["passed"]);
}

}  // namespace
}  // namespace lab
