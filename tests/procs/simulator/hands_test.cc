// What people and faults do to the simulated robot: pushes by virtual work, holding, speed limits.
#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

#include "procs/simulator/simulator.h"

namespace lab::simulator {
namespace {

Experiment live() {
  Experiment e;
  e.simulator.clock = "realtime";
  e.simulator.q0.value = std::vector<double>{0.3, 0.8, -0.5, 0.4, 0.6, 0.2};
  return e;
}
rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

TEST(Hands, APushDoesTheWorkOfItsWrench) {
  Experiment e = live();
  e.simulator.clock = "lockstep";
  e.simulator.integrator = "rk4";
  e.simulator.dt = 1e-4;
  rbd::Model model = arm();
  model.gravity = rbd::Motion::Zero();
  const Config config = make_config(e, model);
  State state = initial(config);
  rbd::Data data(config.model);
  const auto frame = config.model.frameId("effector_body");
  const Eigen::Vector3d force(3, -2, 5);
  const std::vector<Action> push{
      {"push", "effector_body", "", "", {0, 0, 0, force[0], force[1], force[2], 0.05}}};
  rbd::framesForwardKinematics(config.model, data, state.robot.q);
  const Eigen::Vector3d before = data.oMf[frame].translation();
  for (int k = 0; k < 500; ++k)
    EXPECT_TRUE(step(config, state, {.actions = k == 0 ? push : std::vector<Action>{}}).events.empty());
  EXPECT_TRUE(state.load.pushes.empty()) << "0.05 s are over";
  rbd::framesForwardKinematics(config.model, data, state.robot.q);
  const double work = force.dot(data.oMf[frame].translation() - before);
  const auto kinetic = [&] {  // with the rotors' armature
    const Eigen::MatrixXd M = rbd::crba(config.model, data, state.robot.q);
    return 0.5 * state.robot.v.dot(M * state.robot.v);
  };
  const double energy = kinetic();
  ASSERT_GT(energy, 1e-4);
  EXPECT_NEAR(energy, work, 1e-9 * energy + 1e-12);  // fourth order at dt 1e-4
  for (int k = 0; k < 100; ++k) step(config, state, {});
  EXPECT_NEAR(kinetic(), energy, 1e-9) << "the push is over";
}

TEST(Hands, HoldingBringsTheRobotToRestAndKeepsItThere) {
  const Config config = make_config(live(), arm());
  State state = initial(config);
  state.robot.v = Eigen::VectorXd::Constant(6, 0.5);
  for (int k = 0; k < 3000; ++k) {
    const Output out = step(config, state, {});
    EXPECT_EQ(out.mode, safety::Mode::Waiting);
    for (int i = 0; i < 6; ++i) ASSERT_LE(std::abs(out.state.tau[i]), config.model.upperEffortLimit[i]);
    if (k == 499) {
      EXPECT_LT(state.robot.v.cwiseAbs().maxCoeff(), 0.01 * 0.5) << "exp(-5) of its speed after 0.5 s";
    }
  }
  const Eigen::VectorXd q = state.robot.q;
  for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(state.robot.v[i]), 1e-6);
  for (int k = 0; k < 1000; ++k) step(config, state, {});
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(state.robot.q[i], q[i], 1e-6);
}

// A shoulder that rests level, 1 m before a mass of 2 kg: without gravity's moment of 2 g it begins to sink; of a speed only
// exp(-t / 0.1 s) is left.
TEST(Hands, HeldByDampingItIsBrakedAndSinks) {
  for (const double gravity : {9.81, 0.0}) {
    Experiment e = live();
    e.safety.hold = "damping";
    e.simulator.q0.value = 0.0;
    e.simulator.v0.value = gravity > 0 ? 0.0 : 1.0;
    rbd::Model model;
    model.addJoint(0, rbd::JointModelRY(), rbd::SE3(), "shoulder");
    model.appendBodyToJoint(1, rbd::Inertia(2, Eigen::Vector3d(1, 0, 0), Eigen::Matrix3d::Identity() * 0.01));
    model.gravity.linear()[2] = -gravity;
    const Config config = make_config(e, model);
    State state = initial(config);
    for (int k = 0; k < 500; ++k) EXPECT_EQ(step(config, state, {}).mode, safety::Mode::Waiting);
    if (gravity > 0)
      EXPECT_GT(state.robot.q[0], 0.1) << "about y, down is positive";
    else
      EXPECT_NEAR(state.robot.v[0], std::exp(-5), 1e-3);
  }
}

// 20 ms by default; never longer than was asked for, and in steps.
TEST(Hands, TheTimeoutIsThatOfTheExperiment) {
  Experiment e = live();
  ASSERT_EQ(e.simulator.dt, 1e-3);
  EXPECT_EQ(make_config(e, arm()).safety.timeout, 20);
  e.simulator.dt = 3e-3;
  EXPECT_EQ(make_config(e, arm()).safety.timeout, 6);
  e.safety.timeout = 0.1;
  e.simulator.dt = 1e-2;
  EXPECT_EQ(make_config(e, arm()).safety.timeout, 10) << "rounding";
}

// Two roads to the effort M (-v / 0.1 s) + nle: here by the mass matrix. Limits are not symmetric.
TEST(Hands, TheHoldingEffortStaysWithinTheEffortLimits) {
  rbd::Model model = arm();
  model.lowerEffortLimit.setConstant(-30);
  model.upperEffortLimit.setConstant(20);
  const Config config = make_config(live(), model);
  rbd::Data data(config.model);
  int below = 0, within = 0, above = 0;
  for (const double speed : {-20.0, 20.0, 0.1}) {
    State state = initial(config);
    state.robot.v.setConstant(speed);
    const Eigen::VectorXd q = state.robot.q, v = state.robot.v;
    const Eigen::VectorXd wanted = rbd::crba(config.model, data, q) * Eigen::VectorXd(-v / 0.1) +
                                   rbd::nonLinearEffects(config.model, data, q, v);
    const Output out = step(config, state, {});
    ASSERT_EQ(out.mode, safety::Mode::Waiting);
    for (int i = 0; i < 6; ++i) {
      (wanted[i] < -30 ? below : wanted[i] > 20 ? above : within)++;
      // rounding: efforts before clamping are below 1e5 Nm
      EXPECT_NEAR(out.state.tau[i], std::min(std::max(wanted[i], -30.0), 20.0), 1e-9) << speed << " " << i;
    }
  }
  EXPECT_TRUE(below > 0 && within > 0 && above > 0) << below << " " << within << " " << above;
}

TEST(Hands, AFloatingBaseHasNothingThatCouldHoldIt) {
  rbd::Model model;
  rbd::buildModels::humanoid(model);
  Experiment e;
  e.simulator.clock = "realtime";
  e.simulator.allow_fall = true;
  const Config config = make_config(e, model);
  State state = initial(config);
  state.robot.v.setConstant(0.3);
  const Output out = step(config, state, {});
  EXPECT_EQ(out.state.tau.head(6), Eigen::VectorXd::Zero(6));
  EXPECT_GT(out.state.tau.tail(model.nv - 6).norm(), 0) << "its joints are held";
}

TEST(Hands, WhateverTheControllerWantsSpeedAndEffortStayInsideTheirLimits) {
  rbd::Model model = arm();
  for (int i = 0; i < 6; ++i) {
    model.upperVelocityLimit[i] = 2;
    model.lowerVelocityLimit[i] = -2;
  }
  const Config config = make_config(live(), model);
  State state = initial(config);
  int holding = 0, running = 0;
  for (int k = 0; k < 5000; ++k) {
    const Command command{.tau = Eigen::VectorXd::Constant(6, k / 700 % 2 ? 1e6 : -1e6), .state_step = k};
    const Output out = step(config, state, {.command = &command});
    ASSERT_FALSE(out.abort);
    (out.mode == safety::Mode::Running ? running : holding)++;
    for (int i = 0; i < 6; ++i) {
      ASSERT_LE(std::abs(out.state.v[i]), 2.0) << "step " << k << " joint " << i;
      ASSERT_LE(std::abs(out.state.tau[i]), model.upperEffortLimit[i]);
    }
  }
  EXPECT_GT(holding, 0) << "the guard had to step in";
  EXPECT_GT(running, 0) << "and let go again";
}

TEST(Hands, InLockstepThereIsNoSpeedGuard) {
  Experiment e = live();
  e.simulator.clock = "lockstep";
  rbd::Model model = arm();
  model.upperVelocityLimit.setConstant(0.1);
  model.lowerVelocityLimit.setConstant(-0.1);
  const Config config = make_config(e, model);
  State state = initial(config);
  const Command command{.tau = Eigen::VectorXd::Constant(6, 5.0)};
  for (int k = 0; k < 200; ++k)
    ASSERT_EQ(step(config, state, {.command = &command}).mode, safety::Mode::Running);
  EXPECT_GT(state.robot.v.cwiseAbs().maxCoeff(), 0.1);
}

TEST(Hands, AnEmergencyStopInLockstepLeavesTheCommandAside) {
  Experiment e = live();
  e.simulator.clock = "lockstep";
  const Config config = make_config(e, arm());
  State state = initial(config);
  const Command command{.tau = Eigen::VectorXd::Constant(6, 5.0)};
  EXPECT_EQ(step(config, state, {.command = &command}).state.tau, command.tau);
  const std::vector<Action> estop{{"estop", "", "", "", {}}}, rearm{{"rearm", "", "", "", {}}};
  EXPECT_EQ(step(config, state, {.command = &command, .actions = estop}).mode, safety::Mode::Stopped);
  EXPECT_NE(step(config, state, {.command = &command}).state.tau, command.tau);
  EXPECT_EQ(step(config, state, {.command = &command, .actions = rearm}).state.tau, command.tau);
}

}  // namespace
}  // namespace lab::simulator
