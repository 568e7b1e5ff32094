// When a goal counts as reached, and when as not.
#include "procs/send/arrival.h"

#include <gtest/gtest.h>
#include <rbd/model/sample_models.h>

namespace lab::send {
namespace {

struct World {
  Experiment e;
  rbd::Model model;
  World() {
    rbd::buildModels::manipulator(model);
    e.simulator.dt = 0.01;
  }
  Reference reference(int64_t step, double q, double v) const {
    return {step, Eigen::VectorXd::Constant(6, q), Eigen::VectorXd::Constant(6, v), Eigen::VectorXd::Zero(6)};
  }
  RobotState state(int64_t step, double q) const {
    return {step, 0, Eigen::VectorXd::Constant(6, q), Eigen::VectorXd::Zero(6), Eigen::VectorXd::Zero(6)};
  }
  Arrival arrival() const { return {e, model, {"goal", "", "", "", std::vector<double>(6, 0.5)}, 100}; }
};

TEST(Arrival, IsWhenTheReferenceRestsThereAndTheRobotIsInTheBand) {
  const World world;
  Arrival arrival = world.arrival();
  arrival.see(world.reference(90, 0.5, 0));  // before the goal
  arrival.see(world.state(101, 0.5));
  EXPECT_FALSE(arrival.over());
  arrival.see(world.reference(150, 0.5, 0.1));  // passes by
  arrival.see(world.state(150, 0.5));
  EXPECT_FALSE(arrival.over());
  arrival.see(world.reference(200, 0.5, 0));
  arrival.see(world.state(199, 0.5));
  arrival.see(world.state(200, 0.48));
  EXPECT_FALSE(arrival.over());
  arrival.see(world.state(210, 0.4901));
  EXPECT_TRUE(arrival.reached());
  EXPECT_EQ(arrival.step(), 210);
  EXPECT_NEAR(arrival.seconds(), 1.1, 1e-12);
}

TEST(Arrival, ARobotThatStaysAwayIsNamed) {
  const World world;
  Arrival arrival = world.arrival();
  arrival.see(world.reference(200, 0.5, 0));
  arrival.see(world.state(700, 0.4));
  EXPECT_FALSE(arrival.over());
  arrival.see(world.state(701, 0.4));
  EXPECT_TRUE(arrival.over());
  EXPECT_FALSE(arrival.reached());
  EXPECT_EQ(arrival.why_not(), "joint 'joint1_base_yaw' is 0.1 from it 5 s after the reference has arrived");
}

TEST(Arrival, AnotherGoalTheMotionAndTheEndPutAnEndToIt) {
  const World world;
  for (const Action& action :
       {Action{"goal", "", "", "", {}}, Action{"set", "planner", "motion", "on", {}}}) {
    Arrival arrival = world.arrival();
    arrival.see(action);
    EXPECT_TRUE(arrival.over() && !arrival.reached());
  }
  Arrival arrival = world.arrival();
  arrival.see(Action{"set", "controller", "kp", "", {1}});
  EXPECT_FALSE(arrival.over());
  EXPECT_EQ(arrival.why_not(), "the reference has not arrived there");
  arrival.give_up("the run has ended");
  arrival.see(world.reference(200, 0.5, 0));
  arrival.see(world.state(200, 0.5));
  EXPECT_EQ(arrival.why_not(), "the run has ended");
  EXPECT_FALSE(arrival.reached());
}

}  // namespace
}  // namespace lab::send
