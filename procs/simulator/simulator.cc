#include "procs/simulator/simulator.h"

#include <rbd/algorithm/aba.h>
#include <rbd/algorithm/configuration.h>

#include <cmath>
#include <exception>

#include "procs/experiment/actions.h"
#include "procs/experiment/joints.h"

namespace lab::simulator {
namespace {

constexpr double kRunaway = 1e6;  // rad/s, m/s: no robot is that fast
constexpr double kFarAway = 1e9;  // rad, m

/// True if the command may be used; an event says why not.
bool accept(const Config& config, const Command& command, std::vector<Event>& events) {
  const Eigen::Index nv = config.model.nv;
  if (command.tau.size() != nv) {
    events.push_back(
        {"command_rejected", "controller",
         "tau has " + std::to_string(command.tau.size()) + " entries, needed " + std::to_string(nv)});
    return false;
  }
  for (Eigen::Index i = 0; i < nv; ++i) {
    if (std::isfinite(command.tau[i])) continue;
    events.push_back({"command_rejected", joint_at(config.model, static_cast<int>(i)), "tau is not finite"});
    return false;
  }
  return true;
}

/// Takes the command in force, within the effort limits.
void limit(const Config& config, State& state, const Command& command, std::vector<Event>& events) {
  for (int j = 1; j < config.model.njoints; ++j) {
    const rbd::JointModel& joint = config.model.joints[j];
    const bool driven = joint.nv() == 1;  // nothing drives a floating base
    for (int i = joint.idx_v(); i < joint.idx_v() + joint.nv(); ++i) {
      const double bound = driven ? config.model.effortLimit[i] : 0, wanted = command.tau[i];
      const bool clamp = std::abs(wanted) > bound;
      state.effort[i] = clamp ? std::copysign(bound, wanted) : wanted;
      if (clamp && !state.clamped[i])
        events.push_back({driven ? "effort_clamped" : "base_effort_ignored", config.model.names[j],
                          "value " + number(wanted) + ", bound " + number(bound)});
      state.clamped[i] = clamp;
    }
  }
}

/// a for the effort in force at q, v.
void accelerate(const Config& config, State& s, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                Eigen::VectorXd& a) {
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    s.force[i] = s.effort[i] - config.damping[i] * v[i];
    if (config.friction[i] > 0) s.force[i] -= config.friction[i] * std::tanh(v[i] / kSlipSpeed);
  }
  rbd::aba(config.model, s.data, q, v, s.force, a);
}

void semi_implicit_euler(const Config& config, State& s) {
  accelerate(config, s, s.robot.q, s.robot.v, s.a);
  s.v = s.robot.v + config.dt * s.a;
  s.twist = config.dt * s.v;
  rbd::integrate(config.model, s.robot.q, s.twist, s.q);
}

/// How the coordinates x of q = q0 exp(x) change when the body moves with v: v + [x, v] / 2 + [x, [x, v]]
/// / 12. Only a floating base has brackets that are not zero. Source: Munthe-Kaas 1999 (RKMK, order 4).
void coordinate_rate(const rbd::Model& model, const Eigen::VectorXd& x, Eigen::VectorXd& v) {
  for (int j = 1; j < model.njoints; ++j) {
    const rbd::JointModel& joint = model.joints[j];
    if (joint.nv() != 6) continue;
    const int at = joint.idx_v();
    const rbd::Motion m(x.segment<3>(at), x.segment<3>(at + 3));
    rbd::Motion twist(v.segment<3>(at), v.segment<3>(at + 3));
    const rbd::Motion once = m.cross(twist), twice = m.cross(once);
    v.segment<3>(at) += 0.5 * once.angular() + twice.angular() / 12;
    v.segment<3>(at + 3) += 0.5 * once.linear() + twice.linear() / 12;
  }
}

void runge_kutta_4(const Config& config, State& s) {
  constexpr double kAt[4] = {0, 0.5, 0.5, 1};
  for (int i = 0; i < 4; ++i) {
    // the state that the slope before leads to
    if (i == 0) {
      s.q = s.robot.q, s.slope_q[0] = s.robot.v;
    } else {
      s.twist = kAt[i] * config.dt * s.slope_q[i - 1];
      rbd::integrate(config.model, s.robot.q, s.twist, s.q);
      s.slope_q[i] = s.robot.v + kAt[i] * config.dt * s.slope_v[i - 1];
    }
    accelerate(config, s, s.q, s.slope_q[i], s.slope_v[i]);
    if (i > 0) coordinate_rate(config.model, s.twist, s.slope_q[i]);
  }
  const double sixth = config.dt / 6;
  s.v = s.robot.v + sixth * (s.slope_v[0] + 2 * s.slope_v[1] + 2 * s.slope_v[2] + s.slope_v[3]);
  s.twist = sixth * (s.slope_q[0] + 2 * s.slope_q[1] + 2 * s.slope_q[2] + s.slope_q[3]);
  rbd::integrate(config.model, s.robot.q, s.twist, s.q);
}

/// What is wrong with the new q and v; `what` stays empty if nothing is.
Event divergence(const Config& config, const State& s) {
  for (int j = 1; j < config.model.njoints; ++j) {
    const rbd::JointModel& joint = config.model.joints[j];
    for (int i = joint.idx_v(); i < joint.idx_v() + joint.nv(); ++i)
      if (!(std::abs(s.v[i]) <= kRunaway))
        return {"diverged", config.model.names[j], "v " + number(s.v[i]) + ", bound " + number(kRunaway)};
    for (int i = joint.idx_q(); i < joint.idx_q() + joint.nq(); ++i)
      if (!(std::abs(s.q[i]) <= kFarAway))
        return {"diverged", config.model.names[j], "q " + number(s.q[i]) + ", bound " + number(kFarAway)};
  }
  return {};
}

}  // namespace

Config make_config(const Experiment& e, const rbd::Model& model) {
  Config config;
  config.model = model;
  config.dt = e.simulator.dt;
  if (e.simulator.integrator == "rk4") config.integrator = Integrator::RungeKutta4;
  config.q0 = configuration(e, "simulator.q0", e.simulator.q0, model, rbd::neutral(model));
  config.v0 = joint_vector(e, "simulator.v0", e.simulator.v0, model, 0);
  config.damping = joint_vector(e, "simulator.damping", e.simulator.damping, model, 0);
  config.friction = joint_vector(e, "simulator.friction", e.simulator.friction, model, 0);
  const auto& g = e.simulator.gravity;
  if (floats(model) && !e.simulator.allow_fall && (g[0] != 0 || g[1] != 0 || g[2] != 0))
    fail(e, "simulator.allow_fall",
         "'" + model.name +
             "' floats and there is no ground yet: it would fall; set it to true, or simulator.gravity to "
             "[0, 0, 0]");
  return config;
}

State::State(const Config& config) : data(config.model) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(config.model.nv);
  robot.q = q = config.q0;
  robot.v = v = config.v0;
  robot.tau = effort = force = a = twist = zero;
  clamped.assign(config.model.nv, false);
  for (int i = 0; i < 4; ++i) slope_q[i] = slope_v[i] = zero;
}

State initial(const Config& config) { return State(config); }

Output step(const Config& config, State& state, const Input& input) {
  Output output;
  for (const Action& action : input.actions)
    if (is_for(action, "simulator"))
      output.events.push_back(ignored(action, "simulator", "the simulator has no such action"));
  if (input.command && accept(config, *input.command, output.events))
    limit(config, state, *input.command, output.events);

  Event fault;
  try {
    config.integrator == Integrator::RungeKutta4 ? runge_kutta_4(config, state)
                                                 : semi_implicit_euler(config, state);
    fault = divergence(config, state);
  } catch (const std::exception& e) {  // a singular mass matrix, or a state too wild to integrate
    fault = {"diverged", "simulator", e.what()};
  }
  if (!fault.what.empty()) {
    output.events.push_back(fault);
    output.abort = true;
  } else {
    ++state.robot.step;
    state.robot.time = static_cast<double>(state.robot.step) * config.dt;
    state.robot.q = state.q;
    state.robot.v = state.v;
    state.robot.tau = state.effort;
  }
  output.state = state.robot;
  return output;
}

}  // namespace lab::simulator
