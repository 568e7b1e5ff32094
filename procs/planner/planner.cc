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

Output step(const Config& config, State&, const Input& input) {
  Output output;
  for (const Action& action : input.actions)
    if (is_for(action, "planner"))
      output.events.push_back(ignored(action, "planner", "the planner has no such action"));
  Reference& reference = output.reference;
  reference.step = input.step;
  reference.q.resize(config.q0.size());
  reference.v.resize(config.nv);
  reference.a.resize(config.nv);
  config.kind->law(config, static_cast<double>(input.step) * config.dt, reference);
  return output;
}

}  // namespace lab::planner
