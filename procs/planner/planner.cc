#include "procs/planner/planner.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/util/number.h"
#include "lab/experiment/actions.h"
#include "lab/experiment/cartesian.h"

namespace lab::planner {
namespace {

constexpr double kShare = 0.5;  // of the speed limits that coming back to the motion may add to it

/// The motion at its own time t.
void motion(const Config& c, const State& s, double t, Reference& out) {
  if (!s.way) return c.kind->law(c, t, out);
  const Way& w = *s.way;
  if (w.onward && t >= w.T) return c.kind->law(c, *w.onward + (t - w.T), out);
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
  const double left_v = -30 * x * x * (1 - x) * (1 - x) / T,
               left_a = -60 * x * (1 - x) * (1 - 2 * x) / (T * T);
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

/// The quintic from one reference to another.
Way way_between(const Reference& from, const Reference& to, double T) {
  Way way;
  way.T = T;
  for (auto& c : way.c) c.resize(from.q.size());
  for (Eigen::Index i = 0; i < from.q.size(); ++i) {
    const double v = from.v[i] * T, a = from.a[i] * T * T, w = to.v[i] * T, b = to.a[i] * T * T,
                 d = to.q[i] - from.q[i];
    way.c[0][i] = from.q[i], way.c[1][i] = from.v[i], way.c[2][i] = from.a[i] / 2;
    way.c[3][i] = (10 * d - 6 * v - 4 * w - 1.5 * a + 0.5 * b) / (T * T * T);
    way.c[4][i] = (-15 * d + 8 * v + 7 * w + 1.5 * a - b) / (T * T * T * T);
    way.c[5][i] = (6 * d - 3 * v - 3 * w - 0.5 * a + 0.5 * b) / (T * T * T * T * T);
  }
  return way;
}

/// True if the way stays inside `share` of the speed limits and inside the position limits.
bool possible(const Config& c, const State& s, double share, Reference& scratch) {
  for (int k = 0; k <= 100; ++k) {
    motion(c, s, s.way->T * k / 100, scratch);
    for (Eigen::Index i = 0; i < scratch.q.size(); ++i)
      if (std::abs(scratch.v[i]) > share * c.v_max[i] * (1 + 1e-9) || scratch.q[i] < c.q_min[i] - 1e-9 ||
          scratch.q[i] > c.q_max[i] + 1e-9)
        return false;
  }
  return true;
}

/// The time of config's own motion at a step, on a way the one at which it was left.
double own_time(const Config& c, const State& s, int64_t step) {
  const double t = s.held ? s.began : motion_time(c, s, step).t;
  if (!s.way) return t;
  return s.way->onward && t >= s.way->T ? *s.way->onward + (t - s.way->T) : s.left;
}

/// Takes the way that make(T) gives, slower ones too if `patient`; empty, or why not.
template <class Make>
std::string take_way(const Config& c, State& s, int64_t step, double T, bool patient, Make make) {
  State next = s;
  next.left = own_time(c, s, step);
  next.since = step, next.began = 0, next.ramp = 0;
  Reference scratch;
  scratch.q.resize(c.q0.size()), scratch.v.resize(c.nv), scratch.a.resize(c.nv);
  for (int attempt = 0; attempt < (patient ? 12 : 1); ++attempt, T *= 1.25) {
    next.way = make(T);
    if (!possible(c, next, 1, scratch)) continue;
    s = std::move(next);
    return "";
  }
  return "the way there in " + number(T) + " s would leave the joints' limits of position or speed";
}

/// Takes a goal; empty, or why not.
std::string go(const Config& c, State& s, const Action& action, int64_t step, const Reference& from) {
  if (c.floating) return "a floating robot takes no goals";
  const double asked = action.key == "duration" ? std::strtod(action.text.c_str(), nullptr) : 0;
  Reference to = from;
  if (is_cartesian(action)) {
    const Found found = find_configuration(c.model, action, &from.q);
    if (!found.fault.empty()) return found.fault;
    stay(found.q, to);
  } else if (action.values.size() == static_cast<size_t>(c.q0.size())) {
    stay(Eigen::Map<const Eigen::VectorXd>(action.values.data(), c.q0.size()), to);
  } else {
    return "has " + std::to_string(action.values.size()) + " values, needed " + std::to_string(c.q0.size());
  }
  const double T = asked > 0 ? asked : shortest_way(c, from.q, to.q);
  return take_way(c, s, step, T, !(asked > 0),
                  [&](double duration) { return way_between(from, to, duration); });
}

/// Back to the motion that a goal has taken the place of; empty, or why not.
std::string go_back(const Config& c, State& s, const Action& action, int64_t step, const Reference& from) {
  if (action.key != "motion" || action.text != "on") return "the planner knows only motion=on";
  if (!s.way || s.way->onward) return "";  // it is on
  const double left = s.left;
  const auto arrival = c.kind->comes_back;
  Reference to = from;
  c.kind->law(c, arrival ? arrival(c, left) : left, to);
  return take_way(c, s, step, shortest_way(c, from.q, to.q), true, [&](double T) {
    const double onward = arrival ? arrival(c, left) : left + T;
    c.kind->law(c, onward, to);
    Way way = way_between(from, to, T);
    way.onward = onward;
    return way;
  });
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
  const auto now = [&] {
    held ? stay(input.state->q, reference) : follow(config, state, input.step, reference);
  };
  now();
  for (const Action& action : input.actions) {
    if (!is_for(action, "planner")) continue;
    std::string why_not = "the planner has no such action";
    if (action.verb == "goal") why_not = go(config, state, action, input.step, reference);
    if (action.verb == "set") why_not = go_back(config, state, action, input.step, reference);
    if (!why_not.empty())
      output.events.push_back(ignored(action, "planner", why_not));
    else
      now();
  }
  state.last_step = input.step;
  return output;
}

}  // namespace lab::planner
