#pragma once
#include <rbd/model/model.h>

#include <span>
#include <string>
#include <vector>

#include "procs/experiment/experiment.h"
#include "procs/signals/signals.h"

/// What is wanted of the robot at each step: a pure function of config and step number.
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
  Eigen::VectorXd q0, goal;                             ///< nq
  Eigen::VectorXd offset, amplitude, frequency, phase;  ///< nv, of sinusoid
};

/// Throws ExperimentError: unknown kind, no goal, a motion beyond the joint limits, a floating base that
/// should move.
Config make_config(const Experiment&, const rbd::Model&);

/// Nothing is remembered yet: a reference depends on its step alone.
struct State {};
inline State initial(const Config&) { return {}; }

struct Input {
  int64_t step = 0;  ///< the one that the reference is for
  std::span<const Action> actions{};
};

struct Output {
  Reference reference;
  std::vector<Event> events;
};

/// The reference for input.step, at t = step dt.
Output step(const Config&, State&, const Input&);

}  // namespace lab::planner
