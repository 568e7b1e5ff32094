#include "lab/experiment/actions.h"

#include <cmath>

#include "core/util/number.h"
#include "lab/experiment/cartesian.h"
#include "lab/experiment/joints.h"
#include "lab/experiment/live_gains.h"

namespace lab {
namespace {

std::string count_fault(const Action& action, size_t wanted) {
  if (action.values.size() == wanted) return "";
  return action.verb + " has " + std::to_string(action.values.size()) + " values, expected " +
         std::to_string(wanted);
}

std::string goal_fault(const rbd::Model& model, const Action& action) {
  if (floats(model)) return "'" + model.name + "' floats; it takes no goals";
  if (is_cartesian(action)) {
    if (std::string fault = find_configuration(model, action, nullptr).fault; !fault.empty()) return fault;
  } else if (std::string fault = count_fault(action, model.nq); !fault.empty()) {
    return fault + ", one for each joint";
  } else {
    for (int i = 0; i < model.nq; ++i) {
      const double q = action.values[i], low = model.lowerPositionLimit[i],
                   high = model.upperPositionLimit[i];
      if (q < low || q > high)
        return "goal of joint '" + joint_at(model, i) + "' is " + number(q) + ", its limits are " +
               number(low) + " .. " + number(high);
    }
  }
  if (action.key == "duration") {
    char* end = nullptr;
    const double duration = std::strtod(action.text.c_str(), &end);
    if (action.text.empty() || *end || !(duration >= 0) || !std::isfinite(duration))
      return "duration '" + action.text + "' is not a duration in seconds";
  }
  return "";
}

std::string set_fault(const Experiment& e, const rbd::Model& model, const Action& action) {
  if (action.target != "controller" && action.target != "planner")
    return "'" + action.target + "' has nothing to set; the controller has " + list_of(gain_keys()) +
           ", the planner motion";
  if (e.processes.contains(action.target)) return "";  // a foreign process knows its own keys
  if (action.target == "planner") {
    if (action.key != "motion" || action.text != "on")
      return "the planner has nothing to set but motion=on: back to its motion after a goal";
    return floats(model) ? "'" + model.name + "' floats; it does not move" : "";
  }
  return gain_fault(model, action);
}

}  // namespace

std::string push_fault(const rbd::Model& model, const Action& action) {
  if (std::string fault = frame_fault(model, action.target); !fault.empty()) return fault;
  if (std::string fault = count_fault(action, 7); !fault.empty()) return fault + ": torque, force, seconds";
  if (!(action.values[6] > 0 && action.values[6] <= 60))
    return "push for " + number(action.values[6]) + " s, expected more than 0 and at most 60";
  return "";
}

std::string payload_fault(const rbd::Model& model, const Action& action) {
  if (std::string fault = frame_fault(model, action.target); !fault.empty()) return fault;
  if (std::string fault = count_fault(action, 4); !fault.empty())
    return fault + ": mass and its position in the frame";
  if (!(action.values[0] >= 0 && action.values[0] <= 1e6))
    return "payload of " + number(action.values[0]) + " kg, expected at least 0 and at most 1e+06";
  return "";
}

std::string why_not(const Experiment& e, const rbd::Model& model, const Action& action) {
  for (double value : action.values)
    if (!std::isfinite(value)) return action.verb + ": a value is not finite";
  if (action.verb == "goal") return goal_fault(model, action);
  if (action.verb == "push") return push_fault(model, action);
  if (action.verb == "payload") return payload_fault(model, action);
  if (action.verb == "set") return set_fault(e, model, action);
  if (action.verb == "estop" || action.verb == "rearm") return "";
  return "there is no action '" + action.verb + "'";
}

}  // namespace lab
