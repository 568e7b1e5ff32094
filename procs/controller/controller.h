// The controller: joint effort from state and reference, a pure function of config, state and input.
// A new controller is one function and one row of a table (laws.cc, or one of your own: docs/extend.md). It uses its own
// model, which may deviate on purpose (own_model.h). A floating base is not actuated: its entries are 0.
#pragma once
#include <rbd/algorithm/data.h>

#include <span>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/experiment/live_gains.h"
#include "lab/signals/signals.h"

namespace lab::controller {

struct Config;
struct State;
struct Input;

/// Writes tau (nv). State::e and e_dot, already computed, are the errors of q and v.
using Law = void (*)(const Config&, State&, const Input&, Eigen::VectorXd& tau);
/// Looks up what only this kind needs; throws ExperimentError.
using Prepare = void (*)(const Experiment&, Config&);

struct Kind {
  const char* name;
  const char* what;  ///< the formula
  Law law;
  Prepare prepare = nullptr;  ///< may be null
  /// The gains and other keys of its own that it reads, without "controller.", blanks between; null: not known.
  const char* keys = nullptr;
};

/// The table of laws.cc: none, pd, ..
std::span<const Kind> kinds();

/// The gains that a kind reads: those of its row, all of them for a kind that kinds() does not have.
std::vector<std::string> gains_of(const std::string& kind);
/// Why a kind has no use for a gain; empty if it reads it.
std::string unused_gain(const std::string& kind, const std::string& gain);

/// What `set controller KEY=..` can change while it runs: lab/experiment/gains.h lists them, live_gains.h changes them.
using Gains = LiveGains;

struct Config {
  const Kind* kind = nullptr;
  rbd::Model model;   ///< the controller's own, see own_model.h
  Gains gains;        ///< initial
  double period = 0;  ///< s from one command to the next
  bool limit_effort = false;
  rbd::FrameIndex frame = 0;  ///< the tool; cartesian_impedance
};

/// Throws ExperimentError: unknown kind, gains that do not fit the model, a `controller.model` error for an unknown body.
/// `more`: kinds of the caller's own, beside kinds(); they must outlive the config.
Config make_config(const Experiment&, const rbd::Model&, std::span<const Kind> more = {});

struct State {
  explicit State(const Config&);
  Gains gains;                ///< live
  std::vector<bool> limited;  ///< nv: which entries of the last command were clamped
  Eigen::VectorXd memory;     ///< nv, 0 at first: what a law keeps from step to step, such as an integral
  rbd::Data data;             ///< scratch from here on
  Eigen::VectorXd e, e_dot, a, posture;
  rbd::Matrix6Xd jacobian;
  Eigen::Matrix3Xd com_jacobian;
  Eigen::MatrixXd minv, minv_jt;
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

/// Takes the actions (`set controller kp|kd|..`), then computes the command. With limit_effort it is clamped to the
/// model's effort limits, with one event when that begins at a joint.
Output step(const Config&, State&, const Input&);

}  // namespace lab::controller
