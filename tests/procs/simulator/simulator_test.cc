// The simulator's step against textbook mechanics: crba + LDLT, energy, orders of convergence, free fall.
#include "procs/simulator/simulator.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstring>
#include <random>

#include "core/util/number.h"

namespace lab::simulator {
namespace {

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

Experiment swing(const std::string& integrator, double dt) {
  Experiment e;
  e.simulator.integrator = integrator;
  e.simulator.dt = dt;
  e.simulator.q0.value = std::vector<double>{0.3, 0.8, -0.5, 0.4, 0.6, 0.2};
  return e;
}

/// The state after `steps` steps without any command.
RobotState coast(const Config& config, int steps) {
  State state = initial(config);
  for (int k = 0; k < steps; ++k) EXPECT_FALSE(step(config, state, {}).abort);
  return state.robot;
}

TEST(Simulator, OneStepIsTheHandbooks) {
  const rbd::Model model = arm();
  Experiment e = swing("semi_implicit_euler", 0.01);
  e.simulator.v0.value = std::vector<double>{0.5, -1, 2, 0.3, -0.7, 1};
  e.simulator.damping.value = 0.4;
  const Config config = make_config(e, model);
  State state = initial(config);
  const Command command{.tau = (Eigen::VectorXd(6) << 3, -20, 10, 1, 0.5, -0.2).finished()};
  const Output out = step(config, state, {.command = &command});

  rbd::Data data(model);
  const Eigen::MatrixXd M = rbd::crba(model, data, config.q0);
  const Eigen::VectorXd nle = rbd::nonLinearEffects(model, data, config.q0, config.v0);
  const Eigen::VectorXd a = M.ldlt().solve(Eigen::VectorXd(command.tau - 0.4 * config.v0 - nle));
  const Eigen::VectorXd v = config.v0 + 0.01 * a, q = config.q0 + 0.01 * v;
  // two ways to the same a: they differ by eps * cond(M) * |a|, cond(M) < 1e3, |a| < 1e3
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(out.state.v[i], v[i], 1e-11);
    EXPECT_NEAR(out.state.q[i], q[i], 1e-12);
  }
  EXPECT_EQ(out.state.tau, command.tau);
  EXPECT_EQ(out.state.step, 1);
  EXPECT_EQ(out.state.time, 0.01);
  EXPECT_TRUE(out.events.empty());
}

double error_after(const Experiment& e, const rbd::Model& model, const RobotState& exact, double time) {
  const Config config = make_config(e, model);
  const RobotState end = coast(config, static_cast<int>(std::lround(time / e.simulator.dt)));
  const Eigen::VectorXd dq = rbd::difference(model, exact.q, end.q), dv = end.v - exact.v;
  double worst = 0;
  for (int i = 0; i < model.nv; ++i) worst = std::max({worst, std::abs(dq[i]), std::abs(dv[i])});
  return worst;
}

TEST(Simulator, RungeKuttaIsOfFourthOrderAndEulerOfFirst) {
  const rbd::Model model = arm();
  const double time = 0.4;
  const RobotState exact = coast(make_config(swing("rk4", 0.0005), model), 800);
  const double coarse = error_after(swing("rk4", 0.008), model, exact, time);
  const double fine = error_after(swing("rk4", 0.004), model, exact, time);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.3) << coarse << " " << fine;
  const double euler = error_after(swing("semi_implicit_euler", 0.002), model, exact, time);
  const double euler_fine = error_after(swing("semi_implicit_euler", 0.001), model, exact, time);
  EXPECT_NEAR(std::log2(euler / euler_fine), 1, 0.2) << euler << " " << euler_fine;
}

TEST(Simulator, RungeKuttaIsOfFourthOrderForATumblingHumanoidToo) {
  rbd::Model model;
  rbd::buildModels::humanoid(model);
  model.gravity.linear().setZero();
  Experiment e;
  e.simulator.gravity = {0, 0, 0};
  e.simulator.integrator = "rk4";
  std::vector<double> v0(model.nv);
  std::mt19937 random(1);
  for (double& v : v0) v = std::uniform_real_distribution<double>(-2, 2)(random);
  e.simulator.v0.value = v0;
  const auto with = [&](double dt) {
    Experiment f = e;
    f.simulator.dt = dt;
    return f;
  };
  const RobotState exact = coast(make_config(with(0.00025), model), 800);
  const double coarse = error_after(with(0.004), model, exact, 0.2),
               fine = error_after(with(0.002), model, exact, 0.2);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.4) << coarse << " " << fine;
}

TEST(Simulator, AFreeSwingKeepsItsEnergy) {
  const rbd::Model model = arm();
  const Config config = make_config(swing("rk4", 0.001), model);
  State state = initial(config);
  rbd::Data data(model);
  const auto kinetic = [&] { return rbd::computeKineticEnergy(model, data, state.robot.q, state.robot.v); };
  const auto total = [&] { return kinetic() + rbd::computePotentialEnergy(model, data, state.robot.q); };
  const double start = total();
  double fastest = 0, drift = 0;
  for (int k = 0; k < 10000; ++k) {
    step(config, state, {});
    fastest = std::max(fastest, kinetic());
    drift = std::max(drift, std::abs(total() - start));
  }
  EXPECT_GT(fastest, 10);  // J: it does swing
  EXPECT_LT(drift / fastest, 1e-9);
}

TEST(Simulator, EffortIsClampedAndSaidOnce) {
  const rbd::Model model = arm();
  const Config config = make_config(Experiment(), model);
  State state = initial(config);
  const double bound = model.upperEffortLimit[1];
  ASSERT_TRUE(std::isfinite(bound));
  Command command{.tau = Eigen::VectorXd::Zero(6)};
  command.tau[1] = -2 * bound;
  Output out = step(config, state, {.command = &command});
  ASSERT_EQ(out.events.size(), 1u);
  EXPECT_EQ(out.events[0].what, "effort_clamped");
  EXPECT_EQ(out.events[0].who, model.names[2]);
  EXPECT_EQ(out.events[0].why, "value " + number(-2 * bound) + ", bound " + number(-bound));
  EXPECT_EQ(out.state.tau[1], -bound);

  out = step(config, state, {});  // held, still clamped
  EXPECT_TRUE(out.events.empty());
  EXPECT_EQ(out.state.tau[1], -bound);
  command.tau[1] = bound;  // the bound itself is allowed
  out = step(config, state, {.command = &command});
  EXPECT_TRUE(out.events.empty());
  EXPECT_EQ(out.state.tau[1], bound);
  command.tau[1] = 1.5 * bound;
  EXPECT_EQ(step(config, state, {.command = &command}).events.size(), 1u);
}

TEST(Simulator, ABadCommandIsRefusedAndTheLastHeld) {
  const Config config = make_config(Experiment(), arm());
  State state = initial(config);
  const Command good{.tau = Eigen::VectorXd::Constant(6, 1)};
  step(config, state, {.command = &good});
  Command bad{.tau = Eigen::VectorXd::Constant(6, 2)};
  bad.tau[3] = NAN;
  Output out = step(config, state, {.command = &bad});
  ASSERT_EQ(out.events.size(), 1u);
  EXPECT_EQ(out.events[0].what, "command_rejected");
  EXPECT_EQ(out.events[0].who, config.model.names[4]);
  EXPECT_EQ(out.state.tau, good.tau);
  bad.tau = Eigen::VectorXd::Zero(5);
  out = step(config, state, {.command = &bad});
  ASSERT_EQ(out.events.size(), 1u);
  EXPECT_EQ(out.events[0].why, "tau has 5 entries, expected 6");
  EXPECT_EQ(out.state.tau, good.tau);
}

TEST(Simulator, DivergenceAbortsAndNothingWildIsGivenOut) {
  rbd::Model model = arm();
  model.upperEffortLimit.setConstant(INFINITY);
  model.lowerEffortLimit.setConstant(-INFINITY);
  for (double wild : {1e12, 1e300}) {
    const Config config = make_config(Experiment(), model);
    State state = initial(config);
    const Command command{.tau = Eigen::VectorXd::Constant(6, wild)};
    Output out;
    for (int k = 0; k < 10 && !out.abort; ++k) out = step(config, state, {.command = &command});
    ASSERT_TRUE(out.abort);
    EXPECT_EQ(out.events.back().what, "diverged");
    EXPECT_TRUE(out.state.q.allFinite() && out.state.v.allFinite());
    EXPECT_EQ(out.state.step, state.robot.step);
  }
}

TEST(Simulator, ASingularRobotAbortsWithAReason) {
  rbd::Model model;
  model.addJoint(0, rbd::JointModelRZ(), rbd::SE3(), "empty");
  const Config config = make_config(Experiment(), model);
  State state = initial(config);
  const Output out = step(config, state, {});
  ASSERT_TRUE(out.abort);
  EXPECT_NE(out.events.back().why.find("empty"), std::string::npos) << out.events.back().why;
}

TEST(Simulator, AFloatingRobotFallsOnlyWhenAllowed) {
  rbd::Model model;
  rbd::buildModels::humanoid(model);
  Experiment e;
  EXPECT_THROW(make_config(e, model), ExperimentError);
  e.simulator.allow_fall = true;
  e.simulator.integrator = "rk4";
  const Config config = make_config(e, model);
  State state = initial(config);
  Command command{.tau = Eigen::VectorXd::Zero(model.nv)};
  command.tau[5] = 1000;  // nothing can push the base
  const Output out = step(config, state, {.command = &command});
  ASSERT_EQ(out.events.size(), 1u);
  EXPECT_EQ(out.events[0].what, "base_effort_ignored");
  EXPECT_EQ(out.state.tau[5], 0);
  for (int k = 1; k < 500; ++k) step(config, state, {});
  // Galileo: half a second of free fall, nothing else moves; rounding of 500 steps
  EXPECT_NEAR(state.robot.q[2], -0.5 * 9.81 * 0.25, 1e-10);
  EXPECT_NEAR(state.robot.v[5], -9.81 * 0.5, 1e-10);
  for (int i = 7; i < model.nq; ++i) EXPECT_NEAR(state.robot.q[i], 0, 1e-9);
}

TEST(Simulator, UnknownActionsAreSaid) {
  const Config config = make_config(Experiment(), arm());
  State state = initial(config);
  const std::vector<Action> actions{
      {"push", "elbow", "", "", {}}, {"set", "controller", "kp", "", {1}}, {"goal", "", "", "", {}}};
  const Output out = step(config, state, {.actions = actions});
  ASSERT_EQ(out.events.size(), 1u);  // the others are for the controller and the planner
  EXPECT_EQ(out.events[0].what, "action_ignored");
  EXPECT_EQ(out.events[0].why, "'push': no frame 'elbow'");
}

TEST(Simulator, SameInputSameBytes) {
  const Config config = make_config(swing("rk4", 0.002), arm());
  State one = initial(config), other = initial(config);
  for (int k = 0; k < 200; ++k) {
    const Command command{.tau = Eigen::VectorXd::Constant(6, std::sin(k))};
    step(config, one, {.command = &command});
    State copy = other;  // what is copied in the middle of a run goes on the same
    step(config, copy, {.command = &command});
    other = copy;
    ASSERT_EQ(std::memcmp(one.robot.q.data(), other.robot.q.data(), 6 * sizeof(double)), 0);
    ASSERT_EQ(std::memcmp(one.robot.v.data(), other.robot.v.data(), 6 * sizeof(double)), 0);
  }
}

// A slider without limits: 100 m a step pass 1e9 m in the third, and 4e8 N on 1 kg give 4e5 m/s a step, which pass 1e6 m/s in the third.
TEST(Simulator, BeyondThePositionOrTheSpeedOfARobotItHasDiverged) {
  rbd::Model model;
  model.addJoint(0, rbd::JointModelPX(), rbd::SE3(), "slider");
  model.appendBodyToJoint(1, rbd::Inertia::FromSphere(1, 0.1));
  model.upperEffortLimit.setConstant(INFINITY);
  model.lowerEffortLimit.setConstant(-INFINITY);
  for (const bool by_speed : {false, true})
    for (const double side : {-1.0, 1.0}) {
      Experiment e;
      e.simulator.q0.value = by_speed ? 0 : side * (1e9 - 250);
      e.simulator.v0.value = by_speed ? 0 : side * 1e5;
      const Config config = make_config(e, model);
      State state = initial(config);
      const Command command{.tau = Eigen::VectorXd::Constant(1, by_speed ? side * 4e8 : 0)};
      for (int k = 0; k < 2; ++k) ASSERT_FALSE(step(config, state, {.command = &command}).abort);
      const Eigen::VectorXd last = state.robot.q;
      const Output out = step(config, state, {.command = &command});
      ASSERT_TRUE(out.abort);
      EXPECT_EQ(out.events.back().who, "slider");
      const std::string why = out.events.back().why;
      EXPECT_EQ(why.substr(0, 2), by_speed ? "v " : "q ") << why;
      EXPECT_TRUE(why.ends_with(by_speed ? ", bound 1e+06" : ", bound 1e+09")) << why;
      EXPECT_EQ(out.state.q, last);
    }
}

}  // namespace
}  // namespace lab::simulator
