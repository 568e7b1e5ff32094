#include "procs/experiment/evaluate.h"

#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "procs/experiment/joints.h"

namespace lab {
namespace {

using nlohmann::json;

/// NaN and infinity have no place in JSON: null says that there is no value.
json number_or_null(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

/// Running figures of one quantity. Sums are taken in the order of the steps.
struct Figures {
  double max = 0, sum = 0, squares = 0, last = 0;
  int64_t count = 0;
  void add(double value) {
    const double size = std::abs(value);
    max = std::max(max, size);
    sum += size;
    squares += value * value;
    last = size;
    ++count;
  }
  double mean() const { return sum / static_cast<double>(count); }
  double rms() const { return std::sqrt(squares / static_cast<double>(count)); }
};

struct JointFigures {
  std::string name;
  int at = 0;  // in v
  Figures error, effort, speed;
  double effort_share = 0;
  int64_t settled_since = -1;  // step from which the error stayed small; -1 = it is not
};

double seconds(const Run& run, int64_t step) { return step < 0 ? NAN : static_cast<double>(step) * run.dt; }

std::vector<JointFigures> joints_of(const rbd::Model& model) {
  std::vector<JointFigures> joints;
  for (int j = 1; j < model.njoints; ++j)
    if (model.joints[j].nv() == 1)
      joints.emplace_back().name = model.names[j], joints.back().at = model.joints[j].idx_v();
  return joints;
}

/// Errors and efforts of every joint. Returns the mean over steps of norm(e) / nq, the handbook's figure.
double track(const Run& run, std::vector<JointFigures>& joints) {
  Eigen::VectorXd e(run.model.nv);
  double norms = 0;
  for (size_t k = 0; k < run.states.size(); ++k) {
    const RobotState& state = run.states[k];
    rbd::difference(run.model, state.q, run.references[k].q, e);
    double squares = 0;
    for (JointFigures& joint : joints) {
      joint.error.add(e[joint.at]);
      joint.speed.add(state.v[joint.at]);
      squares += e[joint.at] * e[joint.at];
      if (std::abs(e[joint.at]) > kSettled)
        joint.settled_since = -1;
      else if (joint.settled_since < 0)
        joint.settled_since = state.step;
      if (k == 0) continue;  // nothing acted before step 0
      const double tau = state.tau[joint.at], limit = run.model.upperEffortLimit[joint.at];
      joint.effort.add(tau);
      if (limit > 0) joint.effort_share = std::max(joint.effort_share, std::abs(tau) / limit);
    }
    norms += std::sqrt(squares) / run.model.nq;
  }
  return norms / static_cast<double>(run.states.size());
}

struct Energy {
  double first = NAN, last = NAN, work = NAN, drift = NAN, scale = NAN;
};

/// Energy against work. tau is constant over a step, so that its work is exactly tau times the way; what
/// friction takes is summed by the trapezoidal rule. Needs every step.
Energy balance(const Run& run) {
  Energy out;
  for (size_t k = 0; k < run.states.size(); ++k)
    if (run.states[k].step != static_cast<int64_t>(k)) return out;
  rbd::Data data(run.model);
  Eigen::VectorXd way(run.model.nv);
  const auto loss = [&](const Eigen::VectorXd& v) {
    double power = 0;
    for (Eigen::Index i = 0; i < v.size(); ++i)
      power += (run.damping[i] * v[i] + run.friction[i] * std::tanh(v[i] / kSlipSpeed)) * v[i];
    return power;
  };
  out.work = out.drift = out.scale = 0;
  for (size_t k = 0; k < run.states.size(); ++k) {
    const RobotState& s = run.states[k];
    const double kinetic = rbd::computeKineticEnergy(run.model, data, s.q, s.v);
    double energy = kinetic + rbd::computePotentialEnergy(run.model, data, s.q);
    if (!run.stored.empty()) energy += run.stored[k];
    if (!run.given.empty()) out.work += run.given[k];
    if (k == 0) {
      out.first = energy;
    } else {
      const RobotState& before = run.states[k - 1];
      rbd::difference(run.model, before.q, s.q, way);
      for (Eigen::Index i = 0; i < way.size(); ++i) out.work += s.tau[i] * way[i];
      out.work -= 0.5 * run.dt * (loss(before.v) + loss(s.v));
    }
    out.last = energy;
    out.drift = std::max(out.drift, std::abs(energy - out.first - out.work));
    out.scale = std::max(out.scale, kinetic);
  }
  return out;
}

json joint_json(const Run& run, const JointFigures& joint) {
  return {{"name", joint.name},
          {"max_error", number_or_null(joint.error.max)},
          {"mean_error", number_or_null(joint.error.mean())},
          {"rms_error", number_or_null(joint.error.rms())},
          {"final_error", number_or_null(joint.error.last)},
          {"settling_time", number_or_null(seconds(run, joint.settled_since))},
          {"max_effort", number_or_null(joint.effort.max)},
          {"rms_effort", number_or_null(joint.effort.count ? joint.effort.rms() : 0)},
          {"max_effort_share", number_or_null(joint.effort_share)},
          {"max_speed", number_or_null(joint.speed.max)}};
}

/// The value of "max_error" or "max_error.elbow" in the finished metrics; null if it has none.
json value_of(const json& all, const std::string& metric) {
  const size_t dot = metric.find('.');
  if (dot == std::string::npos) return all.value(metric, json());
  for (const json& joint : all.at("joints"))
    if (joint.at("name") == metric.substr(dot + 1)) return joint.value(metric.substr(0, dot), json());
  return {};
}

json verdict(const json& all, const std::string& metric, const Bound& bound) {
  json out{{"metric", metric}, {"value", value_of(all, metric)}};
  bool ok = out["value"].is_number();
  const double value = ok ? out["value"].get<double>() : 0;
  if (bound.min) out["min"] = *bound.min, ok = ok && value >= *bound.min;
  if (bound.max) out["max"] = *bound.max, ok = ok && value <= *bound.max;
  out["ok"] = ok;
  return out;
}

}  // namespace

const std::vector<Metric>& metrics() {
  static const std::vector<Metric> all = {
      {"max_error", "rad, m", "largest error of any joint at any step", true},
      {"mean_error", "rad, m", "mean absolute error over joints and steps", true},
      {"rms_error", "rad, m", "root of the mean squared error over joints and steps", true},
      {"final_error", "rad, m", "largest error of any joint at the last step", true},
      {"handbook_error", "rad, m",
       "mean over steps of norm(e) / nq; not a mean of errors, kept for comparison", false},
      {"settling_time", "s", "from when every joint stays within 0.01 of its reference; null if one does not",
       true},
      {"max_effort", "Nm, N", "largest effort of any joint", true},
      {"rms_effort", "Nm, N", "root of the mean squared effort over joints and steps", true},
      {"max_effort_share", "", "largest effort as a share of the joint's limit", true},
      {"max_speed", "rad/s, m/s", "largest speed of any joint", true},
      {"energy_first", "J", "kinetic and potential energy at step 0", false},
      {"energy_last", "J", "the same at the last step", false},
      {"work", "J", "work of the efforts, less what damping and friction took", false},
      {"energy_drift", "J",
       "largest difference between energy gained and work; null unless every step is logged", false},
      {"energy_drift_relative", "", "the same as a share of the largest kinetic energy", false},
  };
  return all;
}

void check_expect(const Experiment& e, const rbd::Model& model) {
  std::vector<std::string> names;
  for (const Metric& metric : metrics()) names.push_back(metric.name);
  for (const auto& [name, bound] : e.expect) {
    const size_t dot = name.find('.');
    const std::string base = name.substr(0, dot);
    const auto metric = std::find(names.begin(), names.end(), base);
    if (metric == names.end()) {
      const std::string near = did_you_mean(base, names);
      fail(e, "expect." + name,
           "there is no metric '" + base + "'" + (near.empty() ? "; there are " + list_of(names) : near));
    }
    if (dot == std::string::npos) continue;
    const std::string joint = name.substr(dot + 1);
    if (!metrics()[metric - names.begin()].per_joint)
      fail(e, "expect." + name, "'" + base + "' is not kept per joint");
    if (const std::string fault = joint_fault(model, joint); !fault.empty()) fail(e, "expect." + name, fault);
  }
}

json evaluate(const Run& run, const std::map<std::string, Bound>& expect) {
  json out;
  out["last_step"] = run.states.empty() ? -1 : run.states.back().step;
  out["wanted_last_step"] = run.last_step;
  out["dt"] = run.dt;
  out["aborted"] = run.aborted;
  out["reason"] = run.reason;
  out["joints"] = json::array();
  const bool complete = !run.aborted && !run.states.empty() && run.states.back().step == run.last_step;
  out["complete"] = complete;

  if (!run.states.empty()) {
    std::vector<JointFigures> joints = joints_of(run.model);
    const double handbook = track(run, joints);
    Figures error, effort;
    double final_error = 0, share = 0, speed = 0, settling = 0;
    for (const JointFigures& joint : joints) {
      out["joints"].push_back(joint_json(run, joint));
      error.max = std::max(error.max, joint.error.max), effort.max = std::max(effort.max, joint.effort.max);
      error.sum += joint.error.sum;
      error.squares += joint.error.squares, effort.squares += joint.effort.squares;
      error.count += joint.error.count, effort.count += joint.effort.count;
      final_error = std::max(final_error, joint.error.last);
      share = std::max(share, joint.effort_share);
      speed = std::max(speed, joint.speed.max);
      const double time = seconds(run, joint.settled_since);
      settling = std::isnan(time) || std::isnan(settling) ? NAN : std::max(settling, time);
    }
    const Energy energy = balance(run);
    out["max_error"] = number_or_null(error.max);
    out["mean_error"] = number_or_null(error.mean());
    out["rms_error"] = number_or_null(error.rms());
    out["final_error"] = number_or_null(final_error);
    out["handbook_error"] = number_or_null(handbook);
    out["handbook_grade"] = handbook < 0.01 ? "excellent" : handbook < 0.05 ? "good" : "needs_tuning";
    out["settling_time"] = number_or_null(settling);
    out["max_effort"] = number_or_null(effort.max);
    out["rms_effort"] = number_or_null(effort.count ? effort.rms() : 0);
    out["max_effort_share"] = number_or_null(share);
    out["max_speed"] = number_or_null(speed);
    out["energy_first"] = number_or_null(energy.first);
    out["energy_last"] = number_or_null(energy.last);
    out["work"] = number_or_null(energy.work);
    out["energy_drift"] = number_or_null(energy.drift);
    out["energy_drift_relative"] = number_or_null(energy.scale > 0 ? energy.drift / energy.scale : NAN);
  }

  bool passed = complete;
  out["verdicts"] = json::array();
  for (const auto& [metric, bound] : expect) {
    out["verdicts"].push_back(verdict(out, metric, bound));
    passed = passed && out["verdicts"].back()["ok"].get<bool>();
  }
  out["passed"] = passed;
  return out;
}

}  // namespace lab
