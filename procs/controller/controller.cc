#include "procs/controller/controller.h"

#include <rbd/algorithm/configuration.h>

#include <algorithm>
#include <exception>
#include <limits>

#include "core/util/words.h"
#include "lab/experiment/actions.h"
#include "lab/experiment/joints.h"
#include "lab/experiment/live_gains.h"
#include "procs/controller/own_model.h"

namespace lab::controller {
namespace {

const Kind& find_kind(const Experiment& e, std::span<const Kind> more) {
  std::vector<std::string> names;
  for (const std::span<const Kind> table : {kinds(), more})
    for (const Kind& kind : table) {
      if (e.controller.kind == kind.name) return kind;
      names.push_back(kind.name);
    }
  fail(e, "controller.kind", "'" + e.controller.kind + "' is not known; use one of " + list_of(names));
}

}  // namespace

std::vector<std::string> gains_of(const std::string& name) {
  std::vector<std::string> gains = gain_keys();
  for (const Kind& kind : kinds())
    if (kind.name == name && kind.keys)
      std::erase_if(gains, [&](const std::string& gain) { return !lists(kind.keys, gain); });
  return gains;
}

std::string unused_gain(const std::string& kind, const std::string& gain) {
  const std::vector<std::string> used = gains_of(kind);
  if (std::find(used.begin(), used.end(), gain) != used.end()) return "";
  return kind + " does not use " + gain + (used.empty() ? "; it has no gains" : "; it has " + list_of(used));
}

Config make_config(const Experiment& e, const rbd::Model& model, std::span<const Kind> more) {
  Config config;
  config.kind = &find_kind(e, more);
  config.model = own_model(e, model);
  config.gains = live_gains(e, model);
  config.period = e.simulator.dt * static_cast<double>(e.controller.every);
  config.limit_effort = e.controller.limit_effort;
  if (config.kind->prepare) config.kind->prepare(e, config);
  return config;
}

State::State(const Config& config) : gains(config.gains), data(config.model) {
  const int nv = config.model.nv;
  e = e_dot = a = posture = memory = Eigen::VectorXd::Zero(nv);
  limited.assign(nv, false);
  jacobian.setZero(6, nv);
  com_jacobian.setZero(3, nv);
  minv.setZero(nv, nv);
  minv_jt.setZero(nv, 6);
}

Output step(const Config& config, State& state, const Input& input) {
  Output output;
  for (const Action& action : input.actions) {
    if (!is_for(action, "controller")) continue;
    const std::string why_not = action.verb == "set" ? set_gain(config.model, state.gains, action)
                                                     : "the controller has no such action";
    if (!why_not.empty()) output.events.push_back(ignored(action, "controller", why_not));
  }
  rbd::difference(config.model, input.state.q, input.reference.q, state.e);
  state.e_dot = input.reference.v - input.state.v;
  Eigen::VectorXd& tau = output.command.tau;
  tau.resize(config.model.nv);
  try {
    config.kind->law(config, state, input, tau);
  } catch (
      const std::
          exception&) {  // numbers too large for the dynamics; the sender refuses a command that is not finite
    tau.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  for (const rbd::JointModel& joint : config.model.joints)
    if (joint.nv() > 1) tau.segment(joint.idx_v(), joint.nv()).setZero();
  if (config.limit_effort) clamp_effort(config.model, "effort_limited", tau, state.limited, output.events);
  return output;
}

}  // namespace lab::controller
