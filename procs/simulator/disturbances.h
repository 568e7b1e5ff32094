// Disturbances of the simulated robot that its controller does not know: pushes, payloads, and soft stops
// near its joint limits.
#pragma once
#include <rbd/algorithm/external_wrench.h>
#include <rbd/model/model.h>

#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

namespace lab::simulator {

/// A wrench at a frame's origin, in world axes, for a number of steps.
struct Push {
  rbd::FrameWrench wrench;
  int64_t steps = 0;  ///< remaining
};
/// From torque (Nm) and force (N).
Push make_push(rbd::FrameIndex frame, const Eigen::Vector3d& torque, const Eigen::Vector3d& force,
               int64_t steps);

/// A point mass that is fixed to a frame.
struct Payload {
  rbd::FrameIndex frame = 0;
  double mass = 0;      ///< kg; 0 = none
  Eigen::Vector3d com;  ///< m, in the frame
};

/// A spring and a damper that act beyond `low` and `high`: effort -(stiffness x + damping |x| / margin v), x the depth
/// beyond them. The effort is continuous: 0 at x = 0. Source: Hunt, Crossley 1975, with a linear spring.
struct SoftStop {
  int q = 0, v = 0;  ///< the joint's indices
  double low = 0, high = 0, margin = 0, stiffness = 0, damping = 0;
  double depth(double position) const {
    return position > high ? position - high : position < low ? position - low : 0;
  }
};

/// All disturbances that an experiment plans. `from`: the step at which it begins to act.
struct Disturbances {
  template <class T>
  struct Planned {
    int64_t from;
    T what;
  };
  std::vector<Planned<Push>> pushes;       ///< by time
  std::vector<Planned<Payload>> payloads;  ///< by time
  std::vector<SoftStop> stops;
};

/// Throws ExperimentError: a frame that does not exist or does not move, a push shorter than a step, overlapping margins.
Disturbances make_disturbances(const Experiment&, const rbd::Model&);

/// What acts at one step.
struct Load {
  explicit Load(const rbd::Model& nominal) : model(nominal) {}
  rbd::Model model;  ///< nominal plus the present payloads
  std::vector<Push> pushes;
  std::vector<Payload> payloads;
  size_t next_push = 0, next_payload = 0;  ///< indices of the next planned ones
};

/// Starts the disturbances planned for the step that begins at `step`; one event each.
void begin_step(const Disturbances&, const rbd::Model& nominal, int64_t step, Load&, std::vector<Event>&);
/// Carries out the action push or payload. Returns why not, or "".
std::string take(const Action&, const rbd::Model& nominal, double dt, Load&);
/// Counts one step of each push and removes those that have ended.
void end_step(Load&);

/// Adds the soft stops' efforts.
void add_stops(const std::vector<SoftStop>&, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
               Eigen::VectorXd& effort);

}  // namespace lab::simulator
