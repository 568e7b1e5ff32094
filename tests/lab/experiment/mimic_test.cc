// Robots whose joints follow others, or have several degrees of freedom, as experiments.
#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <nlohmann/json.hpp>

#include "core/util/number.h"
#include "lab/check/check.h"
#include "lab/experiment/actions.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/joints.h"
#include "lab/experiment/robot.h"
#include "procs/solo/direct.h"
#include "tests/support/refusal.h"

namespace lab {
namespace {

std::string link(const std::string& name, double mass) {
  const std::string m = number(mass), i = number(0.01 * mass);
  return "<link name='" + name + "'><inertial><origin xyz='0.05 0.1 0.02'/><mass value='" + m +
         "'/><inertia ixx='" + i + "' iyy='" + i + "' izz='" + i +
         "' ixy='0' ixz='0' iyz='0'/></inertial></link>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& axis, const std::string& more = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
         child + "'/><origin xyz='0.2 0 0.1'/><axis xyz='" + axis +
         "'/><limit lower='-1' upper='1' effort='50' velocity='3'/>" + more + "</joint>";
}

/// An arm with a hand of two fingers: the leader comes last in model order.
const std::string kGripper = "<robot name='gripper'>" + link("ground", 1) + link("upper", 2) +
                             link("left", 0.5) + link("right", 0.4) +
                             joint("arm", "revolute", "ground", "upper", "0 1 0") +
                             joint("finger_a", "prismatic", "upper", "left", "0 1 0",
                                   "<mimic joint='finger_b' multiplier='-2' offset='0.1'/>") +
                             joint("finger_b", "prismatic", "upper", "right", "0 1 0") + "</robot>";

Experiment experiment(const std::vector<std::string>& set = {}) {
  return parse_experiment(R"(
robot: {model: urdf}
simulator: {dt: 0.001, duration: 1, q0: {arm: 0.2, finger_b: -0.1}}
planner: {kind: quintic, goal: {arm: -0.3, finger_b: 0.1}}
controller: {kind: computed_torque, kp: {arm: 100, finger_b: 100}, kd: {arm: 20, finger_b: 20}}
expect: {max_error.finger_b: {max: 0.001}}
)",
                          "x.yaml", set);
}

std::string refusal(const std::vector<std::string>& set) {
  return test::refusal_of([&] {
    const Experiment e = experiment(set);
    check(e, load_robot(e, kGripper));
  });
}

// The follower's finger comes along, and its weight counts: energy gained is the work done.
TEST(Mimic, ARunOfTheGripper) {
  const Experiment e = experiment();
  const Robot robot = load_robot(e, kGripper);
  ASSERT_EQ(robot.model.nv, 2);
  EXPECT_TRUE(check(e, robot).empty());
  const lab::Run run = *solo::run_direct(e, robot.model);
  const nlohmann::json figures = evaluate(run, e.expect);
  EXPECT_TRUE(figures["passed"]) << figures.dump(1);
  EXPECT_LT(figures["max_error"].get<double>(), 2e-3);  // dt times the speed of the path
  // the integrator's error is of first order in dt
  EXPECT_LT(figures["energy_drift_relative"].get<double>(), 0.01);
  EXPECT_EQ(figures["joints"].size(), 2u);

  rbd::Data data(robot.model);
  rbd::forwardKinematics(robot.model, data, run.steps.back().state.q);
  const auto along = [&](const char* frame) {
    const rbd::SE3 upper = data.oMf[robot.model.frameId("upper")];
    return upper.actInv(data.oMf[robot.model.frameId(frame)]).translation().y();
  };
  EXPECT_NEAR(along("right"), 0.1, 1e-3);
  EXPECT_NEAR(along("left"), -2 * along("right") + 0.1, 1e-15);
}

TEST(Mimic, FreeTwinHasOneMoreNumber) {
  const Robot robot = load_robot(experiment({"robot.mimic=false", "planner.kind=hold", "controller.kind=none",
                                             "simulator.q0=[0, 0, 0]", "controller.kd=1"}),
                                 kGripper);
  EXPECT_EQ(robot.model.nv, 3);
}

TEST(Mimic, NumbersForFollowersAreRefused) {
  const std::string why = "'finger_a' follows 'finger_b' and has no number of its own; name 'finger_b'";
  EXPECT_EQ(refusal({}), "accepted");
  for (const char* key : {"planner.goal", "controller.kp", "simulator.q0", "robot.lock", "robot.armature"})
    EXPECT_EQ(refusal({std::string(key) + ".finger_a=0.1"}),
              "--set: " + std::string(key) + ".finger_a: " + why);
  EXPECT_EQ(refusal({"expect.max_error.finger_a.max=1"}), "--set: expect.max_error.finger_a: " + why);
  EXPECT_EQ(refusal({"simulator.q0=[0, 0, 0]"}),
            "--set: simulator.q0: has 3 numbers, but 'gripper' has 2 joints (arm, finger_b)");
}

TEST(Mimic, ActionsCountWhatMoves) {
  const Experiment e = experiment();
  const rbd::Model model = load_robot(e, kGripper).model;
  EXPECT_EQ(why_not(e, model, {"goal", "", "", "", {0.1, 0.2}}), "");
  EXPECT_EQ(why_not(e, model, {"goal", "", "", "", {0.1, 0.2, 0.3}}),
            "goal has 3 values, expected 2, one for each joint");
  EXPECT_EQ(why_not(e, model, {"set", "controller", "kp", "", {1, 2}}), "");
  EXPECT_EQ(why_not(e, model, {"set", "controller", "kp", "", {1, 2, 3}}),
            "kp has 3 values, expected 1 or 2");
  EXPECT_EQ(joint_at(model, 0), "arm");
  EXPECT_EQ(joint_at(model, 1), "finger_b");
}

// Locking the leader locks the hand, at its place.
TEST(Mimic, LockedLeaderHoldsItsFollower) {
  const Experiment e = experiment({"robot.lock.finger_b=0.2", "planner.kind=hold", "simulator.q0=0.5"});
  const Robot robot = load_robot(e, kGripper);
  ASSERT_EQ(robot.model.nv, 1);
  const rbd::Frame& left = robot.model.frames[robot.model.frameId("left")];
  EXPECT_EQ(robot.model.names[left.parentJoint], "arm");
  EXPECT_NEAR(left.placement.translation().y(), -2 * 0.2 + 0.1, 1e-15);
}

// A base that slides in the plane: cos and sin in q, three rates.
TEST(MultiDof, PlanarBase) {
  const std::string cart = "<robot name='cart'>" + link("ground", 1) + link("base", 3) + link("pole", 1) +
                           joint("base", "planar", "ground", "base", "0 0 1") +
                           joint("pole", "revolute", "base", "pole", "0 1 0") + "</robot>";
  const auto run = [&](const std::vector<std::string>& set) -> std::string {
    try {
      const Experiment e = parse_experiment(
          "{robot: {model: urdf}, simulator: {dt: 0.001, duration: 0.5, integrator: rk4, allow_fall: true, "
          "q0: "
          "[0.1, 0.2, 0.6, 0.8, 0.3], v0: [0.5, 0.2, 2, -1]}, controller: {kind: none}}",
          "x.yaml", set);
      const Robot robot = load_robot(e, cart);
      const nlohmann::json figures = evaluate(*solo::run_direct(e, robot.model), e.expect);
      // nothing but gravity acts; rk4 loses energy with dt^4
      return figures["passed"] && figures["energy_drift_relative"].get<double>() < 1e-9 ? "ran"
                                                                                        : figures.dump(1);
    } catch (const ExperimentError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(run({}), "ran");
  EXPECT_EQ(run({"simulator.q0=[0, 0, 1, 1, 0]"}),
            "--set: simulator.q0: the direction (cos, sin) of joint 'base' has length 1.4142135623730951; it "
            "must be 1");
  EXPECT_EQ(
      run({"controller.kp.base=1"}),
      "--set: controller.kp.base: 'base' is a Planar; only joints of one degree of freedom can be named");
}

}  // namespace
}  // namespace lab
