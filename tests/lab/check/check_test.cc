// What `check` refuses, beyond what a file's keys and values allow.
#include "lab/check/check.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "lab/check/unused.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/robot.h"
#include "procs/controller/controller.h"
#include "procs/planner/motions.h"

namespace lab {
namespace {

/// What is said of an experiment with this process; "" if nothing is.
std::string said_of(const std::string& process) {
  const Experiment e = parse_experiment(
      "robot: {model: \"builtin:manipulator\"}\nprocesses:\n  " + process + ": python3 mine.py\n", "x.yaml");
  try {
    check(e, load_robot(e));
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return "";
}

TEST(Processes, ANameThatIsNearlyAUsualOneIsRefused) {
  for (const std::string wrong : {"controler", "contoller", "controlle", "planer", "loger", "simulater"}) {
    const std::string said = said_of(wrong);
    EXPECT_EQ(said.find("x.yaml:3: processes." + wrong), 0u) << wrong << ": " << said;
  }
  EXPECT_NE(said_of("controler").find("did you mean 'controller'?"), std::string::npos);
  for (const char* other : {"controller", "logger2", "rendererr", "camera", "recorder", "spy", "plan"})
    EXPECT_EQ(said_of(other), "");
}

/// What is said of keys that nothing reads; "" if nothing is.
std::string unused(const std::string& text, const std::vector<std::string>& overrides = {},
                   const std::set<std::string>& varies = {}, const std::string& file = "x.yaml") {
  try {
    check_unused(parse_experiment("robot: {model: \"builtin:manipulator\"}\n" + text, file, overrides),
                 varies);
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return "";
}

TEST(Unused, AKeyThatTheKindDoesNotReadIsRefused) {
  EXPECT_EQ(unused("controller: {kind: pd, kp: 1, kd: 1, stiffness: [1, 2]}\n"),
            "x.yaml:2: controller.stiffness: is not used by pd, only by cartesian_impedance; remove it or "
            "choose another "
            "controller.kind");
  EXPECT_EQ(unused("controller: {kp: 1}\n", {"controller.com_gain=2"}).find("--set: controller.com_gain: "),
            0u);
  EXPECT_NE(unused("planner: {kind: hold, goal: 0.1}\n"), "");
  EXPECT_NE(unused("planner: {kind: circle, dwell: 0.1}\n"), "");
  EXPECT_NE(unused("controller: {kind: none, kp: 1}\n"), "");
}

TEST(Unused, AKeyThatIsReadOrHasItsDefaultIsFine) {
  EXPECT_EQ(unused("controller: {kind: com_velocity, kp: 1, kd: 1, com_gain: 2, every: 2}\n"), "");
  EXPECT_EQ(unused("planner: {kind: cubic, goal: 0.1, duration: 0.5, speed: 0.2, lead: 16}\n"), "");
  EXPECT_EQ(unused("planner: {kind: hold, duration: 1, dwell: 0.5, cycle: true, normal: [0, 0, 1]}\n"), "");
  EXPECT_EQ(unused("controller: {kind: none, kp: 0}\n"), "");
}

TEST(Unused, AFileIsForItsOwnKind) {
  const std::string file =
      "controller: {kind: cartesian_impedance, kp: 1, stiffness: [1, 2], frame: wrist_body}\n";
  EXPECT_EQ(unused(file, {"controller.kind=pd"}), "");  // what is left of the other kind
  EXPECT_NE(unused(file, {"controller.kind=pd", "controller.com_gain=1"}), "");
  EXPECT_EQ(unused("", {"controller.com_gain=1"}, {"controller"}), "");  // a sweep over the kind
  EXPECT_EQ(unused("controller: {com_gain: 1}\nprocesses: {controller: mine}\n"), "");
}

TEST(Unused, WhatTheLabWroteItselfStaysReadable) {
  const std::string path = testing::TempDir() + "/unused_test.yaml",
                    text = "controller: {kind: pd, com_gain: 1}\n";
  std::ofstream(path) << kAsRun << "; made from x.yaml.\n";
  EXPECT_EQ(unused(text, {}, {}, path), "");
  EXPECT_NE(unused(text, {"controller.damping=[1, 1]"}, {}, path), "");
}

TEST(Unused, EveryKeyOfAKindExists) {
  std::set<std::string> known;
  for (const auto& [key, value] : key_values(Experiment())) known.insert(key);
  const auto each = [&](const std::string& section, const std::string& keys) {
    std::stringstream words(keys);
    for (std::string word; words >> word;)
      EXPECT_TRUE(known.contains(section + "." + word)) << section << "." << word;
  };
  for (const controller::Kind& kind : controller::kinds()) each("controller", kind.keys);
  for (const planner::Kind& kind : planner::kinds()) each("planner", kind.keys);
}

}  // namespace
}  // namespace lab
