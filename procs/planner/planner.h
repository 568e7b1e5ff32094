#pragma once
#include <rbd/model/model.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "procs/experiment/experiment.h"
#include "procs/signals/signals.h"

/// What is wanted of the robot at each step: a pure function of config, state and input. A motion is a law of its own
/// time. That time stands still while the robot is held; afterwards it sets in gently, from where the robot is. A goal
/// that a person gives begins at the current reference, with its velocity and acceleration: nothing ever jumps.
/// A new kind of motion is one function and one line in kinds().
namespace lab::planner {

struct Config;

/// Writes q, v, a wanted at time t (s) after the start.
using Law = void (*)(const Config&, double t, Reference&);

struct Kind {
  const char* name;
  const char* what;
  Law law;
  bool to_goal;  ///< needs planner.goal
};

/// hold, cubic, quintic, sinusoid.
std::span<const Kind> kinds();

struct Config {
  const Kind* kind = nullptr;
  double dt = 0;        ///< s
  double duration = 0;  ///< s, of the way to the goal
  int nv = 0;
  bool floating = false;
  Eigen::VectorXd v_max;                                ///< nv: rad/s, m/s; 1 where the model has no limit
  Eigen::VectorXd q_min, q_max;                         ///< nq
  Eigen::VectorXd q0, goal;                             ///< nq
  Eigen::VectorXd offset, amplitude, frequency, phase;  ///< nv, of sinusoid
};

/// Throws ExperimentError: unknown kind, no goal, a motion beyond the joint limits, a floating base that
/// should move.
Config make_config(const Experiment&, const rbd::Model&);

/// The way to a person's goal: q = c0 + c1 t + .. + c5 t^5, to rest at the goal after T.
struct Way {
  Eigen::VectorXd c[6];  ///< nq each
  double T = 0;          ///< s
};

struct State {
  int64_t since = 0;         ///< step at which the motion's time was `began`
  double began = 0;          ///< s
  double ramp = 0;           ///< s in which that time reaches its full rate and `offset` goes to 0; 0 = none
  Eigen::VectorXd offset;    ///< nq: from the motion to the reference at `since`
  std::optional<Way> way;    ///< instead of config's motion
  bool held = false;         ///< the robot does not follow: the reference is where it is
  bool stopped = false;      ///< a person said estop, and not yet rearm
  int64_t last_step = -1;    ///< of the newest reference
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

/// The reference for input.step; steps rise, and may be left out. Takes `goal` (nq values; key "duration": seconds, 0 or
/// none = as fast as half the speed limits allow), `estop` and `rearm`.
Output step(const Config&, State&, const Input&);

}  // namespace lab::planner
