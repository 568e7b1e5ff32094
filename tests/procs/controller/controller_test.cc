// The controllers against what theory says of them: steady error, error dynamics, cancelled gravity.
#include "procs/controller/controller.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

#include "procs/simulator/simulator.h"

namespace lab::controller {
namespace {

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

Experiment with(const std::string& kind, double kp, double kd) {
  Experiment e;
  e.controller.kind = kind;
  e.controller.kp.value = kp;
  e.controller.kd.value = kd;
  return e;
}

RobotState somewhere(int nv) {
  RobotState s;
  s.q = Eigen::VectorXd::LinSpaced(nv, -0.6, 0.8);
  s.v = Eigen::VectorXd::LinSpaced(nv, 0.9, -0.5);
  s.tau = Eigen::VectorXd::Zero(nv);
  return s;
}

Reference elsewhere(int nv) {
  Reference r;
  r.q = Eigen::VectorXd::LinSpaced(nv, 0.2, -0.3);
  r.v = Eigen::VectorXd::LinSpaced(nv, -0.4, 0.1);
  r.a = Eigen::VectorXd::LinSpaced(nv, 1, 2);
  return r;
}

Eigen::VectorXd tau_of(const Experiment& e, const rbd::Model& model, const RobotState& s,
                       const Reference& r) {
  const Config config = make_config(e, model);
  State state = initial(config);
  return step(config, state, {.state = s, .reference = r}).command.tau;
}

TEST(Controller, LawsByHand) {
  const rbd::Model model = arm();
  const RobotState s = somewhere(6);
  const Reference r = elsewhere(6);
  rbd::Data data(model);
  const Eigen::VectorXd g = rbd::computeGeneralizedGravity(model, data, s.q);
  const Eigen::VectorXd none = tau_of(with("none", 50, 10), model, s, r),
                        pd = tau_of(with("pd", 50, 10), model, s, r),
                        pdg = tau_of(with("pd_gravity", 50, 10), model, s, r);
  for (int i = 0; i < 6; ++i) {
    const double by_hand = 50 * (r.q[i] - s.q[i]) + 10 * (r.v[i] - s.v[i]);
    EXPECT_EQ(none[i], 0);
    EXPECT_NEAR(pd[i], by_hand, 1e-12);
    EXPECT_NEAR(pdg[i], by_hand + g[i], 1e-12);
  }
}

// what comes out of forward dynamics is the acceleration that the law asked for
TEST(Controller, ComputedTorqueMakesTheErrorLinear) {
  const rbd::Model model = arm();
  const RobotState s = somewhere(6);
  const Reference r = elsewhere(6);
  rbd::Data data(model);
  const Eigen::VectorXd a =
      rbd::aba(model, data, s.q, s.v, tau_of(with("computed_torque", 100, 20), model, s, r));
  for (int i = 0; i < 6; ++i)  // e'' + kd e' + kp e = 0; rounding of aba: eps cond(M) |a| < 1e-10
    EXPECT_NEAR(r.a[i] - a[i] + 20 * (r.v[i] - s.v[i]) + 100 * (r.q[i] - s.q[i]), 0, 1e-9);
}

TEST(Controller, ComputedTorqueErrorsDieAsTheFormulaSays) {
  const rbd::Model model = arm();
  Experiment e = with("computed_torque", 100, 20);
  e.simulator.dt = 1e-4;
  e.simulator.q0.value = std::vector<double>{0.1, -0.1, 0.2, 0.1, -0.2, 0.1};
  const simulator::Config plant = simulator::make_config(e, model);
  simulator::State body = simulator::initial(plant);
  const Config config = make_config(e, model);
  State state = initial(config);
  Reference r;
  r.q = r.v = r.a = Eigen::VectorXd::Zero(6);
  for (int k = 1; k <= 3000; ++k) {
    const Command command = step(config, state, {.state = body.robot, .reference = r}).command;
    simulator::step(plant, body, {.command = &command});
    const double t = k * 1e-4,
                 decay = (1 + 10 * t) * std::exp(-10 * t);  // critically damped, at rest at first
    // first-order integrator: error of order dt * kd of the initial error, far below one percent of it
    for (int i = 0; i < 6; ++i)
      ASSERT_NEAR(body.robot.q[i], plant.q0[i] * decay, 0.01 * std::abs(plant.q0[i]));
  }
}

// the core refuses numbers that overflow by an exception; a step never throws, and what is not finite is never sent
TEST(Controller, NumbersTooLargeGiveNoFiniteEffort) {
  const rbd::Model model = arm();
  EXPECT_FALSE(tau_of(with("computed_torque", 1.7e308, 20), model, somewhere(6), elsewhere(6)).allFinite());
}

TEST(Controller, PlainPdSagsByGravityOverKp) {
  const rbd::Model model = arm();
  Experiment e = with("pd", 200, 60);
  const simulator::Config plant = simulator::make_config(e, model);
  simulator::State body = simulator::initial(plant);
  const Config config = make_config(e, model);
  State state = initial(config);
  Reference r;
  r.q = r.v = r.a = Eigen::VectorXd::Zero(6);
  for (int k = 0; k < 20000; ++k) {
    const Command command = step(config, state, {.state = body.robot, .reference = r}).command;
    ASSERT_FALSE(simulator::step(plant, body, {.command = &command}).abort);
  }
  rbd::Data data(model);
  const Eigen::VectorXd g = rbd::computeGeneralizedGravity(model, data, body.robot.q);
  double sag = 0;
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(-body.robot.q[i], g[i] / 200, 1e-6) << i;  // e = g(q) / kp, once it has come to rest (20 s)
    sag = std::max(sag, std::abs(body.robot.q[i]));
  }
  EXPECT_GT(sag, 0.05);
}

TEST(Controller, BelievesInItsOwnModel) {
  const rbd::Model model = arm();
  const RobotState s = somewhere(6);
  Reference r = elsewhere(6);
  r.q = s.q;
  r.v = s.v;
  Experiment e = with("pd_gravity", 10, 1);
  const Eigen::VectorXd right = tau_of(e, model, s, r);
  e.controller.model.mass_scale = 1.5;
  const Eigen::VectorXd wrong = tau_of(e, model, s, r);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(wrong[i], 1.5 * right[i], 1e-12 * (1 + std::abs(right[i])));
}

TEST(Controller, GainsCanBeSetWhileItRuns) {
  const rbd::Model model = arm();
  const Config config = make_config(with("pd", 50, 0), model);
  State state = initial(config);
  const RobotState s = somewhere(6);
  const Reference r = elsewhere(6);
  const auto act = [&](const Action& action) {
    const std::vector<Action> actions{action};
    return step(config, state, {.state = s, .reference = r, .actions = actions});
  };
  Output out = act({"set", "controller", "kp", "", {80}});
  EXPECT_TRUE(out.events.empty());
  EXPECT_NEAR(out.command.tau[2], 80 * (r.q[2] - s.q[2]), 1e-12);
  out = act({"set", "controller", "kp", "", {1, 2, 3, 4, 5, 6}});
  EXPECT_NEAR(out.command.tau[2], 3 * (r.q[2] - s.q[2]), 1e-12);
  const std::pair<Action, const char*> refused[] = {
      {{"set", "controller", "ki", "", {1}},
       "'set ki': the controller has no 'ki' to set; did you mean 'kp'? (it has kp, kd, stiffness, damping, "
       "com_gain)"},
      {{"set", "controller", "kp", "", {1, 2}}, "'set kp': kp has 2 values, expected 1 or 6"},
      {{"set", "controller", "kd", "", {-1}}, "'set kd': kd is -1, must be finite and at least 0"},
      {{"set", "controller", "kd", "", {NAN}}, "'set kd': kd is nan, must be finite and at least 0"},
      {{"dance", "controller", "", "", {}}, "'dance': the controller has no such action"},
  };
  for (const auto& [action, why] : refused) {
    out = act(action);
    ASSERT_EQ(out.events.size(), 1u);
    EXPECT_EQ(out.events[0].what, "action_ignored");
    EXPECT_EQ(out.events[0].why, why);
    EXPECT_NEAR(out.command.tau[2], 3 * (r.q[2] - s.q[2]), 1e-12);  // as before
  }
  EXPECT_TRUE(act({"push", "elbow", "", "", {}}).events.empty());  // not for the controller
}

TEST(Controller, NothingDrivesAFloatingBase) {
  rbd::Model model;
  rbd::buildModels::humanoid(model);
  RobotState s;
  s.q = rbd::neutral(model);
  s.v = Eigen::VectorXd::Constant(model.nv, 0.1);
  Reference r{
      .step = 0, .q = s.q, .v = Eigen::VectorXd::Zero(model.nv), .a = Eigen::VectorXd::Ones(model.nv)};
  r.q[2] += 1;
  for (const char* kind : {"pd", "pd_gravity", "computed_torque"}) {
    const Eigen::VectorXd tau = tau_of(with(kind, 10, 1), model, s, r);
    for (int i = 0; i < 6; ++i) EXPECT_EQ(tau[i], 0) << kind;
    double rest = 0;
    for (int i = 6; i < model.nv; ++i) rest += std::abs(tau[i]);
    EXPECT_GT(rest, 0) << kind;
  }
}

TEST(Controller, CutsItsCommandAtTheLimitsAndSaysSoOnce) {
  const rbd::Model model = arm();  // 300 Nm, from the fourth joint on 150
  Experiment e = with("pd", 1000, 0);
  const RobotState s = somewhere(6);
  Reference r = elsewhere(6);
  const Eigen::VectorXd wanted = tau_of(e, model, s, r);
  e.controller.limit_effort = true;
  const Config config = make_config(e, model);
  State state = initial(config);
  const Output first = step(config, state, {.state = s, .reference = r});
  std::vector<std::string> cut;
  for (int i = 0; i < 6; ++i) {
    const double most = i < 3 ? 300 : 150;
    EXPECT_EQ(first.command.tau[i], std::clamp(wanted[i], -most, most));
    if (std::abs(wanted[i]) > most) cut.push_back(model.names[i + 1]);
  }
  ASSERT_FALSE(cut.empty());
  ASSERT_LT(cut.size(), 6u);
  ASSERT_EQ(first.events.size(), cut.size());
  for (size_t i = 0; i < cut.size(); ++i) {
    EXPECT_EQ(first.events[i].what, "effort_limited");
    EXPECT_EQ(first.events[i].who, cut[i]);
  }
  EXPECT_EQ(first.events[0].why, "value 800, bound 300");
  EXPECT_TRUE(step(config, state, {.state = s, .reference = r}).events.empty());  // still
  r.q = s.q;
  EXPECT_TRUE(step(config, state, {.state = s, .reference = r}).events.empty());  // over
  r = elsewhere(6);
  EXPECT_EQ(step(config, state, {.state = s, .reference = r}).events.size(), cut.size());  // again
}

// a row of one's own, with a memory: its third command knows the two errors before
TEST(Controller, TakesKindsOfTheCallers) {
  const Kind mine[] = {
      {"sum", "tau = kp (sum of e)", [](const Config& c, State& s, const Input&, Eigen::VectorXd& tau) {
         s.memory += c.period * s.e;
         tau = s.gains.kp.cwiseProduct(s.memory);
       }}};
  const rbd::Model model = arm();
  Experiment e = with("sum", 10, 0);
  e.simulator.dt = 0.002;
  e.controller.every = 5;
  const Config config = make_config(e, model, mine);
  State state = initial(config);
  const RobotState s = somewhere(6);
  const Reference r = elsewhere(6);
  Eigen::VectorXd tau;
  for (int k = 0; k < 3; ++k) tau = step(config, state, {.state = s, .reference = r}).command.tau;
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(tau[i], 10 * 3 * 0.01 * (r.q[i] - s.q[i]), 1e-14);
  EXPECT_THROW(make_config(e, model), ExperimentError);
}

TEST(Controller, UnknownKindNamesTheKnownOnes) {
  Experiment e = with("pid", 1, 1);
  e.file = "x.yaml";
  try {
    make_config(e, arm());
    ADD_FAILURE();
  } catch (const ExperimentError& error) {
    EXPECT_STREQ(
        error.what(),
        "x.yaml: controller.kind: 'pid' is not known; use one of none, pd, pd_gravity, computed_torque, "
        "cartesian_impedance, com_velocity");
  }
}

}  // namespace
}  // namespace lab::controller
