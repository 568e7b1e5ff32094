#include "procs/simulator/simulator.h"

#include <rbd/algorithm/aba.h>
#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/rnea.h>

#include <cmath>
#include <exception>

#include "core/util/number.h"
#include "lab/experiment/actions.h"
#include "lab/experiment/joints.h"

namespace lab::simulator {
namespace {

constexpr double kMaxSpeed = 1e6;     // rad/s, m/s: beyond it the run has diverged
constexpr double kMaxPosition = 1e9;  // rad, m
constexpr double kBrakeTime = 0.1;    // s: while held, speed falls to 1/e in this time

/// True if the command may be used; an event says why not.
bool accept(const Config& config, const Command& command, std::vector<Event>& events) {
  const Eigen::Index nv = config.model.nv;
  if (command.tau.size() != nv) {
    events.push_back(
        {"command_rejected", "controller",
         "tau has " + std::to_string(command.tau.size()) + " entries, expected " + std::to_string(nv)});
    return false;
  }
  for (Eigen::Index i = 0; i < nv; ++i) {
    if (std::isfinite(command.tau[i])) continue;
    events.push_back({"command_rejected", joint_at(config.model, static_cast<int>(i)), "tau is not finite"});
    return false;
  }
  return true;
}

/// Sets the effort that holds the robot, within its limits: it brakes, and compensates gravity.
void apply_holding_effort(const Config& config, State& s) {
  s.a = -s.robot.v / std::max(kBrakeTime, 2 * config.dt);
  rbd::JointTerms& terms = s.load.model.terms;
  const rbd::JointTerms all = terms;
  terms.damping = terms.friction = false;  // not compensated: they help to brake
  rbd::rnea(s.load.model, s.data, s.robot.q, s.robot.v, s.a, s.applied);
  terms = all;
  if (!config.hold_gravity) s.applied -= rbd::computeGeneralizedGravity(s.load.model, s.data, s.robot.q);
  for (const rbd::JointModel& joint : config.model.joints)
    for (int i = joint.idx_v(); i < joint.idx_v() + joint.nv(); ++i) {
      const bool driven = joint.nv() == 1;
      s.applied[i] = std::clamp(s.applied[i], driven ? config.model.lowerEffortLimit[i] : 0,
                                driven ? config.model.upperEffortLimit[i] : 0);
    }
}

/// The acceleration a at q, v under the applied effort. Damping and friction are in the model.
void accelerate(const Config& config, State& s, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                Eigen::VectorXd& a) {
  s.force = s.applied;
  add_stops(config.disturbances.stops, q, v, s.force);
  rbd::aba(s.load.model, s.data, q, v, s.force, s.wrenches, a);
}

void semi_implicit_euler(const Config& config, State& s) {
  accelerate(config, s, s.robot.q, s.robot.v, s.a);
  s.v = s.robot.v + config.dt * s.a;
  s.twist = config.dt * s.v;
  rbd::integrate(config.model, s.robot.q, s.twist, s.q);
}

// Classic Runge-Kutta on the coordinates x of q = q0 exp(x), with dx/dt to the order that RK4 needs (Munthe-Kaas).
void runge_kutta_4(const Config& config, State& s) {
  constexpr double kAt[4] = {0, 0.5, 0.5, 1};
  for (int i = 0; i < 4; ++i) {
    // the state reached with the previous slope
    if (i == 0) {
      s.q = s.robot.q;
      s.slope_q[0] = s.robot.v;
    } else {
      s.twist = kAt[i] * config.dt * s.slope_q[i - 1];
      rbd::integrate(config.model, s.robot.q, s.twist, s.q);
      s.slope_q[i] = s.robot.v + kAt[i] * config.dt * s.slope_v[i - 1];
    }
    accelerate(config, s, s.q, s.slope_q[i], s.slope_v[i]);
    if (i > 0) rbd::coordinateRate(config.model, s.twist, s.slope_q[i], s.slope_q[i]);
  }
  const double sixth = config.dt / 6;
  s.v = s.robot.v + sixth * (s.slope_v[0] + 2 * s.slope_v[1] + 2 * s.slope_v[2] + s.slope_v[3]);
  s.twist = sixth * (s.slope_q[0] + 2 * s.slope_q[1] + 2 * s.slope_q[2] + s.slope_q[3]);
  rbd::integrate(config.model, s.robot.q, s.twist, s.q);
}

void integrate(const Config& config, State& s) {
  config.integrator == Integrator::RungeKutta4 ? runge_kutta_4(config, s) : semi_implicit_euler(config, s);
}

/// Index in v of the first joint that is beyond its speed limit and becoming faster; -1 if none.
int too_fast(const Config& config, const State& s) {
  const auto outside = [&](int i) {
    return s.v[i] > config.model.upperVelocityLimit[i] || s.v[i] < config.model.lowerVelocityLimit[i];
  };
  for (int i = 0; i < config.model.nv; ++i)
    if (outside(i) && std::abs(s.v[i]) > std::abs(s.robot.v[i])) return i;
  return -1;
}

/// What is wrong with the new q and v; `what` stays empty if nothing is.
Event divergence(const Config& config, const State& s) {
  for (int j = 1; j < config.model.njoints; ++j) {
    const rbd::JointModel& joint = config.model.joints[j];
    for (int i = joint.idx_v(); i < joint.idx_v() + joint.nv(); ++i)
      if (!(std::abs(s.v[i]) <= kMaxSpeed))
        return {"diverged", config.model.names[j], "v " + number(s.v[i]) + ", bound " + number(kMaxSpeed)};
    for (int i = joint.idx_q(); i < joint.idx_q() + joint.nq(); ++i)
      if (!(std::abs(s.q[i]) <= kMaxPosition))
        return {"diverged", config.model.names[j], "q " + number(s.q[i]) + ", bound " + number(kMaxPosition)};
  }
  return {};
}

/// Carries out pushes and payloads; estop and rearm go to `safety_input`.
void take_actions(const Config& config, State& state, std::span<const Action> actions,
                  safety::Input& safety_input, std::vector<Event>& events) {
  for (const Action& action : actions) {
    if (!is_for(action, "simulator")) continue;
    std::string why_not;
    if (action.verb == "estop")
      safety_input.estop = true;
    else if (action.verb == "rearm")
      safety_input.rearm = true;
    else if (action.verb == "push" || action.verb == "payload")
      why_not = take(action, config.model, config.dt, state.load);
    else
      why_not = "the simulator has no such action";
    if (!why_not.empty()) events.push_back(ignored(action, "simulator", why_not));
  }
}

}  // namespace

Config make_config(const Experiment& e, const rbd::Model& model) {
  Config config;
  config.model = model;
  config.dt = e.simulator.dt;
  if (e.simulator.integrator == "rk4") config.integrator = Integrator::RungeKutta4;
  config.q0 = configuration(e, "simulator.q0", e.simulator.q0, model, rbd::neutral(model));
  config.v0 = joint_vector(e, "simulator.v0", e.simulator.v0, model, 0);
  config.model.damping = joint_vector(e, "simulator.damping", e.simulator.damping, model, 0);
  config.model.friction = joint_vector(e, "simulator.friction", e.simulator.friction, model, 0);
  config.model.terms.damping = (config.model.damping.array() != 0).any();
  config.model.terms.friction = (config.model.friction.array() != 0).any();
  if (e.simulator.clock == "realtime") {
    config.safety.timeout = static_cast<int64_t>(std::floor(e.safety.timeout / config.dt + 1e-9));
    if (config.safety.timeout < 2)
      fail(e, "safety.timeout",
           number(e.safety.timeout) + " s, expected at least 2 steps of " + number(config.dt) + " s");
  }
  config.safety.manual = e.safety.rearm == "manual";
  config.hold_gravity = e.safety.hold == "gravity";
  config.sensors = make_sensors(e, model);
  config.disturbances = make_disturbances(e, model);
  const auto& g = e.simulator.gravity;
  if (floats(model) && !e.simulator.allow_fall && (g[0] != 0 || g[1] != 0 || g[2] != 0))
    fail(e, "simulator.allow_fall",
         "'" + model.name +
             "' floats and there is no ground yet: it would fall; set it to true, or simulator.gravity to "
             "[0, 0, 0]");
  return config;
}

State::State(const Config& config)
    : robot{.q = config.q0, .v = config.v0, .tau = {}},
      safety(safety::initial(config.safety)),
      memory(config.sensors, robot),
      load(config.model),
      data(config.model) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(config.model.nv);
  q = robot.q;
  v = robot.v;
  robot.tau = effort = applied = force = a = twist = zero;
  clamped.assign(config.model.nv, false);
  for (int i = 0; i < 4; ++i) slope_q[i] = slope_v[i] = zero;
}

State initial(const Config& config) { return State(config); }

RobotState sensed(const Config& config, const State& state) {
  return sense(config.sensors, state.memory, state.robot);
}

Output step(const Config& config, State& state, const Input& input) {
  Output output;
  begin_step(config.disturbances, config.model, state.robot.step, state.load, output.events);
  safety::Input safety_input{.step = state.robot.step + 1, .command_from = {}};
  take_actions(config, state, input.actions, safety_input, output.events);
  state.wrenches.clear();
  for (const Push& push : state.load.pushes) state.wrenches.push_back(push.wrench);
  if (input.command &&
      safety::fresh(config.safety, state.safety, safety_input.step, input.command->state_step) &&
      accept(config, *input.command, output.events)) {
    safety_input.command_from = input.command->state_step;
    state.effort = input.command->tau;
    clamp_effort(config.model, "effort_clamped", state.effort, state.clamped, output.events);
  }

  output.mode = safety::step(config.safety, state.safety, safety_input, output.events);
  Event fault;
  try {
    if (output.mode == safety::Mode::Running)
      state.applied = state.effort;
    else
      apply_holding_effort(config, state);
    integrate(config, state);
    const bool guarded = config.safety.timeout > 0 && output.mode == safety::Mode::Running;
    if (const int i = guarded ? too_fast(config, state) : -1; i >= 0) {
      safety::trip(
          config.safety, state.safety, joint_at(config.model, i),
          "v would be " + number(state.v[i]) + ", bound " + number(config.model.upperVelocityLimit[i]),
          output.events);
      output.mode = state.safety.mode;
      apply_holding_effort(config, state);
      integrate(config, state);
    }
    fault = divergence(config, state);
  } catch (const std::exception& e) {  // a singular mass matrix, or a state too large to integrate
    fault = {"diverged", "simulator", e.what()};
  }
  end_step(state.load);
  if (!fault.what.empty()) {
    output.events.push_back(fault);
    output.abort = true;
  } else {
    ++state.robot.step;
    state.robot.time = static_cast<double>(state.robot.step) * config.dt;
    state.robot.q = state.q;
    state.robot.v = state.v;
    state.robot.tau = state.applied;
    state.memory.keep(state.robot);
  }
  output.state = sensed(config, state);
  return output;
}

}  // namespace lab::simulator
