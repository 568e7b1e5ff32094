#include "procs/planner/motions.h"

#include <rbd/algorithm/configuration.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/util/number.h"
#include "lab/experiment/joints.h"
#include "procs/planner/cartesian_path.h"
#include "procs/planner/waypoints.h"

namespace lab::planner {
namespace {

/// q = from + s (to - from), with s and its derivatives.
void along_the_line(const Eigen::VectorXd& from, const Eigen::VectorXd& to, const Progress& p,
                    Reference& out) {
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const double way = to[i] - from[i];
    out.q[i] = from[i] + p.s * way;
    out.v[i] = p.rate * way;
    out.a[i] = p.acceleration * way;
  }
}

// ---- stays at q0

void prepare_hold(const Experiment&, const rbd::Model&, Config&) {}

void hold(const Config& c, double, Reference& out) { stay(c.q0, out); }

// ---- from rest at q0 to rest at the goal

/// The goal; the duration, if it is to be the shortest, of a law with these peaks of speed (of way / duration) and
/// acceleration (of way / duration^2).
void set_reach(const Experiment& e, const rbd::Model& model, Config& config, double peak, double push) {
  if (!e.planner.goal.given())
    fail(e, "planner.goal", std::string("is missing; a ") + config.kind->name + " needs one");
  config.goal = configuration(e, "planner.goal", e.planner.goal, model, config.q0);
  const Eigen::VectorXd way = (config.goal - config.q0).cwiseAbs();
  if (config.own_time) config.duration = shortest_time(config, peak * way, push * way);
  config.v_peak = peak / config.duration * way;
}

// s = 3 x^2 - 2 x^3: the acceleration jumps at both ends
void prepare_cubic(const Experiment& e, const rbd::Model& model, Config& config) {
  set_reach(e, model, config, 1.5, 6);
}

void cubic(const Config& c, double t, Reference& out) {
  const double T = c.duration, x = t / T;
  if (x > 1) return stay(c.goal, out);
  along_the_line(c.q0, c.goal, {x * x * (3 - 2 * x), 6 * x * (1 - x) / T, (6 - 12 * x) / (T * T)}, out);
}

void prepare_quintic(const Experiment& e, const rbd::Model& model, Config& config) {
  set_reach(e, model, config, kQuinticPeak, kQuinticPush);
}

void quintic(const Config& c, double t, Reference& out) {
  if (t > c.duration) return stay(c.goal, out);
  along_the_line(c.q0, c.goal, quintic_progress(t, c.duration), out);
}

// ---- every joint swings for ever

void prepare_sinusoid(const Experiment& e, const rbd::Model& model, Config& config) {
  Eigen::VectorXd one_and_more(model.nv);
  for (int i = 0; i < model.nv; ++i) one_and_more[i] = 1 + 0.3 * i;
  config.offset = configuration(e, "planner.offset", e.planner.offset, model, config.q0);
  config.amplitude = joint_vector(e, "planner.amplitude", e.planner.amplitude, model, 0);
  config.frequency = joint_vector(e, "planner.frequency", e.planner.frequency, model, one_and_more);
  config.phase = joint_vector(e, "planner.phase", e.planner.phase, model, 0);
  for (int i = 0; i < model.nv; ++i) {
    const double reach = std::abs(config.amplitude[i]), low = model.lowerPositionLimit[i],
                 high = model.upperPositionLimit[i];
    config.v_peak[i] = reach * std::abs(config.frequency[i]);
    if (config.offset[i] - reach < low || config.offset[i] + reach > high)
      fail(e, "planner.amplitude",
           "joint '" + joint_at(model, i) + "' would swing over " + number(config.offset[i] - reach) +
               " .. " + number(config.offset[i] + reach) + "; its limits are " + number(low) + " .. " +
               number(high));
  }
}

void sinusoid(const Config& c, double t, Reference& out) {
  for (Eigen::Index i = 0; i < c.offset.size(); ++i) {
    const double A = c.amplitude[i], w = c.frequency[i], angle = w * t + c.phase[i];
    out.q[i] = c.offset[i] + A * std::sin(angle);
    out.v[i] = A * w * std::cos(angle);
    out.a[i] = -A * w * w * std::sin(angle);
  }
}

// ---- from target to target along the quintic, with a rest at each

void prepare_cycle(const Experiment& e, const rbd::Model& model, Config& config) {
  if (e.planner.targets.empty()) fail(e, "planner.targets", "is missing; point_to_point needs at least one");
  std::vector<Eigen::VectorXd> stops;
  for (const JointValues& target : e.planner.targets)
    stops.push_back(
        configuration(e, "planner.targets[" + std::to_string(stops.size()) + "]", target, model, config.q0));
  const size_t first = stops.size();
  if (e.planner.cycle && first > 1) stops.push_back(stops.front());  // and so round and round
  double start = 0;
  Eigen::VectorXd at = config.q0;
  for (const Eigen::VectorXd& stop : stops) {
    const double duration = at == stop ? 0 : shortest_way(config, at, stop);
    config.legs.push_back({start, duration, at, stop});
    if (duration > 0)
      config.v_peak = config.v_peak.cwiseMax(kQuinticPeak / duration * (stop - at).cwiseAbs());
    start += duration + e.planner.dwell;
    at = stop;
  }
  if (stops.size() == first) return;
  config.first_round = config.legs[1].start;
  config.round = start - config.first_round;
}

/// The leg that time t falls into; brings t into the first round.
const Config::Leg& leg_at(const Config& c, double& t) {
  if (c.round > 0 && t > c.first_round + c.round) t = c.first_round + std::fmod(t - c.first_round, c.round);
  auto next = std::upper_bound(c.legs.begin(), c.legs.end(), t,
                               [](double time, const Config::Leg& leg) { return time < leg.start; });
  return *(next == c.legs.begin() ? next : next - 1);
}

void point_to_point(const Config& c, double t, Reference& out) {
  const Config::Leg& leg = leg_at(c, t);
  if (!(t - leg.start < leg.duration)) return stay(leg.to, out);
  along_the_line(leg.from, leg.to, quintic_progress(t - leg.start, leg.duration), out);
}

double next_arrival(const Config& c, double t) {
  const Config::Leg* leg = &leg_at(c, t);
  if (t > leg->start + leg->duration && leg != &c.legs.back())
    ++leg;
  else if (t > leg->start + leg->duration && c.round > 0)
    leg = &c.legs[1];
  return leg->start + leg->duration;
}

// ---- all of them

double where_it_was(const Config&, double t) { return t; }

constexpr const char* kLonger = "give planner.duration more time, or 0 to take the shortest";
constexpr Kind kKinds[] = {
    {"hold", "stays at q0", prepare_hold, hold, nullptr, ""},
    {"cubic", "from rest at q0 to rest at the goal", prepare_cubic, cubic, nullptr, kLonger},
    {"quintic", "the same, without a jump of the acceleration", prepare_quintic, quintic, nullptr, kLonger},
    {"sinusoid", "every joint swings", prepare_sinusoid, sinusoid, nullptr,
     "lower planner.amplitude or planner.frequency"},
    {"point_to_point", "from target to target, with a rest at each", prepare_cycle, point_to_point,
     next_arrival, ""},
    {"waypoints", "through targets without a rest", prepare_waypoints, waypoints, next_waypoint,
     "give planner.times more time, or leave them out"},
    {"line", "a frame along a straight line", prepare_line, along_path, where_it_was, kLonger},
    {"circle", "a frame round an axis", prepare_circle, along_path, where_it_was, kLonger},
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

Progress quintic_progress(double t, double T) {
  const double x = t / T;
  return {x * x * x * (10 + x * (6 * x - 15)), 30 * x * x * (1 - x) * (1 - x) / T,
          60 * x * (1 - x) * (1 - 2 * x) / (T * T)};
}

double shortest_time(const Config& c, const Eigen::VectorXd& speeds, const Eigen::VectorXd& accelerations) {
  double T = kLeast;
  for (Eigen::Index i = 0; i < speeds.size(); ++i)
    T = std::max({T, speeds[i] / (c.speed * c.v_max[i]), std::sqrt(accelerations[i] / c.a_max[i])});
  return T;
}

double shortest_way(const Config& c, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  const Eigen::VectorXd way = (to - from).cwiseAbs();
  return shortest_time(c, kQuinticPeak * way, kQuinticPush * way);
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
  config.duration = e.planner.duration;
  config.own_time = e.planner.duration == 0;
  config.speed = e.planner.speed;
  config.nv = model.nv;
  config.floating = floats(model);
  config.model = model;
  config.q_min = model.lowerPositionLimit, config.q_max = model.upperPositionLimit;
  config.v_max.resize(model.nv);
  for (int i = 0; i < model.nv; ++i)
    config.v_max[i] = std::isfinite(model.upperVelocityLimit[i]) && model.upperVelocityLimit[i] > 0
                          ? model.upperVelocityLimit[i]
                          : 1;
  config.a_max = joint_vector(e, "planner.acceleration", e.planner.acceleration, model,
                              std::numeric_limits<double>::infinity());
  config.v_peak = Eigen::VectorXd::Zero(model.nv);
  config.q0 = config.goal = configuration(e, "simulator.q0", e.simulator.q0, model, rbd::neutral(model));
  if (floats(model) && config.kind->law != hold)
    fail(e, "planner.kind", "'" + model.name + "' floats; only hold is possible for now");
  config.kind->prepare(e, model, config);
  return config;
}

}  // namespace lab::planner
