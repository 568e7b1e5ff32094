#pragma once
#include <rbd/model/model.h>

#include <string>
#include <string_view>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

/// Which process an accepted INPUT is for. All of them see every INPUT, so that each can be recomputed from
/// the log.
namespace lab {

/// A named process takes what is addressed to it; of the rest the planner takes goals, the simulator
/// everything else.
inline bool is_for(const Action& action, std::string_view process) {
  if (action.verb == "goal") return process == "planner";  // its target is a frame
  for (std::string_view named : {"simulator", "planner", "controller"})
    if (action.target == named) return process == named;
  return process == (action.verb == "goal" ? "planner" : "simulator");
}

/// What a step says about an action that it cannot carry out.
inline Event ignored(const Action& action, const std::string& process, const std::string& why) {
  const std::string what = action.verb + (action.key.empty() ? "" : " " + action.key);
  return {"action_ignored", process, "'" + what + "': " + why};
}

/// Why this cannot be asked of this robot in this experiment, so that it is refused at the door; empty if it can.
std::string why_not(const Experiment&, const rbd::Model&, const Action&);

/// The same for what needs only the robot.
std::string push_fault(const rbd::Model&, const Action&);
std::string payload_fault(const rbd::Model&, const Action&);

}  // namespace lab
