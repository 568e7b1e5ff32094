#include "procs/controller/controller.h"

#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/rnea.h>

#include <cmath>

#include "procs/experiment/actions.h"
#include "procs/experiment/joints.h"

namespace lab::controller {
namespace {

// tau = 0
void none(const Config&, State&, const Input&, Eigen::VectorXd& tau) { tau.setZero(); }

// tau = Kp e + Kd e'
void pd(const Config&, State& s, const Input&, Eigen::VectorXd& tau) {
  tau = s.kp.cwiseProduct(s.e) + s.kd.cwiseProduct(s.e_dot);
}

// tau = Kp e + Kd e' + g(q)
void pd_gravity(const Config& c, State& s, const Input& in, Eigen::VectorXd& tau) {
  tau = s.kp.cwiseProduct(s.e) + s.kd.cwiseProduct(s.e_dot) +
        rbd::computeGeneralizedGravity(c.model, s.data, in.state.q);
}

// tau = M(q) (a_ref + Kp e + Kd e') + nle(q, v), so that e'' + Kd e' + Kp e = 0
void computed_torque(const Config& c, State& s, const Input& in, Eigen::VectorXd& tau) {
  s.a = in.reference.a + s.kp.cwiseProduct(s.e) + s.kd.cwiseProduct(s.e_dot);
  rbd::rnea(c.model, s.data, in.state.q, in.state.v, s.a, tau);
}

constexpr Kind kKinds[] = {
    {"none", "tau = 0", none, false},
    {"pd", "tau = kp e + kd e'", pd, false},
    {"pd_gravity", "tau = kp e + kd e' + g(q)", pd_gravity, false},
    {"computed_torque", "tau = M(q) (a_ref + kp e + kd e') + nle(q, v)", computed_torque, true},
};

const Kind& find_kind(const Experiment& e) {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) {
    if (e.controller.kind == kind.name) return kind;
    names.push_back(kind.name);
  }
  fail(e, "controller.kind", "'" + e.controller.kind + "' is not known; use one of " + list_of(names));
}

/// Carries out `set controller kp|kd`. Returns why not, or "".
std::string set_gain(const rbd::Model& model, State& state, const Action& action) {
  if (action.verb != "set") return "the controller has no such action";
  if (action.key != "kp" && action.key != "kd") return "the controller can set kp and kd";
  Eigen::VectorXd& gain = action.key == "kp" ? state.kp : state.kd;
  size_t joints = 0;
  for (const rbd::JointModel& joint : model.joints) joints += joint.nv() == 1;
  const size_t given = action.values.size();
  if (given != 1 && given != joints)
    return "has " + std::to_string(given) + " values, needed 1 or " + std::to_string(joints);
  for (double value : action.values)
    if (!(value >= 0 && std::isfinite(value)))
      return "value " + number(value) + ", must be finite and at least 0";
  size_t i = 0;
  for (const rbd::JointModel& joint : model.joints)
    if (joint.nv() == 1) gain[joint.idx_v()] = action.values[given == 1 ? 0 : i++];
  return "";
}

}  // namespace

std::span<const Kind> kinds() { return kKinds; }

Config make_config(const Experiment& e, const rbd::Model& model) {
  Config config;
  config.kind = &find_kind(e);
  config.model = model;
  if (e.controller.model.mass_scale != 1)
    for (int j = 0; j < model.njoints; ++j)
      config.model.setInertia(j, model.inertias[j] * e.controller.model.mass_scale);
  config.kp = joint_vector(e, "controller.kp", e.controller.kp, model, 0);
  config.kd = joint_vector(e, "controller.kd", e.controller.kd, model, 0);
  return config;
}

State::State(const Config& config) : kp(config.kp), kd(config.kd), data(config.model) {
  e = e_dot = a = Eigen::VectorXd::Zero(config.model.nv);
}

Output step(const Config& config, State& state, const Input& input) {
  Output output;
  for (const Action& action : input.actions) {
    if (!is_for(action, "controller")) continue;
    const std::string why_not = set_gain(config.model, state, action);
    if (!why_not.empty()) output.events.push_back(ignored(action, "controller", why_not));
  }
  rbd::difference(config.model, input.state.q, input.reference.q, state.e);
  state.e_dot = input.reference.v - input.state.v;
  Eigen::VectorXd& tau = output.command.tau;
  tau.resize(config.model.nv);
  config.kind->law(config, state, input, tau);
  for (const rbd::JointModel& joint : config.model.joints)
    if (joint.nv() > 1) tau.segment(joint.idx_v(), joint.nv()).setZero();
  return output;
}

}  // namespace lab::controller
