// The robot as simulated: one step of time as a pure function of config, state and input.
// a = M^-1 (tau + J^T pushes + soft stops - damping v - friction tanh(v / kSlipSpeed) - nle), armature and payloads in M and
// nle. While holding, commands are ignored and tau = M (-v / 0.1 s) + nle (safety.hold `gravity`), or without
// the gravity term (`damping`). State::robot is the true state, Output::state what the sensors measure.
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
  RungeKutta4,        ///< classic, constant effort per step; a floating base by Munthe-Kaas (4th order too)
};

struct Config {
  rbd::Model model;  ///< nominal, with simulator.damping and .friction
  double dt = 0;     ///< s
  Integrator integrator = Integrator::SemiImplicitEuler;
  Eigen::VectorXd q0, v0;    ///< nq; nv
  safety::Config safety;     ///< with a watchdog in real time
  bool hold_gravity = true;  ///< holding also compensates the weight of robot and payloads
  Sensors sensors;
  Disturbances disturbances;
};

/// Throws ExperimentError for values that do not fit the model, and for a floating robot that would
/// fall (simulator.allow_fall).
Config make_config(const Experiment&, const rbd::Model&);

struct State {
  explicit State(const Config&);
  RobotState robot;           ///< the truth
  Eigen::VectorXd effort;     ///< nv: of the last accepted command, clamped
  std::vector<bool> clamped;  ///< nv: which of its entries are clamped
  safety::State safety;
  DelayBuffer memory;
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
  const Command* command = nullptr;  ///< null: no new one, the last stays in effect
  std::span<const Action> actions{};
};

struct Output {
  RobotState state;           ///< of the next step, as measured; if `abort`, the one before again
  std::vector<Event> events;  ///< of the next step
  bool abort = false;         ///< the run cannot go on; the last event says why
  safety::Mode mode = safety::Mode::Running;
};

/// From step k to k + 1. Takes the actions estop, rearm, push and payload. Effort beyond the limits is clamped (one event
/// when that begins); a command of wrong size or not finite is refused with an event and the last one stays in effect;
/// a state that diverges (simulator.cc: bounds on q and v) aborts. Never throws.
Output step(const Config&, State&, const Input&);

}  // namespace lab::simulator
