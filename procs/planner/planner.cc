#include "procs/planner/planner.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/util/number.h"
#include "lab/experiment/actions.h"
#include "lab/experiment/cartesian.h"
#include "lab/experiment/joints.h"

namespace lab::planner {
namespace {

constexpr double kRampShare = 0.5;  // of the speed limits that a ramp may add to the motion's speed

/// The motion, or its detour, at its own time t.
void motion(const Config& c, const State& s, double t, Reference& out) {
  if (!s.detour) return c.motion->at(t, out);
  const Detour& detour = *s.detour;
  const double T = detour.path.length;
  if (detour.resume_time && t >= T) return c.motion->at(*detour.resume_time + (t - T), out);
  detour.path.at(std::clamp(t, 0.0, T), out.q, out.v, out.a);
  if (t < T) return;
  out.v.setZero();
  out.a.setZero();
}

/// The motion's time at a step, and its first two derivatives.
struct MotionTime {
  double t, rate = 1, acceleration = 0;
};
MotionTime motion_time(const Config& c, const State& s, int64_t step) {
  const double elapsed = static_cast<double>(step - s.since) * c.dt;
  if (elapsed >= s.ramp) return {s.start_time + elapsed - s.ramp / 2};
  const double x = elapsed / s.ramp;  // rate 3 x^2 - 2 x^3
  return {s.start_time + s.ramp * x * x * x * (1 - x / 2), x * x * (3 - 2 * x), 6 * x * (1 - x) / s.ramp};
}

void follow(const Config& c, const State& s, int64_t step, Reference& out) {
  const MotionTime time = motion_time(c, s, step);
  motion(c, s, time.t, out);
  const double elapsed = static_cast<double>(step - s.since) * c.dt;
  if (elapsed >= s.ramp) return;
  const Progress ramp = quintic_progress(elapsed, s.ramp);  // of the offset towards 0
  for (Eigen::Index i = 0; i < out.q.size(); ++i) {
    const double v = out.v[i];
    out.q[i] += (1 - ramp.s) * s.offset[i];
    out.v[i] = v * time.rate - ramp.rate * s.offset[i];
    out.a[i] = out.a[i] * time.rate * time.rate + v * time.acceleration - ramp.acceleration * s.offset[i];
  }
}

/// Continues the motion at time t from a robot that rests at q.
void resume(const Config& c, State& s, int64_t step, double t, const Eigen::VectorXd& q, Reference& scratch) {
  motion(c, s, t, scratch);
  s.since = step;
  s.start_time = t;
  s.held = false;
  s.offset = q - scratch.q;
  double distance = 0, speed = 0;
  s.ramp = kMinTime;
  for (Eigen::Index i = 0; i < s.offset.size(); ++i) {
    distance = std::max(distance, std::abs(s.offset[i]));
    speed = std::max(speed, std::abs(scratch.v[i]));
    s.ramp = std::max(s.ramp, kQuinticSpeed * std::abs(s.offset[i]) / (kRampShare * c.v_max[i]));
  }
  if (distance < 1e-9 && speed < 1e-9) s.ramp = 0;  // it starts from rest anyway
}

/// Why the detour, which is `length` s long, leaves the limits of speed or position; empty if it does not.
std::string detour_fault(const Config& c, const State& s, double length, Reference& scratch) {
  for (int k = 0; k <= 100; ++k) {
    motion(c, s, length * k / 100, scratch);
    for (Eigen::Index i = 0; i < scratch.q.size(); ++i) {
      const bool fast = std::abs(scratch.v[i]) > c.v_max[i] * (1 + 1e-9);
      if (!fast && scratch.q[i] >= c.q_min[i] - 1e-9 && scratch.q[i] <= c.q_max[i] + 1e-9) continue;
      return "the way there in " + rounded(length) + " s would leave the limits of joint '" +
             joint_at(c.model, static_cast<int>(i)) + "': " +
             (fast ? "speed " + rounded(std::abs(scratch.v[i])) + ", at most " + number(c.v_max[i])
                   : "position " + rounded(scratch.q[i]) + ", " + number(c.q_min[i]) + " .. " +
                         number(c.q_max[i]));
    }
  }
  return "";
}

/// The time of config's own motion at a step; on a detour the one at which it was left.
double undiverted_time(const Config& c, const State& s, int64_t step) {
  const double t = s.held ? s.start_time : motion_time(c, s, step).t;
  if (!s.detour) return t;
  const double T = s.detour->path.length;
  return s.detour->resume_time && t >= T ? *s.detour->resume_time + (t - T) : s.left_time;
}

/// Takes the detour make(T), or a slower one if `may_be_slower`; empty, or why not.
template <class Make>
std::string divert(const Config& c, State& s, int64_t step, double T, bool may_be_slower, Make make) {
  State next = s;
  next.left_time = undiverted_time(c, s, step);
  next.since = step;
  next.start_time = 0;
  next.ramp = 0;
  Reference scratch;
  scratch.q.resize(c.q0.size());
  scratch.v.resize(c.nv);
  scratch.a.resize(c.nv);
  std::string fault;
  for (int attempt = 0; attempt < (may_be_slower ? 12 : 1); ++attempt, T *= 1.25) {
    const Detour& detour = next.detour.emplace(make(T));
    if (std::string why = detour_fault(c, next, detour.path.length, scratch); !why.empty()) {
      if (fault.empty()) fault = std::move(why);
      continue;
    }
    s = std::move(next);
    return "";
  }
  return fault;
}

/// Takes a goal; empty, or why not. Unless it must be `exactly` in the time that was asked for, a goal that is not possible in
/// that time takes the shortest.
std::string take_goal(const Config& c, State& s, const Action& action, int64_t step, const Reference& from,
                      bool exactly) {
  if (c.floating) return "a floating robot takes no goals";
  const double asked = action.key == "duration" ? std::strtod(action.text.c_str(), nullptr) : 0;
  Reference to = from;
  if (is_cartesian(action)) {
    const IkResult found = find_configuration(c.model, action, &from.q);
    if (!found.fault.empty()) return found.fault;
    stay(found.q, to);
  } else if (action.values.size() == static_cast<size_t>(c.q0.size())) {
    stay(Eigen::Map<const Eigen::VectorXd>(action.values.data(), c.q0.size()), to);
  } else {
    return "has " + std::to_string(action.values.size()) + " values, expected " + std::to_string(c.q0.size());
  }
  const auto way = [&](double duration) { return Detour{quintic(0, duration, from, to), {}}; };
  std::string fault = asked > 0 ? divert(c, s, step, asked, false, way) : "";
  if (asked > 0 && (fault.empty() || exactly)) return fault;
  const std::string none = divert(c, s, step, quintic_time(c, from.q, to.q), true, way);
  return none.empty() || asked <= 0 ? none : fault;
}

/// Back to the motion that a goal has replaced; empty, or why not.
std::string rejoin(const Config& c, State& s, const Action& action, int64_t step, const Reference& from) {
  if (action.key != "motion" || action.text != "on") return "the planner knows only motion=on";
  if (!s.detour || s.detour->resume_time) return "";  // it is on
  const double left = s.left_time;
  const std::optional<double> meeting = c.motion->rejoin_time(left);
  Reference to = from;
  c.motion->at(meeting.value_or(left), to);
  return divert(c, s, step, quintic_time(c, from.q, to.q), true, [&](double T) {
    const double resume_time = meeting.value_or(left + T);
    c.motion->at(resume_time, to);
    return Detour{quintic(0, T, from, to), resume_time};
  });
}

}  // namespace

std::string goal_fault(const Config& config, const Action& goal, const Reference& from) {
  State rest = initial(config);
  std::string fault = take_goal(config, rest, goal, from.step, from, true);
  if (fault.empty() || goal.key != "duration") return fault;
  Action unhurried = goal;
  unhurried.key.clear();
  if (take_goal(config, rest, unhurried, from.step, from, false).empty() && rest.detour)
    fault += "; " + number(std::ceil(1000 * rest.detour->path.length) / 1000) + " s would do";
  return fault;
}

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
    state.start_time = motion_time(config, state, at).t;
    state.held = true;
  } else if (!held && state.held && input.state) {
    resume(config, state, input.step, state.start_time, input.state->q, reference);
  }
  const auto now = [&] {
    held ? stay(input.state->q, reference) : follow(config, state, input.step, reference);
  };
  now();
  for (const Action& action : input.actions) {
    if (!is_for(action, "planner")) continue;
    std::string why_not = "the planner has no such action";
    if (action.verb == "goal") why_not = take_goal(config, state, action, input.step, reference, false);
    if (action.verb == "set") why_not = rejoin(config, state, action, input.step, reference);
    if (!why_not.empty())
      output.events.push_back(ignored(action, "planner", why_not));
    else
      now();
  }
  state.last_step = input.step;
  return output;
}

}  // namespace lab::planner
