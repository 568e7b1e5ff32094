// The planner: the reference of each step, a pure function of config, state and input. A motion is a function of its own
// time. That time is paused while the robot is held; afterwards it resumes smoothly, from the robot's position. A goal
// from the operator is a detour: it begins at the current reference, with its velocity and acceleration, so that the
// reference never jumps.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "procs/planner/motions.h"
#include "procs/planner/spline.h"

namespace lab::planner {

/// A quintic that replaces the motion: to the operator's goal, or from there back to the motion.
struct Detour {
  Spline::Piece path;                 ///< a function of time, from 0
  std::optional<double> resume_time;  ///< s: the motion's time at the end; without it the detour ends in rest
};

struct State {
  int64_t since = 0;       ///< step at which the motion's time (a detour's, if there is one) was `start_time`
  double start_time = 0;   ///< s
  double ramp = 0;         ///< s until that time runs at full rate and `offset` is 0; 0 = no ramp
  Eigen::VectorXd offset;  ///< nq: from the motion to the reference at `since`
  std::optional<Detour> detour;
  double left_time = 0;    ///< s: the motion's time when the detour replaced it
  bool held = false;       ///< the robot is held: the reference is its position
  bool stopped = false;    ///< after estop, until rearm
  int64_t last_step = -1;  ///< of the newest reference
};
inline State initial(const Config&) { return {}; }

struct Input {
  int64_t step = 0;  ///< the step that the reference is for
  std::span<const Action> actions{};
  const RobotState* state = nullptr;  ///< newest; null before the first
  bool held = false;                  ///< the simulator holds the robot
};

struct Output {
  Reference reference;
  std::vector<Event> events;
};

/// Why a goal cannot be taken from this reference in the time that it asks for; empty if it can. Asked before a goal is
/// accepted. step() takes what was accepted even if the reference has moved on since: if need be, in another time.
std::string goal_fault(const Config&, const Action& goal, const Reference& from);

/// The reference for input.step; steps increase, gaps are allowed. Takes `goal` (nq values, or a frame and its target pose:
/// cartesian.h; key "duration": seconds, 0 or none = shortest within the fraction `speed`), `set` planner
/// motion=on (back to the motion after a goal: a point-to-point cycle goes on with its next target), `estop` and `rearm`.
Output step(const Config&, State&, const Input&);

}  // namespace lab::planner
