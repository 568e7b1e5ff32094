#include "procs/planner/waypoints.h"

#include <cmath>

#include "core/util/number.h"
#include "lab/experiment/joints.h"
#include "procs/planner/spline.h"

namespace lab::planner {
namespace {

std::string place(const char* list, size_t k) {
  return std::string("planner.") + list + "[" + std::to_string(k) + "]";
}

/// The arrival times that were given.
std::vector<double> given_times(const Experiment& e) {
  const std::vector<double>& times = e.planner.times;
  if (times.size() != e.planner.targets.size())
    fail(e, "planner.times",
         "has " + std::to_string(times.size()) + " numbers, but there are " +
             std::to_string(e.planner.targets.size()) + " targets; give one per target");
  std::vector<double> knots{0};
  for (size_t k = 0; k < times.size(); ++k) {
    if (!(times[k] > knots.back()))
      fail(e, place("times", k),
           number(times[k]) + " s is not after " + number(knots.back()) +
               " s; times count from the start and must rise");
    knots.push_back(times[k]);
  }
  return knots;
}

/// Arrival times up to a common factor: each piece takes what its slowest joint needs at its speed limit, the first and
/// the last twice as long, since a joint that speeds up smoothly from rest to v within t moves by v t / 2.
std::vector<double> relative_times(const Experiment& e, const Config& config,
                                   const std::vector<Eigen::VectorXd>& points) {
  std::vector<double> knots{0};
  for (size_t k = 0; k + 1 < points.size(); ++k) {
    double need = 0;
    for (Eigen::Index i = 0; i < points[k].size(); ++i)
      need = std::max(need, std::abs(points[k + 1][i] - points[k][i]) / config.v_max[i]);
    if (need < 1e-9)
      fail(e, place("targets", k),
           "is where the robot is already, and waypoints do not rest; leave it out, give planner.times, or "
           "use point_to_point");
    knots.push_back(knots.back() + need * (k == 0 || k + 2 == points.size() ? 2 : 1));
  }
  return knots;
}

struct Waypoints : Motion {
  Waypoints(const Experiment& e, const Config& c) {
    if (e.planner.targets.empty()) fail(e, "planner.targets", "is missing; waypoints needs at least one");
    std::vector<Eigen::VectorXd> points{c.q0};
    for (const JointValues& target : e.planner.targets)
      points.push_back(configuration(e, place("targets", points.size() - 1), target, c.model, c.q0));
    chosen_time = e.planner.times.empty();
    path = through(chosen_time ? relative_times(e, c, points) : given_times(e), points, Ends::Rest);
    if (chosen_time) {
      path.stretch(1 / path.end());
      path.stretch(shortest_time(c, largest(path, 1), largest(path, 2)));
    }
    check_limits(e, c);
    last = points.back();
    duration = path.end();
    peak_speed = largest(path, 1);
  }

  void check_limits(const Experiment& e, const Config& c) const {
    const Outside found = outside(path, c.q_min, c.q_max);
    if (found.joint < 0) return;
    fail(e, place("targets", found.piece),
         "joint '" + joint_at(c.model, static_cast<int>(found.joint)) + "' would swing out to " +
             rounded(found.value) + " on the way there (at " + rounded(found.at) + " s); its limit is " +
             number(found.limit) + "; put a target between, or move those around it");
  }

  void at(double t, Reference& out) const override {
    if (t >= duration) return stay(last, out);
    path.at(t, out.q, out.v, out.a);
  }
  std::optional<double> rejoin_time(double t) const override {
    for (const Spline::Piece& piece : path.pieces)
      if (piece.end() >= t) return piece.end();
    return t;
  }

  Spline path;  // by time
  Eigen::VectorXd last;
};

}  // namespace

std::unique_ptr<Motion> make_waypoints(const Experiment& e, const Config& config) {
  return std::make_unique<Waypoints>(e, config);
}

}  // namespace lab::planner
