// What acts on the simulated robot besides its motors, unknown to its controller: pushes, payloads, and
// the soft stops before the ends of its joints.
#pragma once
#include <rbd/algorithm/external_wrench.h>
#include <rbd/model/model.h>

#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

namespace lab::simulator {

/// A wrench at a frame's origin, world axes, for some steps.
struct Push {
  rbd::FrameWrench wrench;
  int64_t steps = 0;  ///< left
};
/// From torque (Nm) and force (N).
Push make_push(rbd::FrameIndex frame, const Eigen::Vector3d& torque, const Eigen::Vector3d& force,
               int64_t steps);

/// A point mass that is fixed to a frame.
struct Payload {
  rbd::FrameIndex frame = 0;
  double mass = 0;      ///< kg; 0 = nothing
  Eigen::Vector3d com;  ///< m, in the frame
};

/// A spring and a damper that act beyond `low` and `high`: effort -(stiffness x + damping |x| / margin v), x how far
/// beyond. Both begin at 0, so that nothing jumps. Source: Hunt, Crossley 1975, with a linear spring.
struct SoftStop {
  int q = 0, v = 0;  ///< the joint's places
  double low = 0, high = 0, margin = 0, stiffness = 0, damping = 0;
  double depth(double position) const {
    return position > high ? position - high : position < low ? position - low : 0;
  }
};

/// All that an experiment plans. `from`: the state from which on it acts.
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

/// Throws ExperimentError: a frame that does not exist or does not move, a push shorter than a step, margins that meet.
Disturbances make_disturbances(const Experiment&, const rbd::Model&);

/// What acts at one step.
struct Load {
  explicit Load(const rbd::Model& nominal) : model(nominal) {}
  rbd::Model model;  ///< with its payloads
  std::vector<Push> pushes;
  std::vector<Payload> payloads;
  size_t next_push = 0, next_payload = 0;  ///< of those planned
};

/// Begins what is planned for the step from `step` on; an event each.
void begin_step(const Disturbances&, const rbd::Model& nominal, int64_t step, Load&, std::vector<Event>&);
/// Takes the action push or payload; empty, or why not.
std::string take(const Action&, const rbd::Model& nominal, double dt, Load&);
/// Pushes whose time is over end.
void end_step(Load&);

/// Adds the soft stops' efforts.
void add_stops(const std::vector<SoftStop>&, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
               Eigen::VectorXd& effort);

}  // namespace lab::simulator
