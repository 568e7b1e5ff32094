// What `check` refuses, beyond what a file's keys and values allow.
#include "lab/check/check.h"

#include <gtest/gtest.h>

#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/robot.h"

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

}  // namespace
}  // namespace lab
