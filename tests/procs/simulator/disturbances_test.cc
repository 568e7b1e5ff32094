// Pushes by momentum, payloads by virtual work, soft stops by the pendulum of a spring, and the fold over a log.
#include "procs/simulator/disturbances.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <cmath>
#include <numbers>

#include "procs/simulator/replay.h"
#include "tests/support/refusal.h"

namespace lab::simulator {
namespace {

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

/// A brick that floats, seized off its centre of mass.
rbd::Model brick() {
  rbd::Model model;
  model.addJoint(0, rbd::JointModelFreeFlyer(), rbd::SE3(), "brick");
  model.appendBodyToJoint(1, rbd::Inertia::FromBox(2, 0.3, 0.2, 0.1));
  model.addBodyFrame("handle", 1, rbd::SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.1, 0.05, -0.02)));
  model.gravity = rbd::Motion::Zero();
  return model;
}

TEST(Pushes, ImpulseIsTheChangeOfMomentum) {
  const rbd::Model model = brick();
  Experiment e;
  e.simulator.gravity = {0, 0, 0};
  e.simulator.integrator = "rk4";
  const Eigen::Vector3d f1(3, -2, 5), f2(-1, 4, 0.5), n2(0.1, 0.2, -0.1);
  e.simulator.pushes = {
      {.time = 0.15,
       .duration = 0.1,
       .frame = "handle",
       .force = {f2[0], f2[1], f2[2]},
       .torque = {n2[0], n2[1], n2[2]}},
      {.time = 0.1, .duration = 0.1, .frame = "handle", .force = {f1[0], f1[1], f1[2]}}};  // they overlap
  const Config config = make_config(e, model);
  State state = initial(config);
  rbd::Data data(model);
  Eigen::Vector3d turned = Eigen::Vector3d::Zero();  // impulse of the moment about the world's origin
  std::vector<int64_t> begun;
  for (int k = 0; k < 300; ++k) {
    const auto moment = [&] {  // by hand: arm cross force, by the trapezoidal rule over the step
      rbd::framesForwardKinematics(model, data, state.robot.q);
      const Eigen::Vector3d arm = data.oMf[model.frameId("handle")].translation();
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      if (k >= 100 && k < 200) sum += arm.cross(f1);
      if (k >= 150 && k < 250) sum += arm.cross(f2) + n2;
      return sum;
    };
    turned += 0.5 * 0.001 * moment();
    const Output out = step(config, state, {});
    turned += 0.5 * 0.001 * moment();
    for (const Event& event : out.events) {
      EXPECT_EQ(event.what + " " + event.who, "push handle");
      begun.push_back(out.state.step);
    }

    const double one = 0.001 * std::clamp(k + 1 - 100, 0, 100),
                 two = 0.001 * std::clamp(k + 1 - 150, 0, 100);  // s so far
    rbd::computeCentroidalMomentum(model, data, state.robot.q, state.robot.v);
    const Eigen::Vector3d p = data.hg.linear(), wanted = one * f1 + two * f2;
    // rk4 of a body that turns at 2 rad/s or so: (w dt)^4 of what it has, and rounding
    for (int i = 0; i < 3; ++i) ASSERT_NEAR(p[i], wanted[i], 1e-11) << k;
    const Eigen::Vector3d L = data.hg.angular() + rbd::centerOfMass(model, data, state.robot.q).cross(p);
    for (int i = 0; i < 3; ++i)
      ASSERT_NEAR(L[i], turned[i], 1e-6) << k;  // trapezoids: dt^2 / 12 * |arm''| |f| * T < 1e-7 * 2 * 6
  }
  EXPECT_EQ(begun, (std::vector<int64_t>{101, 151})) << "said with the first state that they have moved";
  EXPECT_TRUE(state.load.pushes.empty());
}

TEST(Payloads, BendAPdByTheirWeightOverTheGain) {
  const rbd::Model model = arm();
  Experiment e;
  const double mass = 2;
  const Eigen::Vector3d com(0.02, -0.03, 0.1);
  e.simulator.payloads = {
      {.time = 0.5, .frame = "effector_body", .mass = mass, .com = {com[0], com[1], com[2]}}};
  const Eigen::VectorXd goal = (Eigen::VectorXd(6) << 0.3, 0.8, -0.5, 0.4, 0.6, 0.2).finished();
  e.simulator.q0.value = std::vector<double>(goal.data(), goal.data() + 6);
  const Config config = make_config(e, model);
  State state = initial(config);
  rbd::Data data(model);
  const double kp = 400, kd = 60;
  int said = 0;
  for (int k = 0; k < 8000; ++k) {
    const Command command{.tau = kp * (goal - state.robot.q) - kd * state.robot.v, .state_step = k};
    for (const Event& event : step(config, state, {.command = &command}).events)
      said += event.what == "payload" && k == 500;
  }
  EXPECT_EQ(said, 1);
  for (int i = 0; i < 6; ++i) ASSERT_LT(std::abs(state.robot.v[i]), 1e-9) << "at rest";
  // by virtual work: g of the bare arm, and J' of the point where the mass hangs, times its weight
  Eigen::VectorXd wanted = rbd::computeGeneralizedGravity(model, data, state.robot.q);
  const rbd::FrameIndex frame = model.frameId("effector_body");
  const rbd::Matrix6Xd J =
      rbd::computeFrameJacobian(model, data, state.robot.q, frame, rbd::LOCAL_WORLD_ALIGNED);
  rbd::framesForwardKinematics(model, data, state.robot.q);
  const Eigen::Vector3d reach = data.oMf[frame].rotation() * com;
  double heaviest = 0;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d turn = J.col(i).head<3>(), point = J.col(i).tail<3>() + turn.cross(reach);
    const double weight = -mass * point.dot(model.gravity.linear());
    heaviest = std::max(heaviest, std::abs(weight));
    EXPECT_NEAR(kp * (goal[i] - state.robot.q[i]), wanted[i] + weight,
                kd * 1e-9 + 1e-6);  // what is left of the motion
  }
  EXPECT_GT(heaviest, 5) << "Nm: it does weigh";
}

TEST(Payloads, TheNewTakesThePlaceOfTheOldAndNothingIsLeft) {
  const rbd::Model model = arm();
  const Config config = make_config(Experiment(), model);
  State state = initial(config);
  const auto put = [&](const std::string& frame, double mass) {
    return step(config, state,
                {.actions = std::vector<Action>{{"payload", frame, "", "", {mass, 0.1, 0, 0}}}})
        .events;
  };
  const rbd::JointIndex joint = model.frames[model.frameId("effector_body")].parentJoint;
  const double bare = model.inertias[joint].mass();
  EXPECT_TRUE(put("effector_body", 3).empty());
  EXPECT_DOUBLE_EQ(state.load.model.inertias[joint].mass(), bare + 3);
  put("effector_body", 1);
  EXPECT_DOUBLE_EQ(state.load.model.inertias[joint].mass(), bare + 1);
  put(model.names[joint], 5);  // another frame of the same joint: both are carried
  EXPECT_DOUBLE_EQ(state.load.model.inertias[joint].mass(), bare + 6);
  put("effector_body", 0);
  put(model.names[joint], 0);
  EXPECT_EQ(state.load.model.inertias[joint].matrix(), model.inertias[joint].matrix()) << "to the last bit";
  EXPECT_EQ(put("elbow", 1)[0].why, "'payload': no frame 'elbow'");
  EXPECT_EQ(put("universe", 1)[0].why,
            "'payload': frame 'universe' stands on the ground; name one that moves");
  EXPECT_EQ(put("effector_body", -1)[0].why,
            "'payload': payload of -1 kg, expected at least 0 and at most 1e+06");
}

/// A wheel with a stop at 1 rad, spinning at it with 1 rad/s from 0.5 rad.
struct Wheel {
  Wheel(double damping, double dt) {
    rbd::JointLimits limits;
    limits.lowerPosition = Eigen::VectorXd::Constant(1, -1);
    limits.upperPosition = Eigen::VectorXd::Constant(1, 1);
    model.addJoint(0, rbd::JointModelRZ(), rbd::SE3(), "wheel", limits);
    model.appendBodyToJoint(1,
                            rbd::Inertia(1, Eigen::Vector3d::Zero(), inertia * Eigen::Matrix3d::Identity()));
    Experiment e;
    e.simulator.dt = dt;
    e.simulator.integrator = "rk4";
    e.simulator.q0.value = 0.5;
    e.simulator.v0.value = 1.0;
    e.simulator.limit_repulsion = {.stiffness = {stiffness}, .damping = {damping}, .margin = {margin}};
    config = make_config(e, model);
  }
  static constexpr double inertia = 0.5, stiffness = 100, margin = 0.1;
  rbd::Model model;
  Config config;
};

TEST(SoftStops, AreASpringThatThrowsTheJointBackBeforeItsLimit) {
  const double dt = 1e-4;
  const Wheel wheel(0, dt);
  State state = initial(wheel.config);
  double deepest = 0;
  int inside = 0;
  for (int k = 0; k < 20000 && (k < 4500 || state.robot.q[0] > 0.85); ++k) {
    step(wheel.config, state, {});
    deepest = std::max(deepest, state.robot.q[0]);
    inside += state.robot.q[0] > 0.9;
  }
  const double w = std::sqrt(Wheel::stiffness / Wheel::inertia);
  EXPECT_LT(deepest, 1) << "never at the hard limit";
  // where the spring sets in its slope has a kink: rk4 is off there by (w dt)^2 of the speed at most, twice
  EXPECT_NEAR(deepest, 0.9 + 1 / w, 2 * w * dt * dt) << "v / w, from energy";
  EXPECT_NEAR(state.robot.v[0], -1, 2 * w * w * dt * dt) << "all of it comes back";
  EXPECT_NEAR(inside * dt, std::numbers::pi / w, 2 * dt) << "half a period";
}

TEST(SoftStops, DampingTakesEnergyAndTheAccountSaysHowMuch) {
  const auto drift_of = [](double dt) {
    const Wheel wheel(20, dt);
    State state = initial(wheel.config);
    std::vector<RobotState> states{state.robot};
    while (state.robot.time < 1) states.push_back(step(wheel.config, state, {}).state);
    ExternalEnergy account(wheel.config);
    double given = 0, drift = 0;
    for (const RobotState& at : states) {
      const auto external = account.next(at, {});
      given += external.work;
      const double energy = 0.5 * Wheel::inertia * at.v[0] * at.v[0] + external.stored;
      drift = std::max(drift, std::abs(energy - 0.5 * Wheel::inertia - given));
    }
    EXPECT_LT(given, -0.01) << "J";
    EXPECT_LT(state.robot.v[0], 0);
    return drift;
  };
  const double coarse = drift_of(4e-4), fine = drift_of(1e-4);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_LT(fine, coarse / 3) << "it is the step's error, not a wrong account";
}

std::string refusal(const Experiment& e, const rbd::Model& model) {
  return test::refusal_of([&] { make_config(e, model); });
}

TEST(Disturbances, SayWhatIsWrongWithThem) {
  const rbd::Model model = arm();
  const auto with_push = [&](const PlannedPush& push) {
    Experiment e;
    e.file = "x.yaml";
    e.simulator.pushes = {{.time = 0, .duration = 1, .frame = "effector_body"}, push};
    return refusal(e, model);
  };
  EXPECT_EQ(with_push({.time = 1, .duration = 1, .frame = "efector_body"}),
            "x.yaml: simulator.pushes[1].frame: no frame 'efector_body'; did you mean 'effector_body'?");
  EXPECT_EQ(with_push({.time = 1, .duration = 1, .frame = "universe"}),
            "x.yaml: simulator.pushes[1].frame: frame 'universe' stands on the ground; name one that moves");
  EXPECT_EQ(with_push({.time = 1, .duration = 1e-4, .frame = "effector_body"}),
            "x.yaml: simulator.pushes[1].duration: 1e-04 s is less than one step of 0.001 s");
  Experiment e;
  e.file = "x.yaml";
  e.simulator.payloads = {{.time = 0, .frame = "hand", .mass = 1}};
  EXPECT_EQ(refusal(e, model), "x.yaml: simulator.payloads[0].frame: no frame 'hand'");
  e.simulator.payloads.clear();
  e.simulator.limit_repulsion.damping.value = 1.0;
  EXPECT_EQ(refusal(e, model), "x.yaml: simulator.limit_repulsion.damping: joint '" + model.names[1] +
                                   "' has a damper but no spring; give stiffness too");
  e.simulator.limit_repulsion.stiffness.value = 10.0;
  e.simulator.limit_repulsion.margin.value = 0.0;
  EXPECT_EQ(refusal(e, model), "x.yaml: simulator.limit_repulsion.margin: is 0 for joint '" + model.names[1] +
                                   "'; the spring needs some distance, for example 0.1");
  e.simulator.limit_repulsion.margin.value = 50.0;
  EXPECT_NE(refusal(e, model).find("50 is more than half of the way that joint"), std::string::npos);
}

// ---- the fold

/// Commands and people's wishes of every kind by the step that they lead to, and what the simulator said to them.
struct Recorded {
  std::map<int64_t, Command> commands;
  std::map<int64_t, std::vector<Action>> actions;
  std::vector<RobotState> logged, truth;
};

std::vector<RobotState> true_states(const Config& config, const Recorded& run) {
  TrueStates truth(config);
  std::vector<RobotState> out;
  for (const RobotState& logged : run.logged) {
    const auto command = run.commands.find(logged.step);
    const auto actions = run.actions.find(logged.step);
    out.push_back(truth.next(logged, command == run.commands.end() ? nullptr : &command->second,
                             actions == run.actions.end() ? std::vector<Action>() : actions->second));
  }
  return out;
}

Recorded record(const Config& config) {
  Recorded out;
  State state = initial(config);
  out.logged.push_back(sensed(config, state));
  out.truth.push_back(state.robot);
  out.actions = {
      {50, {{"push", "effector_body", "", "", {0, 0, 1, 5, 0, 0, 0.1}}}},
      {120, {{"payload", "effector_body", "", "", {1.5, 0, 0, 0.1}}, {"set", "controller", "kp", "", {1}}}},
      {200, {{"estop", "", "", "", {}}}},
      {260, {{"rearm", "", "", "", {}}}}};
  for (int64_t k = 1; k <= 400; ++k) {
    if (k % 2 == 1)
      out.commands[k] = {
          .tau = 20 * (Eigen::VectorXd::Constant(6, 0.2) - out.logged.back().q) - out.logged.back().v,
          .state_step = k - 1};
    Input input;
    if (const auto command = out.commands.find(k); command != out.commands.end())
      input.command = &command->second;
    if (const auto actions = out.actions.find(k); actions != out.actions.end())
      input.actions = actions->second;
    const Output output = step(config, state, input);
    EXPECT_FALSE(output.abort);
    out.logged.push_back(output.state);
    out.truth.push_back(state.robot);
  }
  return out;
}

TEST(Fold, GivesTheTrueStatesBackBitForBit) {
  Experiment e;
  e.simulator.pushes = {{.time = 0.1, .duration = 0.05, .frame = "effector_body", .force = {10, 0, 0}}};
  e.simulator.limit_repulsion.stiffness.value = 50.0;
  for (const bool noisy : {false, true}) {
    if (noisy) {
      e.simulator.noise.q.value = 1e-3;
      e.simulator.noise.v.value = 0.01;
      e.simulator.delay = 0.004;
      e.seed = 3;
    }
    const Config config = make_config(e, arm());
    const Recorded run = record(config);
    const std::vector<RobotState> folded = true_states(config, run);
    ASSERT_EQ(folded.size(), run.truth.size());
    for (size_t k = 0; k < folded.size(); ++k) {
      ASSERT_EQ(folded[k].q, run.truth[k].q) << k;
      ASSERT_EQ(folded[k].v, run.truth[k].v) << k;
      ASSERT_EQ(folded[k].q == run.logged[k].q, !noisy) << k;
    }
  }
}

TEST(Fold, FindsTheStepThatDoesNotFollow) {
  Experiment e;
  e.simulator.noise.q.value = 1e-3;
  const Config config = make_config(e, arm());
  const Recorded run = record(config);
  const auto complaint = [&](const Recorded& changed) {
    try {
      true_states(config, changed);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(complaint(run), "none");
  Recorded changed = run;
  double& tau = changed.commands[101].tau[2];
  tau = std::nextafter(tau, 1e9);
  EXPECT_NE(complaint(changed).find("at step 101 "), std::string::npos) << complaint(changed);
  changed = run;
  changed.logged[77].v[5] = std::nextafter(changed.logged[77].v[5], 1e9);
  EXPECT_NE(complaint(changed).find("at step 77 v[5] is "), std::string::npos) << complaint(changed);
  changed = run;
  changed.actions.erase(120);
  EXPECT_NE(complaint(changed).find("at step 120 "), std::string::npos) << complaint(changed);
  changed = run;
  changed.logged.erase(changed.logged.begin() + 10);
  EXPECT_EQ(complaint(changed), "step 10 is not in the log; the true states need every step");
}

}  // namespace
}  // namespace lab::simulator
