#include "procs/planner/planner.h"

#include <rbd/algorithm/configuration.h>

#include <algorithm>
#include <cmath>

#include "procs/experiment/actions.h"
#include "procs/experiment/joints.h"

namespace lab::planner {
namespace {

/// From q0 to the goal: q = q0 + s (goal - q0), with s and its derivatives at time t.
void along_the_line(const Config& c, double s, double rate, double acceleration, Reference& out) {
  for (Eigen::Index i = 0; i < c.q0.size(); ++i) {
    const double way = c.goal[i] - c.q0[i];
    out.q[i] = c.q0[i] + s * way;
    out.v[i] = rate * way;
    out.a[i] = acceleration * way;
  }
}

void stay(const Eigen::VectorXd& q, Reference& out) {
  out.q = q;
  out.v.setZero();
  out.a.setZero();
}

void hold(const Config& c, double, Reference& out) { stay(c.q0, out); }

// s = 3 x^2 - 2 x^3: at rest at both ends, acceleration jumps there
void cubic(const Config& c, double t, Reference& out) {
  const double T = c.duration, x = t / T;
  if (x > 1) return stay(c.goal, out);
  along_the_line(c, x * x * (3 - 2 * x), 6 * x * (1 - x) / T, (6 - 12 * x) / (T * T), out);
}

// s = 10 x^3 - 15 x^4 + 6 x^5: acceleration is zero at both ends too
void quintic(const Config& c, double t, Reference& out) {
  const double T = c.duration, x = t / T;
  if (x > 1) return stay(c.goal, out);
  along_the_line(c, x * x * x * (10 + x * (6 * x - 15)), 30 * x * x * (1 - x) * (1 - x) / T,
                 60 * x * (1 - x) * (1 - 2 * x) / (T * T), out);
}

// every joint swings for ever
void sinusoid(const Config& c, double t, Reference& out) {
  for (Eigen::Index i = 0; i < c.offset.size(); ++i) {
    const double A = c.amplitude[i], w = c.frequency[i], angle = w * t + c.phase[i];
    out.q[i] = c.offset[i] + A * std::sin(angle);
    out.v[i] = A * w * std::cos(angle);
    out.a[i] = -A * w * w * std::sin(angle);
  }
}

constexpr Kind kKinds[] = {
    {"hold", "stays at q0", hold, false},
    {"cubic", "from rest at q0 to rest at the goal", cubic, true},
    {"quintic", "the same, without a jump of the acceleration", quintic, true},
    {"sinusoid", "every joint swings", sinusoid, false},
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

Config make_config(const Experiment& e, const rbd::Model& model) {
  Config config;
  config.kind = &find_kind(e);
  config.dt = e.simulator.dt;
  config.duration = e.planner.duration > 0 ? e.planner.duration : e.simulator.duration;
  config.nv = model.nv;
  config.floating = floats(model);
  config.q_min = model.lowerPositionLimit, config.q_max = model.upperPositionLimit;
  config.v_max.resize(model.nv);
  for (int i = 0; i < model.nv; ++i) config.v_max[i] = std::isfinite(model.upperVelocityLimit[i]) && model.upperVelocityLimit[i] > 0 ? model.upperVelocityLimit[i] : 1;
  config.q0 = config.goal = configuration(e, "simulator.q0", e.simulator.q0, model, rbd::neutral(model));
  if (config.kind->law == hold) return config;
  if (floats(model)) fail(e, "planner.kind", "'" + model.name + "' floats; only hold is possible for now");

  if (config.kind->to_goal) {
    if (!e.planner.goal.given())
      fail(e, "planner.goal", std::string("is missing; a ") + config.kind->name + " needs one");
    config.goal = configuration(e, "planner.goal", e.planner.goal, model, config.q0);
    return config;
  }
  Eigen::VectorXd one_and_more(model.nv);
  for (int i = 0; i < model.nv; ++i) one_and_more[i] = 1 + 0.3 * i;
  config.offset = configuration(e, "planner.offset", e.planner.offset, model, config.q0);
  config.amplitude = joint_vector(e, "planner.amplitude", e.planner.amplitude, model, 0);
  config.frequency = joint_vector(e, "planner.frequency", e.planner.frequency, model, one_and_more);
  config.phase = joint_vector(e, "planner.phase", e.planner.phase, model, 0);
  for (int i = 0; i < model.nv; ++i) {
    const double reach = std::abs(config.amplitude[i]), low = model.lowerPositionLimit[i],
                 high = model.upperPositionLimit[i];
    if (config.offset[i] - reach < low || config.offset[i] + reach > high)
      fail(e, "planner.amplitude",
           "joint '" + joint_at(model, i) + "' would swing over " + number(config.offset[i] - reach) +
               " .. " + number(config.offset[i] + reach) + "; its limits are " + number(low) + " .. " +
               number(high));
  }
  return config;
}

namespace {

constexpr double kShare = 0.5;      // of the speed limits that a way of our own uses
constexpr double kQuinticPeak = 1.875;
constexpr double kLeast = 0.5;      // s: the shortest way and ramp

/// The motion at its own time t.
void motion(const Config& c, const State& s, double t, Reference& out) {
  if (!s.way) return c.kind->law(c, t, out);
  const Way& w = *s.way;
  const double x = std::clamp(t, 0.0, w.T);
  for (Eigen::Index i = 0; i < out.q.size(); ++i) {
    const double c1 = w.c[1][i], c2 = w.c[2][i], c3 = w.c[3][i], c4 = w.c[4][i], c5 = w.c[5][i];
    out.q[i] = w.c[0][i] + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5))));
    out.v[i] = t < w.T ? c1 + x * (2 * c2 + x * (3 * c3 + x * (4 * c4 + x * 5 * c5))) : 0;
    out.a[i] = t < w.T ? 2 * c2 + x * (6 * c3 + x * (12 * c4 + x * 20 * c5)) : 0;
  }
}

/// The motion's time at a step, and its first two derivatives.
struct MotionTime {
  double t, rate = 1, acceleration = 0;
};
MotionTime motion_time(const Config& c, const State& s, int64_t step) {
  const double run = static_cast<double>(step - s.since) * c.dt;
  if (run >= s.ramp) return {s.began + run - s.ramp / 2};
  const double x = run / s.ramp;  // rate 3 x^2 - 2 x^3
  return {s.began + s.ramp * x * x * x * (1 - x / 2), x * x * (3 - 2 * x), 6 * x * (1 - x) / s.ramp};
}

void follow(const Config& c, const State& s, int64_t step, Reference& out) {
  const MotionTime time = motion_time(c, s, step);
  motion(c, s, time.t, out);
  const double run = static_cast<double>(step - s.since) * c.dt;
  if (run >= s.ramp) return;
  const double x = run / s.ramp, T = s.ramp;
  const double left = 1 - x * x * x * (10 + x * (6 * x - 15));
  const double left_v = -30 * x * x * (1 - x) * (1 - x) / T, left_a = -60 * x * (1 - x) * (1 - 2 * x) / (T * T);
  for (Eigen::Index i = 0; i < out.q.size(); ++i) {
    const double v = out.v[i];
    out.q[i] += left * s.offset[i];
    out.v[i] = v * time.rate + left_v * s.offset[i];
    out.a[i] = out.a[i] * time.rate * time.rate + v * time.acceleration + left_a * s.offset[i];
  }
}

/// Lets the motion go on at time t from a robot that rests at q.
void resume(const Config& c, State& s, int64_t step, double t, const Eigen::VectorXd& q, Reference& scratch) {
  motion(c, s, t, scratch);
  s.since = step, s.began = t, s.held = false;
  s.offset = q - scratch.q;
  double away = 0, speed = 0;
  s.ramp = kLeast;
  for (Eigen::Index i = 0; i < s.offset.size(); ++i) {
    away = std::max(away, std::abs(s.offset[i])), speed = std::max(speed, std::abs(scratch.v[i]));
    s.ramp = std::max(s.ramp, kQuinticPeak * std::abs(s.offset[i]) / (kShare * c.v_max[i]));
  }
  if (away < 1e-9 && speed < 1e-9) s.ramp = 0;  // it starts from rest anyway
}

/// The quintic from a reference to rest at the goal.
Way way_to(const Reference& from, const std::vector<double>& goal, double T) {
  Way way;
  way.T = T;
  for (auto& c : way.c) c.resize(from.q.size());
  for (Eigen::Index i = 0; i < from.q.size(); ++i) {
    const double v = from.v[i] * T, a = from.a[i] * T * T, d = goal[i] - from.q[i];
    way.c[0][i] = from.q[i], way.c[1][i] = from.v[i], way.c[2][i] = from.a[i] / 2;
    way.c[3][i] = (10 * d - 6 * v - 1.5 * a) / (T * T * T);
    way.c[4][i] = (-15 * d + 8 * v + 1.5 * a) / (T * T * T * T);
    way.c[5][i] = (6 * d - 3 * v - 0.5 * a) / (T * T * T * T * T);
  }
  return way;
}

/// True if the way stays inside `share` of the speed limits and inside the position limits.
bool possible(const Config& c, const State& s, double share, Reference& scratch) {
  for (int k = 0; k <= 100; ++k) {
    motion(c, s, s.way->T * k / 100, scratch);
    for (Eigen::Index i = 0; i < scratch.q.size(); ++i)
      if (std::abs(scratch.v[i]) > share * c.v_max[i] * (1 + 1e-9) || scratch.q[i] < c.q_min[i] - 1e-9 || scratch.q[i] > c.q_max[i] + 1e-9) return false;
  }
  return true;
}

/// Takes a goal; empty, or why not.
std::string go(const Config& c, State& s, const Action& action, int64_t step, const Reference& from) {
  if (c.floating) return "a floating robot takes no goals";
  if (action.values.size() != static_cast<size_t>(c.q0.size()))
    return "has " + std::to_string(action.values.size()) + " values, needed " + std::to_string(c.q0.size());
  const double asked = action.key == "duration" ? std::strtod(action.text.c_str(), nullptr) : 0;
  State next = s;
  next.since = step, next.began = 0, next.ramp = 0;
  Reference scratch = from;
  double T = asked > 0 ? asked : kLeast;
  if (!(asked > 0))
    for (Eigen::Index i = 0; i < from.q.size(); ++i)
      T = std::max(T, kQuinticPeak * std::abs(action.values[i] - from.q[i]) / (kShare * c.v_max[i]));
  for (int attempt = 0; attempt < (asked > 0 ? 1 : 12); ++attempt, T *= 1.25) {
    next.way = way_to(from, action.values, T);
    if (!possible(c, next, 1, scratch)) continue;
    s = std::move(next);
    return "";
  }
  return "the way there in " + number(T) + " s would leave the joints' limits of position or speed";
}

}  // namespace

Output step(const Config& config, State& state, const Input& input) {
  Output output;
  Reference& reference = output.reference;
  reference.step = input.step;
  reference.q.resize(config.q0.size());
  reference.v.resize(config.nv);
  reference.a.resize(config.nv);

  const bool joins = state.last_step < 0 && input.step > 1;  // a run that is under way
  for (const Action& action : input.actions) {
    if (action.verb == "estop" && is_for(action, "simulator")) state.stopped = true;
    if (action.verb == "rearm" && is_for(action, "simulator")) state.stopped = false;
  }
  const bool held = input.state && !config.floating && (input.held || state.stopped || joins);
  if (held && !state.held) {
    const int64_t at = joins ? input.step : std::max(state.last_step, state.since);
    state.began = motion_time(config, state, at).t;
    state.held = true;
  } else if (!held && state.held) {
    resume(config, state, input.step, state.began, input.state->q, reference);
  }
  const auto now = [&] { held ? stay(input.state->q, reference) : follow(config, state, input.step, reference); };
  now();
  for (const Action& action : input.actions) {
    if (!is_for(action, "planner")) continue;
    const std::string why_not = action.verb == "goal" ? go(config, state, action, input.step, reference) : "the planner has no such action";
    if (!why_not.empty()) output.events.push_back(ignored(action, "planner", why_not));
    else now();
  }
  state.last_step = input.step;
  return output;
}

}  // namespace lab::planner
