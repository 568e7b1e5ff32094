#pragma once
#include <rbd/model/model.h>

#include <span>
#include <vector>

#include "procs/experiment/experiment.h"
#include "procs/signals/signals.h"

/// The motions that an experiment can ask for, each a law of its own time. A new kind is one function and one line in
/// kinds().
namespace lab::planner {

struct Config;

/// Writes q, v, a wanted at time t (s) after the start.
using Law = void (*)(const Config&, double t, Reference&);

struct Kind {
  const char* name;
  const char* what;
  Law law;
  /// The first time from t on at which the motion rests at a target: who was led away comes back there. Null for a motion
  /// that can be met anywhere.
  double (*next_arrival)(const Config&, double t);
};

/// hold, cubic, quintic, sinusoid, point_to_point.
std::span<const Kind> kinds();

struct Config {
  const Kind* kind = nullptr;
  double dt = 0;        ///< s
  double duration = 0;  ///< s, of the way to the goal
  double speed = 0.5;   ///< share of v_max that ways of our own choice use
  int nv = 0;
  bool floating = false;
  rbd::Model model;     ///< for goals of frames
  Eigen::VectorXd v_max;                                ///< nv: rad/s, m/s; 1 where the model has no limit
  Eigen::VectorXd q_min, q_max;                         ///< nq
  Eigen::VectorXd q0, goal;                             ///< nq
  Eigen::VectorXd offset, amplitude, frequency, phase;  ///< nv, of sinusoid

  /// point_to_point: a way from rest to rest, then a rest until the next one starts.
  struct Leg {
    double start, duration;    ///< s; 0 if there is no way to go
    Eigen::VectorXd from, to;  ///< nq
  };
  std::vector<Leg> legs;                ///< the first from q0, then one to each target
  double first_round = 0, round = 0;    ///< s: when the legs after the first begin, and begin anew; round 0 = once
};

/// Throws ExperimentError: unknown kind, no goal or target, a motion beyond the joint limits, a floating base that
/// should move.
Config make_config(const Experiment&, const rbd::Model&);

inline constexpr double kQuinticPeak = 1.875;  // largest speed of a quintic from rest to rest: of way / duration
inline constexpr double kLeast = 0.5;          // s: the shortest way and ramp

/// s that a quintic from rest to rest takes without any joint beyond the share `speed` of its limit; at least kLeast.
double shortest_way(const Config&, const Eigen::VectorXd& from, const Eigen::VectorXd& to);

}  // namespace lab::planner
