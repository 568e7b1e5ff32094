#include "procs/planner/motions.h"

#include <rbd/algorithm/configuration.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/util/number.h"
#include "lab/experiment/joints.h"
#include "procs/planner/cartesian_path.h"
#include "procs/planner/spline.h"
#include "procs/planner/waypoints.h"

namespace lab::planner {
namespace {

/// Any motion, from its constructor M(experiment, config).
template <class M>
std::unique_ptr<Motion> make(const Experiment& e, const Config& config) {
  return std::make_unique<M>(e, config);
}

// ---- stays at q0

struct Hold : Motion {
  Hold(const Experiment&, const Config& c) : q0(c.q0) { peak_speed.setZero(c.nv); }
  void at(double, Reference& out) const override { stay(q0, out); }

  Eigen::VectorXd q0;
};

// ---- from rest at q0 to rest at planner.goal

struct Reach : Motion {
  /// For a law with these peaks of speed (of distance / duration) and acceleration (of distance / duration^2).
  Reach(const Experiment& e, const Config& c, double speed, double acceleration) : q0(c.q0) {
    if (!e.planner.goal.given())
      fail(e, "planner.goal", std::string("is missing; a ") + c.kind->name + " needs one");
    goal = configuration(e, "planner.goal", e.planner.goal, c.model, q0);
    const Eigen::VectorXd distance = (goal - q0).cwiseAbs();
    chosen_time = e.planner.duration == 0;
    duration = chosen_time ? shortest_time(c, speed * distance, acceleration * distance) : e.planner.duration;
    peak_speed = speed / duration * distance;
  }

  Eigen::VectorXd q0, goal;
};

// s = 3 x^2 - 2 x^3: the acceleration jumps at both ends
struct Cubic : Reach {
  Cubic(const Experiment& e, const Config& c) : Reach(e, c, 1.5, 6) {}
  void at(double t, Reference& out) const override {
    const double T = duration, x = t / T;
    if (x > 1) return stay(goal, out);
    const double s = x * x * (3 - 2 * x), rate = 6 * x * (1 - x) / T, acceleration = (6 - 12 * x) / (T * T);
    for (Eigen::Index i = 0; i < q0.size(); ++i) {
      const double distance = goal[i] - q0[i];
      out.q[i] = q0[i] + s * distance;
      out.v[i] = rate * distance;
      out.a[i] = acceleration * distance;
    }
  }
};

struct Quintic : Reach {
  Quintic(const Experiment& e, const Config& c)
      : Reach(e, c, kQuinticSpeed, kQuinticAcceleration), path(quintic(0, duration, q0, goal)) {}
  void at(double t, Reference& out) const override {
    if (t >= duration) return stay(goal, out);
    path.at(t, out.q, out.v, out.a);
  }

  Spline::Piece path;
};

// ---- every joint swings for ever

struct Sinusoid : Motion {
  Sinusoid(const Experiment& e, const Config& c) {
    const rbd::Model& model = c.model;
    Eigen::VectorXd one_and_more(model.nv);
    for (int i = 0; i < model.nv; ++i) one_and_more[i] = 1 + 0.3 * i;
    offset = configuration(e, "planner.offset", e.planner.offset, model, c.q0);
    amplitude = joint_vector(e, "planner.amplitude", e.planner.amplitude, model, 0);
    frequency = joint_vector(e, "planner.frequency", e.planner.frequency, model, one_and_more);
    phase = joint_vector(e, "planner.phase", e.planner.phase, model, 0);
    peak_speed = amplitude.cwiseAbs().cwiseProduct(frequency.cwiseAbs());
    for (int i = 0; i < model.nv; ++i) {
      const double reach = std::abs(amplitude[i]), low = model.lowerPositionLimit[i],
                   high = model.upperPositionLimit[i];
      if (offset[i] - reach < low || offset[i] + reach > high)
        fail(e, "planner.amplitude",
             "joint '" + joint_at(model, i) + "' would swing over " + number(offset[i] - reach) + " .. " +
                 number(offset[i] + reach) + "; its limits are " + number(low) + " .. " + number(high));
    }
  }
  void at(double t, Reference& out) const override {
    for (Eigen::Index i = 0; i < offset.size(); ++i) {
      const double A = amplitude[i], w = frequency[i], angle = w * t + phase[i];
      out.q[i] = offset[i] + A * std::sin(angle);
      out.v[i] = A * w * std::cos(angle);
      out.a[i] = -A * w * w * std::sin(angle);
    }
  }

  Eigen::VectorXd offset, amplitude, frequency, phase;  // nv
};

// ---- from target to target along quintics, with a rest at each: one spline, rests are pieces of it

struct PointToPoint : Motion {
  PointToPoint(const Experiment& e, const Config& c) : last(c.q0) {
    peak_speed.setZero(c.nv);
    if (e.planner.targets.empty())
      fail(e, "planner.targets", "is missing; point_to_point needs at least one");
    std::vector<Eigen::VectorXd> stops;
    for (const JointValues& target : e.planner.targets)
      stops.push_back(
          configuration(e, "planner.targets[" + std::to_string(stops.size()) + "]", target, c.model, c.q0));
    const bool cycle = e.planner.cycle && stops.size() > 1;
    if (cycle) stops.push_back(stops.front());
    double start = 0;
    for (const Eigen::VectorXd& stop : stops) {
      const double travel = last == stop ? 0 : quintic_time(c, last, stop);
      if (travel > 0) {
        path.pieces.push_back(quintic(start, travel, last, stop));
        peak_speed = peak_speed.cwiseMax(kQuinticSpeed / travel * (stop - last).cwiseAbs());
      }
      arrivals.push_back(start + travel);
      if (e.planner.dwell > 0) path.pieces.push_back(quintic(arrivals.back(), e.planner.dwell, stop, stop));
      start += travel + e.planner.dwell;
      last = stop;
      if (arrivals.size() == 1) first_round = start;
    }
    if (cycle) round = start - first_round;
  }

  void at(double t, Reference& out) const override {
    t = in_first_round(t);
    if (path.pieces.empty() || t >= path.end()) return stay(last, out);
    path.at(t, out.q, out.v, out.a);
  }
  std::optional<double> rejoin_time(double t) const override {
    const auto next = std::lower_bound(arrivals.begin(), arrivals.end(), in_first_round(t));
    if (next != arrivals.end()) return *next;
    return round > 0 ? arrivals[1] : arrivals.back();
  }
  double in_first_round(double t) const {
    return round > 0 && t > first_round + round ? first_round + std::fmod(t - first_round, round) : t;
  }

  Spline path;
  std::vector<double> arrivals;  // s: at each target
  double first_round = 0,
         round = 0;  // s: when the way to the second target begins, and begins anew; 0 = once
  Eigen::VectorXd last;
};

// ---- all of them

constexpr const char* kLonger = "give planner.duration more time, or 0 to take the shortest";
constexpr Kind kKinds[] = {
    {"hold", "stays at q0", make<Hold>, "", ""},
    {"cubic", "from rest at q0 to rest at the goal", make<Cubic>, kLonger, "goal duration"},
    {"quintic", "the same, without a jump of the acceleration", make<Quintic>, kLonger, "goal duration"},
    {"sinusoid", "every joint swings", make<Sinusoid>, "lower planner.amplitude or planner.frequency",
     "offset amplitude frequency phase"},
    {"point_to_point", "from target to target, with a rest at each", make<PointToPoint>, "",
     "targets dwell cycle"},
    {"waypoints", "through targets without a rest", make_waypoints,
     "give planner.times more time, or leave them out", "targets times"},
    {"line", "a frame along a straight line", make_line, kLonger, "frame to duration keep_orientation"},
    {"circle", "a frame round an axis", make_circle, kLonger,
     "frame center normal turns duration keep_orientation"},
};

const Kind& find_kind(const Experiment& e) {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) {
    if (e.planner.kind == kind.name) return kind;
    names.push_back(kind.name);
  }
  fail(e, "planner.kind", "'" + e.planner.kind + "' is not known; use one of " + list_of(names));
}

}  // namespace

std::span<const Kind> kinds() { return kKinds; }

double shortest_time(const Config& c, const Eigen::VectorXd& speeds, const Eigen::VectorXd& accelerations) {
  double T = kMinTime;
  for (Eigen::Index i = 0; i < speeds.size(); ++i)
    T = std::max({T, speeds[i] / (c.speed * c.v_max[i]), std::sqrt(accelerations[i] / c.a_max[i])});
  return T;
}

double quintic_time(const Config& c, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  const Eigen::VectorXd distance = (to - from).cwiseAbs();
  return shortest_time(c, kQuinticSpeed * distance, kQuinticAcceleration * distance);
}

void stay(const Eigen::VectorXd& q, Reference& out) {
  out.q = q;
  out.v.setZero();
  out.a.setZero();
}

Config make_config(const Experiment& e, const rbd::Model& model) {
  Config config;
  config.kind = &find_kind(e);
  config.dt = e.simulator.dt;
  config.speed = e.planner.speed;
  config.nv = model.nv;
  config.floating = floats(model);
  config.model = model;
  config.q_min = model.lowerPositionLimit;
  config.q_max = model.upperPositionLimit;
  config.v_max.resize(model.nv);
  for (int i = 0; i < model.nv; ++i)
    config.v_max[i] = std::isfinite(model.upperVelocityLimit[i]) && model.upperVelocityLimit[i] > 0
                          ? model.upperVelocityLimit[i]
                          : 1;
  config.a_max = joint_vector(e, "planner.acceleration", e.planner.acceleration, model,
                              std::numeric_limits<double>::infinity());
  config.q0 = configuration(e, "simulator.q0", e.simulator.q0, model, rbd::neutral(model));
  if (floats(model) && config.kind->make != make<Hold>)
    fail(e, "planner.kind", "'" + model.name + "' floats; only hold is possible for now");
  config.motion = config.kind->make(e, config);
  return config;
}

}  // namespace lab::planner
