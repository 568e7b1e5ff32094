// Goals for a frame instead of joints. The INPUT carries the frame's goal; simulator (which refuses the impossible) and
// planner find the joints for it with the same pure function, so that the log alone explains what follows.
#pragma once
#include <rbd/model/model.h>

#include <string>

#include "lab/signals/signals.h"

namespace lab {

/// True if a goal names a frame, its target: values are then the frame's position in the world (m), and after it, when
/// its orientation is asked for too, a unit quaternion (xyzw).
inline bool is_cartesian(const Action& action) { return action.verb == "goal" && !action.target.empty(); }

struct Found {
  Eigen::VectorXd q;  ///< nq: inside the limits, the frame within 1e-6 m and rad
  std::string fault;  ///< why there is none, and how far the nearest is from the target; empty if there is
};

/// A configuration for it. First from `from` on (may be null), as near to it as the target allows; if that leads nowhere,
/// from neutral and then from random configurations, always the same ones: so every process finds a configuration for
/// what the simulator, which does not know `from`, has accepted.
Found find_configuration(const rbd::Model&, const Action&, const Eigen::VectorXd* from);

}  // namespace lab
