#pragma once
#include <rbd/model/data.h>

#include <span>
#include <string>
#include <vector>

#include "procs/experiment/experiment.h"
#include "procs/signals/signals.h"

/// Joint effort from what is and what is wanted: a pure function of config, state and input.
/// A new controller is one function (or a struct with one) and one line in kinds(). It knows its own model,
/// which may be wrong on purpose. Nothing drives a floating base: its entries are 0.
namespace lab::controller {

struct Config;
struct State;
struct Input;

/// Writes tau (nv). `e` and `e_dot` (state) are the errors of q and v.
using Law = void (*)(const Config&, State&, const Input&, Eigen::VectorXd& tau);

struct Kind {
  const char* name;
  const char* what;  ///< the formula
  Law law;
  bool cancels_inertia;  ///< gains act on acceleration (1/s2, 1/s), not on effort
};

/// none, pd, pd_gravity, computed_torque.
std::span<const Kind> kinds();

struct Config {
  const Kind* kind = nullptr;
  rbd::Model model;        ///< what the controller believes
  Eigen::VectorXd kp, kd;  ///< nv
};

/// Throws ExperimentError: unknown kind, gains that do not fit the model.
Config make_config(const Experiment&, const rbd::Model&);

struct State {
  explicit State(const Config&);
  Eigen::VectorXd kp, kd;  ///< live gains, nv
  rbd::Data data;          ///< scratch from here on
  Eigen::VectorXd e, e_dot, a;
};

inline State initial(const Config& config) { return State(config); }

struct Input {
  const RobotState& state;
  const Reference& reference;  ///< for the same step
  std::span<const Action> actions{};
};

struct Output {
  Command command;
  std::vector<Event> events;
};

/// Takes the actions (`set controller kp|kd`: one number, or one per joint), then computes the command.
Output step(const Config&, State&, const Input&);

}  // namespace lab::controller
