// The robot as simulated: one step of time as a pure function of config, state and input.
// a = M^-1 (tau + J^T pushes + soft stops - damping v - friction tanh(v / kSlipSpeed) - nle), armature and payloads in M and
// nle. While holding, the command is ignored and the robot held: tau = M (-v / 0.1 s) + nle (`gravity`), or
// without gravity's part. The true state stays inside; Output::state is as the sensors measure it.
#pragma once
#include <rbd/algorithm/data.h>
#include <rbd/algorithm/external_wrench.h>

#include <span>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"
#include "procs/simulator/disturbances.h"
#include "procs/simulator/safety.h"
#include "procs/simulator/sensors.h"

namespace lab::simulator {

enum class Integrator {
  SemiImplicitEuler,  ///< v += a dt, then q moves by the new v dt
  RungeKutta4,        ///< classic, effort held; a floating base by Munthe-Kaas (4th order too)
};

struct Config {
  rbd::Model model;  ///< nominal, with simulator.damping and .friction
  double dt = 0;     ///< s
  Integrator integrator = Integrator::SemiImplicitEuler;
  Eigen::VectorXd q0, v0;    ///< nq; nv
  safety::Config safety;     ///< with a watchdog in real time
  bool hold_gravity = true;  ///< holding compensates the weight of the robot and its payloads
  Sensors sensors;
  Disturbances disturbances;
};

/// Throws ExperimentError for values that do not fit the model, and for a floating robot that would only
/// fall.
Config make_config(const Experiment&, const rbd::Model&);

struct State {
  explicit State(const Config&);
  RobotState robot;           ///< the truth
  Eigen::VectorXd effort;     ///< nv: the command in force, limited
  std::vector<bool> clamped;  ///< nv: the command in force is limited here
  safety::State safety;
  Memory memory;
  Load load;
  rbd::Data data;  ///< scratch from here on
  Eigen::VectorXd force, a, twist, q, v, applied;
  rbd::FrameWrenches wrenches;
  Eigen::VectorXd slope_q[4], slope_v[4];
};

/// At q0 and v0, step 0, tau 0.
State initial(const Config&);

/// The state as the sensors measure it now: State::robot itself if they are perfect. Output::state, also at step 0.
RobotState sensed(const Config&, const State&);

struct Input {
  const Command* command = nullptr;  ///< null: none is new, the last is held
  std::span<const Action> actions{};
};

struct Output {
  RobotState state;           ///< of the next step, as the sensors see it; if `abort`, still the one before
  std::vector<Event> events;  ///< of the next step
  bool abort = false;         ///< the run cannot go on; the last event says why
  safety::Mode mode = safety::Mode::Running;
};

/// From step k to k + 1. Takes the actions estop, rearm, push and payload. Effort beyond the limits is clamped (one event
/// when that begins); a command of wrong size or not finite is refused with an event and the last one held; a state that
/// is no longer finite aborts. Never throws.
Output step(const Config&, State&, const Input&);

}  // namespace lab::simulator
