// The motions that an experiment can ask for, each a function of its own time. A new one is a struct that holds its own
// keys and one row of the table, both in motions.cc.
#pragma once
#include <rbd/model/model.h>

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

namespace lab::planner {

struct Config;

/// A motion, const once made: q, v and a as functions of time.
struct Motion {
  virtual ~Motion() = default;

  /// Writes q, v, a wanted at time t (s) after the start. The vectors have their sizes.
  virtual void at(double t, Reference&) const = 0;
  /// Motion time, t or later, at which a robot that was diverted at t rejoins: the next target of point_to_point and
  /// waypoints, where a path was left. None: wherever the motion is by then.
  virtual std::optional<double> rejoin_time(double) const { return {}; }

  double duration = 0;         ///< s until it rests for good, where it does
  bool chosen_time = false;    ///< the planner has chosen the duration
  Eigen::VectorXd peak_speed;  ///< nv: largest of each joint
};

struct Kind {
  const char* name;
  const char* what;
  /// Reads the kind's own keys; the config's common part is there already. Throws ExperimentError.
  std::unique_ptr<Motion> (*make)(const Experiment&, const Config&);
  /// What to do when it is faster than the joints can move; empty for those that never are.
  const char* cure;
};

/// hold, cubic, quintic, sinusoid, point_to_point, waypoints, line, circle.
std::span<const Kind> kinds();

/// What all motions share.
struct Config {
  const Kind* kind = nullptr;
  double dt = 0;       ///< s
  double speed = 0.5;  ///< share of v_max that is used where the planner chooses the time
  int nv = 0;
  bool floating = false;
  rbd::Model model;              ///< for goals of frames
  Eigen::VectorXd v_max;         ///< nv: rad/s, m/s; 1 where the model has no limit
  Eigen::VectorXd a_max;         ///< nv: rad/s2, m/s2; infinite where there is no bound
  Eigen::VectorXd q_min, q_max;  ///< nq
  Eigen::VectorXd q0;            ///< nq
  std::shared_ptr<const Motion> motion;
};

/// Throws ExperimentError: unknown kind, no goal or target, a motion beyond the joint limits, a path that the arm cannot
/// follow, a floating base that cannot move yet.
Config make_config(const Experiment&, const rbd::Model&);

inline constexpr double kMinTime = 0.5;  // s: the shortest motion and ramp

/// s that a quintic from rest to rest takes without any joint beyond the share `speed` of its limit, or beyond a_max; at
/// least kMinTime.
double quintic_time(const Config&, const Eigen::VectorXd& from, const Eigen::VectorXd& to);

/// The time that a motion needs which within 1 s would reach these speeds and accelerations: speeds fall with the time,
/// accelerations with its square. At least kMinTime.
double shortest_time(const Config&, const Eigen::VectorXd& speeds, const Eigen::VectorXd& accelerations);

/// q, at rest.
void stay(const Eigen::VectorXd& q, Reference& out);

}  // namespace lab::planner
