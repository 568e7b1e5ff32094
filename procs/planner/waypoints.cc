#include "procs/planner/waypoints.h"

#include <cmath>

#include "core/util/number.h"
#include "lab/experiment/joints.h"

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

/// Arrival times but for a common factor: each piece takes what its slowest joint needs at its speed limit, the first and
/// the last twice as long, for who speeds up from rest to v without a jump of the acceleration gets on by v t / 2.
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

void check_limits(const Experiment& e, const rbd::Model& model, const Config& config) {
  const Outside found = outside(config.path, config.q_min, config.q_max);
  if (found.joint < 0) return;
  fail(e, place("targets", found.piece),
       "joint '" + joint_at(model, static_cast<int>(found.joint)) + "' would swing out to " +
           rounded(found.value) + " on the way there (at " + rounded(found.at) + " s); its limit is " +
           number(found.limit) + "; put a target between, or move those around it");
}

}  // namespace

void prepare_waypoints(const Experiment& e, const rbd::Model& model, Config& config) {
  if (e.planner.targets.empty()) fail(e, "planner.targets", "is missing; waypoints needs at least one");
  std::vector<Eigen::VectorXd> points{config.q0};
  for (const JointValues& target : e.planner.targets)
    points.push_back(configuration(e, place("targets", points.size() - 1), target, model, config.q0));
  config.own_time = e.planner.times.empty();
  config.path =
      through(config.own_time ? relative_times(e, config, points) : given_times(e), points, Ends::Rest);
  if (config.own_time) {
    config.path.stretch(1 / config.path.end());
    config.path.stretch(shortest_time(config, largest(config.path, 1), largest(config.path, 2)));
  }
  check_limits(e, model, config);
  config.goal = points.back();
  config.duration = config.path.end();
  config.v_peak = largest(config.path, 1);
}

void waypoints(const Config& c, double t, Reference& out) {
  if (t >= c.duration) return stay(c.goal, out);
  c.path.at(t, out.q, out.v, out.a);
}

double next_waypoint(const Config& c, double t) {
  for (const Spline::Piece& piece : c.path.pieces)
    if (piece.start + piece.length >= t) return piece.start + piece.length;
  return t;
}

}  // namespace lab::planner
