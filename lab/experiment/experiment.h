// One experiment: which robot, how it is simulated, how it moves, who controls it, what to expect. Plain values in SI
// units, without YAML, so that the steps can take it: experiment_yaml.h reads and writes them, docs/experiments.md lists
// every key.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "lab/experiment/gains.h"

namespace lab {

/// What is wrong with an experiment, one line per fault: "FILE:LINE: key: value seen, what to do".
struct ExperimentError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A number per joint as in the file: one for all joints, a list in model order, or joint name: number
/// (joints not named keep the default). Unset means that the default holds everywhere.
/// lab/experiment/joints.h turns it into a vector once the model is known.
struct JointValues {
  using Named = std::map<std::string, double>;
  std::variant<std::monostate, double, std::vector<double>, Named> value;

  bool given() const { return value.index() != 0; }
  bool operator==(const JointValues&) const = default;
};

/// A bound on one metric of a run.
struct Bound {
  std::optional<double> min, max;
  bool operator==(const Bound&) const = default;
};

/// A wrench on a frame for a while: world axes, about the frame's origin.
struct PlannedPush {
  double time = 0, duration = 0;  ///< s
  std::string frame;
  std::array<double, 3> force{}, torque{};  ///< N, Nm
  bool operator==(const PlannedPush&) const = default;
};

/// A point mass that is fixed to a frame from some time on, in place of what it carried before.
struct PlannedPayload {
  double time = 0;  ///< s
  std::string frame;
  double mass = 0;              ///< kg
  std::array<double, 3> com{};  ///< m, in the frame's axes
  bool operator==(const PlannedPayload&) const = default;
};

/// A duration (s) of four months: the run goes on until somebody ends it.
inline constexpr double kUntilEnded = 1e7;

struct Experiment {
  // written in experiment.cc: as inline functions they would be compiled again in every file that holds an experiment
  Experiment();
  ~Experiment();
  Experiment(const Experiment&);
  Experiment(Experiment&&) noexcept;
  Experiment& operator=(const Experiment&);
  Experiment& operator=(Experiment&&) noexcept;

  std::string name;      ///< of the run; the file's name without .yaml unless given
  int64_t seed = 0;      ///< of all random numbers
  double ready = 10;     ///< s of wall time for all processes to become READY
  double deadline = 10;  ///< s of wall time without progress that end the run

  struct Robot {
    std::string
        model;  ///< builtin:manipulator, builtin:humanoid, a file, package://...; "urdf" = text is separate
    JointValues armature;                ///< kg m2 (kg): rotor inertia, known to every process
    bool mimic = true;                   ///< false: mimic joints are free
    bool floating_base = false;          ///< true: the root link floats
    std::map<std::string, double> lock;  ///< joint: where it is welded, rad, m
    bool operator==(const Robot&) const = default;
  } robot;

  struct Simulator {
    double dt = 0.001;    ///< s
    double duration = 1;  ///< s
    std::string clock = "lockstep";
    std::string integrator = "semi_implicit_euler";  ///< or rk4
    JointValues q0;                                  ///< rad, m; neutral
    JointValues v0;                                  ///< rad/s, m/s; 0
    JointValues damping;                             ///< Nm s/rad, N s/m
    JointValues friction;                            ///< Nm, N
    std::array<double, 3> gravity{0, 0, -9.81};      ///< m/s2
    bool allow_fall = false;
    struct Noise {
      JointValues q, v;  ///< standard deviation of the sensors' noise: rad, m; rad/s, m/s
      bool operator==(const Noise&) const = default;
    } noise;
    double delay = 0;  ///< s: age of the sensor values
    std::vector<PlannedPush> pushes;
    std::vector<PlannedPayload> payloads;
    struct LimitRepulsion {
      JointValues stiffness;  ///< Nm/rad, N/m; 0 = off
      JointValues damping;    ///< Nm s/rad, N s/m, at the limit
      JointValues margin;     ///< rad, m: how far before the limit it begins
      bool operator==(const LimitRepulsion&) const = default;
    } limit_repulsion;
    bool operator==(const Simulator&) const = default;
  } simulator;

  struct Planner {
    std::string kind = "hold";
    JointValues goal;       ///< rad, m
    double duration = 0;    ///< s; 0 = the shortest; the reader sets it to the simulator's unless given
    JointValues offset;     ///< rad, m; q0
    JointValues amplitude;  ///< rad, m
    JointValues frequency;  ///< rad/s; 1 + 0.3 i
    JointValues phase;      ///< rad
    std::vector<JointValues> targets;             ///< rad, m: of point_to_point, waypoints
    std::vector<double> times;                    ///< s, rising: of waypoints; none = the shortest
    double dwell = 0.5;                           ///< s of rest at each target
    bool cycle = true;                            ///< from the last target back to the first
    double speed = 0.5;                           ///< share of the joints' speed limits
    JointValues acceleration;                     ///< rad/s2, m/s2; no bound
    std::string frame;                            ///< of line, circle
    std::optional<std::array<double, 3>> to;      ///< m: where a line ends
    std::optional<std::array<double, 3>> center;  ///< m: a point of a circle's axis
    std::array<double, 3> normal{0, 0, 1};        ///< along that axis
    double turns = 1;
    bool keep_orientation = false;  ///< of the frame on a line, circle
    int64_t lead = 4;               ///< steps that references run ahead
    bool operator==(const Planner&) const = default;
  } planner;

  struct Controller : GainValues<JointValues> {
    std::string kind = "pd";
    std::string frame;  ///< the tool of cartesian_impedance
    int64_t every = 1;  ///< steps between commands
    bool limit_effort = false;
    struct OwnModel {                                          ///< errors of the controller's model
      double mass_scale = 1;                                   ///< every mass and inertia times this
      std::map<std::string, std::array<double, 3>> com_shift;  ///< body: m, in its axes
      std::vector<std::string> without;                        ///< bodies that it does not know
      bool operator==(const OwnModel&) const = default;
    } model;
    bool operator==(const Controller&) const = default;
  } controller;

  struct Logger {
    int64_t every = 1;  ///< steps between logged steps
    bool operator==(const Logger&) const = default;
  } logger;

  struct Renderer {
    bool enabled = true;
    double fps = 20;  ///< pictures per second of simulation time
    std::array<int64_t, 2> size{640, 480};
    std::string camera = "iso";
    bool orthographic = false;  ///< no perspective
    double orbit = 0;           ///< rad/s: the camera circles the robot
    std::string follow;         ///< frame that the camera moves with
    std::string quality = "live";
    int64_t ghost = 0;       ///< poses in ghost.png; 0 = no such picture
    std::string trace;       ///< frame whose trajectory is drawn
    bool reference = false;  ///< the reference is drawn too
    bool operator==(const Renderer&) const = default;
  } renderer;

  struct Faults {
    double drop = 0;  ///< percent of incoming packets that every process loses on purpose
    bool operator==(const Faults&) const = default;
  } faults;

  struct Safety {
    double timeout = 0.02;         ///< s: an older command is stale (real time)
    std::string hold = "gravity";  ///< or damping: what the robot does while held
    std::string rearm = "auto";    ///< or manual
    bool operator==(const Safety&) const = default;
  } safety;

  struct Evaluation {
    double band = 0.01;  ///< rad, m: within this error a joint counts as settled
    std::string frame;   ///< whose errors are the tool's; empty = the last link
    bool operator==(const Evaluation&) const = default;
  } evaluation;

  std::map<std::string, std::string> processes;  ///< name: command that replaces the default one
  std::map<std::string, Bound> expect;           ///< metric: bound

  /// Where each given key stands ("FILE:LINE" or "--set"), for messages; `file` for the rest.
  std::map<std::string, std::string> where;
  std::string file;

  /// In real time and until it is ended; the motion keeps its duration.
  void keep_running();
  bool runs_until_ended() const { return simulator.duration >= kUntilEnded; }
  /// Number of the last step.
  int64_t last_step() const;
  /// Compares all values, but not `where` and `file`, which are about the text.
  bool operator==(const Experiment& other) const;
};

/// Throws ExperimentError "WHERE: key: message".
[[noreturn]] void fail(const Experiment&, const std::string& key, const std::string& message);

/// "; did you mean 'x'?" for the candidate nearest to `word`, or "" if none is near.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

/// "a, b, c"
std::string list_of(const std::vector<std::string>& words);

}  // namespace lab
