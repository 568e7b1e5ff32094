// The motions that an experiment can choose, each a function of its own time (0 at its start). To add one, write a
// struct that holds its own keys and one row of the table, both in motions.cc.
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

  /// Writes the reference q, v, a at time t (s) after the start. Its vectors must have their sizes already.
  virtual void at(double t, Reference&) const = 0;
  /// Motion time at which a robot that left the motion at t rejoins it: the next target of point_to_point and
  /// waypoints, t itself for a path. None: at the motion's time when the way back ends.
  virtual std::optional<double> rejoin_time(double) const { return {}; }

  double duration = 0;         ///< s until it ends at rest; unused by motions that never end
  bool chosen_time = false;    ///< the planner has chosen the duration
  Eigen::VectorXd peak_speed;  ///< nv: peak speed of each joint
};

struct Kind {
  const char* name;
  const char* what;
  /// Reads the kind's own keys; the config's common part is already set. Throws ExperimentError.
  std::unique_ptr<Motion> (*make)(const Experiment&, const Config&);
  /// Advice in the warning when it exceeds the joints' speed limits; empty for kinds that never do.
  const char* cure;
  /// The keys of its own that it reads, without "planner.", blanks between.
  const char* keys;
};

/// hold, cubic, quintic, sinusoid, point_to_point, waypoints, line, circle.
std::span<const Kind> kinds();

/// What all motions share.
struct Config {
  const Kind* kind = nullptr;
  double dt = 0;       ///< s
  double speed = 0.5;  ///< fraction of v_max that is used where the planner chooses the duration
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

/// Shortest duration (s) of a quintic from rest to rest with every joint within the fraction `speed` of v_max and within
/// a_max; at least kMinTime.
double quintic_time(const Config&, const Eigen::VectorXd& from, const Eigen::VectorXd& to);

/// The same for a motion whose peak speeds and accelerations are these if it lasts 1 s: with duration T, speeds are
/// divided by T and accelerations by T^2. At least kMinTime.
double shortest_time(const Config&, const Eigen::VectorXd& speeds, const Eigen::VectorXd& accelerations);

/// Writes the reference at rest: q, with v and a zero.
void stay(const Eigen::VectorXd& q, Reference& out);

}  // namespace lab::planner
