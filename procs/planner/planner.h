#pragma once
#include <optional>
#include <span>
#include <vector>

#include "procs/planner/motions.h"

/// What is wanted of the robot at each step: a pure function of config, state and input. A motion is a law of its own
/// time. That time stands still while the robot is held; afterwards it sets in gently, from where the robot is. A goal
/// that a person gives begins at the current reference, with its velocity and acceleration: nothing ever jumps.
namespace lab::planner {

/// A way that takes the motion's place: q = c0 + c1 t + .. + c5 t^5 for T. A person's goal is such a way, and so is the
/// way from there back to the motion.
struct Way {
  Eigen::VectorXd c[6];  ///< nq each
  double T = 0;          ///< s
  std::optional<double>
      onward;  ///< s: the motion's time at the end of the way; without it the way ends in rest
};

struct State {
  int64_t since = 0;       ///< step at which the motion's time was `began`
  double began = 0;        ///< s
  double ramp = 0;         ///< s in which that time reaches its full rate and `offset` goes to 0; 0 = none
  Eigen::VectorXd offset;  ///< nq: from the motion to the reference at `since`
  std::optional<Way> way;  ///< instead of config's motion
  double left = 0;         ///< s: the motion's time when the way took its place
  bool held = false;       ///< the robot does not follow: the reference is where it is
  bool stopped = false;    ///< a person said estop, and not yet rearm
  int64_t last_step = -1;  ///< of the newest reference
};
inline State initial(const Config&) { return {}; }

struct Input {
  int64_t step = 0;  ///< the one that the reference is for
  std::span<const Action> actions{};
  const RobotState* state = nullptr;  ///< newest; null before the first
  bool held = false;                  ///< the simulator holds the robot
};

struct Output {
  Reference reference;
  std::vector<Event> events;
};

/// The reference for input.step; steps rise, and may be left out. Takes `goal` (nq values, or a frame and where it shall
/// be: cartesian.h; key "duration": seconds, 0 or none = as fast as the share `speed` of the limits allows), `set` planner
/// motion=on (back to the motion after a goal: a point-to-point cycle goes on with its next target), `estop` and `rearm`.
Output step(const Config&, State&, const Input&);

}  // namespace lab::planner
