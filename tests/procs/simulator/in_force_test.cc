// The answer to `get`: the experiment's values, and what requests have changed.
#include "procs/simulator/in_force.h"

#include <gtest/gtest.h>
#include <rbd/model/sample_models.h>

namespace lab::simulator {
namespace {

TEST(InForce, HasTheGainsOfTheLawAndWhatRequestsChanged) {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  Experiment e;
  e.controller.kind = "computed_torque";
  e.controller.kp.value = 100.0;
  e.controller.kd.value = std::vector<double>{1, 2, 3, 4, 5, 6};
  InForce values(e, model, {"kp", "kd"});
  EXPECT_EQ(values.text(),
            "controller.kind\tcomputed_torque\t\ncontroller.kp\t100\t1/s2\ncontroller.kd\t1,2,3,4,5,6\t1/s\n"
            "planner.motion\ton\t\n");
  values.take({"set", "controller", "kd", "", {7}});
  values.take({"goal", "", "", "", {0.5, 0, 0, 0, 0, 0}});
  values.take({"payload", "wrist_body", "", "", {2, 0, 0, 0}});
  values.take({"set", "controller", "stiffness", "", {1, 1, 1}});  // refused before: changes nothing
  EXPECT_EQ(values.text(),
            "controller.kind\tcomputed_torque\t\ncontroller.kp\t100\t1/s2\ncontroller.kd\t7\t1/s\n"
            "planner.motion\tgoal 0.5,0,0,0,0,0\trad, m\nsimulator.payload.wrist_body\t2\tkg\n");
  values.take({"set", "planner", "motion", "on", {}});
  EXPECT_NE(values.text().find("planner.motion\ton\t\n"), std::string::npos);
}

TEST(InForce, OfAControllerOfTheUsersOnlyWhatWasAskedForIsKnown) {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  InForce values(Experiment(), model, {});
  values.take({"set", "controller", "ki", "", {5}});
  EXPECT_EQ(values.text(), "controller.ki\t5\t\nplanner.motion\ton\t\n");
}

}  // namespace
}  // namespace lab::simulator
