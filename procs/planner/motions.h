#pragma once
#include <rbd/model/model.h>

#include <span>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"
#include "procs/planner/spline.h"

/// The motions that an experiment can ask for, each a law of its own time. A new kind is two functions and one line in
/// kinds().
namespace lab::planner {

struct Config;

/// Writes q, v, a wanted at time t (s) after the start.
using Law = void (*)(const Config&, double t, Reference&);

struct Kind {
  const char* name;
  const char* what;
  /// Reads the kind's own keys into the config, whose common part is there already. Throws ExperimentError.
  void (*prepare)(const Experiment&, const rbd::Model&, Config&);
  Law law;
  /// Who was led away at time t comes back to the motion at this time of it, t or later: point_to_point and waypoints at
  /// the next target, a path where it was left. Null: wherever it is by then.
  double (*comes_back)(const Config&, double t);
  /// What to do when it is faster than the joints can move; empty for those that never are.
  const char* cure;
};

/// hold, cubic, quintic, sinusoid, point_to_point, waypoints, line, circle.
std::span<const Kind> kinds();

struct Config {
  const Kind* kind = nullptr;
  double dt = 0;          ///< s
  double duration = 0;    ///< s, of the way to the goal
  bool own_time = false;  ///< the planner has chosen how long the motion takes
  double speed = 0.5;     ///< share of v_max that ways of our own choice use
  int nv = 0;
  bool floating = false;
  rbd::Model model;              ///< for goals of frames
  Eigen::VectorXd v_max;         ///< nv: rad/s, m/s; 1 where the model has no limit
  Eigen::VectorXd a_max;         ///< nv: rad/s2, m/s2; infinite where there is no bound
  Eigen::VectorXd v_peak;        ///< nv: largest speed of the motion
  Eigen::VectorXd q_min, q_max;  ///< nq
  Eigen::VectorXd q0, goal;      ///< nq
  Eigen::VectorXd offset, amplitude, frequency, phase;  ///< nv, of sinusoid

  /// point_to_point: a way from rest to rest, then a rest until the next one starts.
  struct Leg {
    double start, duration;    ///< s; 0 if there is no way to go
    Eigen::VectorXd from, to;  ///< nq
  };
  std::vector<Leg> legs;  ///< the first from q0, then one to each target
  double first_round = 0,
         round = 0;  ///< s: when the legs after the first begin, and begin anew; round 0 = once
  Spline path;       ///< waypoints: by time; line, circle: by the share of the way
};

/// Throws ExperimentError: unknown kind, no goal or target, a motion beyond the joint limits, a path that the arm cannot
/// follow, a floating base that should move.
Config make_config(const Experiment&, const rbd::Model&);

inline constexpr double kLeast = 0.5;  // s: the shortest way and ramp

/// s = 10 x^3 - 15 x^4 + 6 x^5 of the share x of the time: from rest to rest, acceleration zero at both ends too.
struct Progress {
  double s, rate, acceleration;  ///< and derivatives by time
};
Progress quintic_progress(double t, double T);
inline constexpr double kQuinticPeak = 1.875;  // its largest speed, of way / duration
inline constexpr double kQuinticPush =
    5.773502691896258;  // its largest acceleration, of way / duration^2: 10 / sqrt(3)

/// s that a quintic from rest to rest takes without any joint beyond the share `speed` of its limit, or beyond a_max; at
/// least kLeast.
double shortest_way(const Config&, const Eigen::VectorXd& from, const Eigen::VectorXd& to);

/// The time that a motion needs which within 1 s would reach these speeds and accelerations: speeds fall with the time,
/// accelerations with its square. At least kLeast.
double shortest_time(const Config&, const Eigen::VectorXd& speeds, const Eigen::VectorXd& accelerations);

/// q, at rest.
void stay(const Eigen::VectorXd& q, Reference& out);

}  // namespace lab::planner
