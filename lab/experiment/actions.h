// Actions: which process an accepted INPUT is for, and which requests are refused. All processes see every INPUT, so that
// each can be recomputed from the log.
#pragma once
#include <rbd/model/model.h>

#include <string>
#include <string_view>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

namespace lab {

/// An action that names a process is for that one; of the others, goals are for the planner, all else for the simulator.
inline bool is_for(const Action& action, std::string_view process) {
  if (action.verb == "goal") return process == "planner";  // its target is a frame
  for (std::string_view named : {"simulator", "planner", "controller"})
    if (action.target == named) return process == named;
  return process == "simulator";
}

/// The event of an action that a step cannot carry out.
inline Event ignored(const Action& action, const std::string& process, const std::string& why) {
  const std::string what = action.verb + (action.key.empty() ? "" : " " + action.key);
  return {"action_ignored", process, "'" + what + "': " + why};
}

/// Why the action is refused for this robot and experiment (the text of REPLY); empty if it is accepted.
std::string why_not(const Experiment&, const rbd::Model&, const Action&);

/// The same for actions that depend on the robot alone.
std::string push_fault(const rbd::Model&, const Action&);
std::string payload_fault(const rbd::Model&, const Action&);

}  // namespace lab
