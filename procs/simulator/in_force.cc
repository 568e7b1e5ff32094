#include "procs/simulator/in_force.h"

#include <algorithm>
#include <span>

#include "core/util/number.h"
#include "lab/experiment/cartesian.h"

namespace lab::simulator {
namespace {

std::string joined(std::span<const double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + number(value);
  return text;
}

/// One number where all joints have the same, as `set` takes it.
std::string value_of(const rbd::Model& model, const Eigen::VectorXd& gain) {
  std::vector<double> values;
  for (const rbd::JointModel& joint : model.joints)
    if (joint.nv() == 1) values.push_back(gain[joint.idx_v()]);
  if (std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end() &&
      !values.empty())
    values.resize(1);
  return joined(values);
}
std::string value_of(const rbd::Model&, const std::array<double, 2>& gain) { return joined(gain); }
std::string value_of(const rbd::Model&, double gain) { return number(gain); }

}  // namespace

InForce::InForce(const Experiment& e, const rbd::Model& model, std::vector<std::string> gains)
    : model_(model), law_(e.controller.kind), names_(std::move(gains)) {
  if (!names_.empty()) gains_ = live_gains(e, model);
  others_["planner.motion"] = "on\t";
}

void InForce::take(const Action& action) {
  if (action.verb == "goal") {
    const std::string frame = is_cartesian(action) ? action.target + " at " : "";
    others_["planner.motion"] = "goal " + frame + joined(action.values) + "\trad, m";
  } else if (action.verb == "payload" && !action.values.empty()) {
    others_["simulator.payload." + action.target] = number(action.values[0]) + "\tkg";
  } else if (action.verb == "set" && action.target == "controller" && !names_.empty()) {
    set_gain(model_, gains_, action);
  } else if (action.verb == "set") {
    others_[action.target + "." + action.key] =
        (action.values.empty() ? action.text : joined(action.values)) + "\t";
  }
}

std::string InForce::text() const {
  std::string out;
  if (!names_.empty()) out += "controller.kind\t" + law_ + "\t\n";
  for_each_gain(
      [&](const Key& key, const auto& gain) {
        const std::string name = key.name;
        if (std::find(names_.begin(), names_.end(), name.substr(name.rfind('.') + 1)) != names_.end())
          out += name + "\t" + value_of(model_, gain) + "\t" + unit_for_law(key.unit, law_) + "\n";
      },
      gains_);
  for (const auto& [name, value] : others_) out += name + "\t" + value + "\n";
  return out;
}

}  // namespace lab::simulator
