#include "lab/experiment/live_gains.h"

#include <algorithm>
#include <cmath>

#include "core/util/number.h"
#include "lab/experiment/joints.h"

namespace lab {
namespace {

/// The key without its section.
std::string short_name(const Key& key) {
  const std::string name = key.name;
  return name.substr(name.rfind('.') + 1);
}

// One overload per type of a gain: from the experiment; how many numbers it does not take; from an action.

void start(const Experiment& e, const rbd::Model& model, const Key& key, const JointValues& given,
           Eigen::VectorXd& gain) {
  gain = joint_vector(e, key.name, given, model, 0);
}

template <class T>
void start(const Experiment&, const rbd::Model&, const Key&, const T& given, T& gain) {
  gain = given;
}

/// The counts that would do, in words; empty if `count` is one of them.
std::string needed(const rbd::Model& model, size_t count, const Eigen::VectorXd&) {
  size_t joints = 0;
  for (const rbd::JointModel& joint : model.joints) joints += joint.nv() == 1;
  return count == 1 || count == joints ? "" : "1 or " + std::to_string(joints);
}

template <size_t n>
std::string needed(const rbd::Model&, size_t count, const std::array<double, n>&) {
  return count == n ? "" : std::to_string(n);
}

std::string needed(const rbd::Model&, size_t count, double) { return count == 1 ? "" : "1"; }

void set(const rbd::Model& model, const std::vector<double>& values, Eigen::VectorXd& gain) {
  size_t i = 0;
  for (const rbd::JointModel& joint : model.joints)
    if (joint.nv() == 1) gain[joint.idx_v()] = values[values.size() == 1 ? 0 : i++];
}

template <size_t n>
void set(const rbd::Model&, const std::vector<double>& values, std::array<double, n>& gain) {
  std::copy_n(values.begin(), n, gain.begin());
}

void set(const rbd::Model&, const std::vector<double>& values, double& gain) { gain = values[0]; }

}  // namespace

LiveGains live_gains(const Experiment& e, const rbd::Model& model) {
  LiveGains gains;
  for_each_gain([&](const Key& key, const auto& given, auto& gain) { start(e, model, key, given, gain); },
                e.controller, gains);
  return gains;
}

std::vector<std::string> gain_keys() {
  std::vector<std::string> keys;
  for_each_gain([&](const Key& key) { keys.push_back(short_name(key)); });
  return keys;
}

std::string unit_for_law(const std::string& units, const std::string& law) {
  std::string first;
  for (size_t at = 0; at < units.size();) {
    const size_t end = std::min(units.find("; ", at), units.size());
    const std::string part = units.substr(at, end - at);
    const size_t colon = part.find(": ");
    const std::string unit = colon == std::string::npos ? part : part.substr(colon + 2);
    if (colon != std::string::npos &&
        (", " + part.substr(0, colon) + ",").find(", " + law + ",") != std::string::npos)
      return unit;
    if (first.empty()) first = unit;
    at = end + 2;
  }
  return first;
}

std::string gain_fault(const rbd::Model& model, const Action& action) {
  const std::vector<std::string> keys = gain_keys();
  if (std::find(keys.begin(), keys.end(), action.key) == keys.end())
    return "the controller has no '" + action.key + "' to set" + did_you_mean(action.key, keys) +
           " (it has " + list_of(keys) + ")";
  if (!action.text.empty()) return action.key + " is '" + action.text + "', must be a number";
  const LiveGains types;
  std::string counts;
  for_each_gain(
      [&](const Key& key, const auto& type) {
        if (short_name(key) == action.key) counts = needed(model, action.values.size(), type);
      },
      types);
  if (!counts.empty())
    return action.key + " has " + std::to_string(action.values.size()) + " values, expected " + counts;
  for (double value : action.values)
    if (!(value >= 0 && std::isfinite(value)))
      return action.key + " is " + number(value) + ", must be finite and at least 0";
  return "";
}

std::string set_gain(const rbd::Model& model, LiveGains& gains, const Action& action) {
  if (std::string fault = gain_fault(model, action); !fault.empty()) return fault;
  for_each_gain(
      [&](const Key& key, auto& gain) {
        if (short_name(key) == action.key) set(model, action.values, gain);
      },
      gains);
  return "";
}

}  // namespace lab
