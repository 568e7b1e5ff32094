// Goals for a frame instead of joints. The INPUT carries the frame's goal; simulator (which refuses unreachable goals)
// and planner solve the inverse kinematics with the same pure function, so that the log alone determines the result.
#pragma once
#include <rbd/model/model.h>

#include <string>

#include "lab/signals/signals.h"

namespace lab {

/// True for a goal of a frame, which is its target: its values are the frame's position in the world (m) and, if the
/// orientation is given too, a unit quaternion (xyzw).
inline bool is_cartesian(const Action& action) { return action.verb == "goal" && !action.target.empty(); }

struct IkResult {
  Eigen::VectorXd q;  ///< nq: inside the limits, the frame within 1e-6 m and rad
  std::string fault;  ///< why there is none, and how far the nearest is from the target; empty if there is
};

/// A configuration that reaches the goal. Starts at `from` (may be null) and stays as near to it as the target allows; if
/// that fails, starts at neutral, then at random configurations, always the same ones: so every process finds a
/// configuration for every goal that the simulator, which has no `from`, has accepted.
IkResult find_configuration(const rbd::Model&, const Action&, const Eigen::VectorXd* from);

}  // namespace lab
