#include "lab/evaluation/evaluate.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/evaluation/energy.h"
#include "lab/evaluation/figures.h"
#include "lab/evaluation/reaches.h"
#include "lab/evaluation/tool.h"
#include "lab/evaluation/tracking.h"
#include "lab/experiment/joints.h"

namespace lab {
namespace {

using nlohmann::json;

double seconds(const Run& run, int64_t step) { return step < 0 ? NAN : static_cast<double>(step) * run.dt; }

/// The later of two times, NaN ("never") if one of them is.
double later(double a, double b) { return std::isnan(a) || std::isnan(b) ? NAN : std::max(a, b); }

void put(json& out, const std::string& name, double value) { out[name] = number_or_null(value); }

void put_joint(json& out, const Run& run, const JointFigures& joint) {
  put(out, "max_error", joint.error.max);
  put(out, "mean_error", joint.error.mean());
  put(out, "rms_error", joint.error.rms());
  put(out, "final_error", joint.error.last);
  put(out, "settling_time", seconds(run, joint.settled_since));
  put(out, "max_effort", joint.effort.max);
  put(out, "rms_effort", joint.effort.count ? joint.effort.rms() : 0);
  put(out, "max_effort_share", joint.effort_share);
  put(out, "max_speed", joint.speed.max);
  put(out, "max_speed_share", joint.speed_share);
  put(out, "min_position_margin", joint.margin);
}

void put_tracking(json& out, const Run& run, const Tracking& tracking) {
  Figures error, effort;
  double final_error = 0, effort_share = 0, speed = 0, speed_share = 0, settling = 0, margin = INFINITY;
  for (const JointFigures& joint : tracking.joints) {
    error.add(joint.error), effort.add(joint.effort);
    final_error = std::max(final_error, joint.error.last);
    effort_share = std::max(effort_share, joint.effort_share);
    speed = std::max(speed, joint.speed.max), speed_share = std::max(speed_share, joint.speed_share);
    settling = later(settling, seconds(run, joint.settled_since));
    margin = std::min(margin, joint.margin);
  }
  put(out, "max_error", error.max);
  put(out, "mean_error", error.mean());
  put(out, "rms_error", error.rms());
  put(out, "final_error", final_error);
  put(out, "handbook_error", tracking.handbook);
  out["handbook_grade"] = tracking.handbook < 0.01   ? "excellent"
                          : tracking.handbook < 0.05 ? "good"
                                                     : "needs_tuning";
  put(out, "settling_time", settling);
  put(out, "max_effort", effort.max);
  put(out, "rms_effort", effort.count ? effort.rms() : 0);
  put(out, "max_effort_share", effort_share);
  put(out, "max_speed", speed);
  put(out, "max_speed_share", speed_share);
  put(out, "min_position_margin", margin);
}

void put_tool(json& out, const Run& run) {
  const ToolPath path = tool_path(run);
  Figures error, turn;
  for (size_t k = 0; k < path.error.size(); ++k) error.add(path.error[k]), turn.add(path.turn[k]);
  if (path.error.empty()) error.max = error.last = turn.max = NAN;  // no such frame; the means are 0 / 0
  out["tool_frame"] = path.frame.empty() ? json(nullptr) : json(path.frame);
  put(out, "max_tool_error", error.max);
  put(out, "mean_tool_error", error.mean());
  put(out, "rms_tool_error", error.rms());
  put(out, "final_tool_error", error.last);
  put(out, "max_tool_turn", turn.max);
  put(out, "mean_tool_turn", turn.mean());
  put(out, "rms_tool_turn", turn.rms());
}

void put_reach_figures(json& out, const std::vector<Reach>& all, int joint) {
  const ReachFigures figures = over_reaches(all, joint);
  put(out, "reach_settling_max", figures.settling_max);
  put(out, "reach_settling_mean", figures.settling_mean);
  put(out, "overshoot_max", figures.overshoot_max);
  put(out, "overshoot_share_max", figures.overshoot_share_max);
  put(out, "steady_error_max", figures.steady_error_max);
}

json reach_json(const Run& run, const Reach& reach, const std::vector<JointFigures>& joints) {
  json out;
  put_reach_figures(out, {reach}, -1);
  out.erase("reach_settling_mean");
  out["begin"] = seconds(run, run.states[reach.begin].step);
  out["arrival"] = seconds(run, run.states[reach.arrival].step);
  out["end"] = seconds(run, run.states[reach.end].step);
  for (size_t j = 0; j < joints.size(); ++j) {
    json one{{"name", joints[j].name}};
    put(one, "way", reach.joints[j].way);
    put(one, "settling", reach.joints[j].settling);
    put(one, "overshoot", reach.joints[j].overshoot);
    put(one, "overshoot_share", reach.joints[j].overshoot_share);
    put(one, "steady_error", reach.joints[j].steady_error);
    out["joints"].push_back(one);
  }
  return out;
}

}  // namespace

Run begin_run(const Experiment& e, const rbd::Model& model) {
  Run run;
  run.model = model;
  run.dt = e.simulator.dt;
  run.damping = joint_vector(e, "simulator.damping", e.simulator.damping, model, 0);
  run.friction = joint_vector(e, "simulator.friction", e.simulator.friction, model, 0);
  run.last_step = e.last_step();
  run.band = e.evaluation.band, run.tool = e.evaluation.frame;
  return run;
}

json evaluate(const Run& run, const std::map<std::string, Bound>& expect) {
  json out;
  out["last_step"] = run.states.empty() ? -1 : run.states.back().step;
  out["wanted_last_step"] = run.last_step;
  out["dt"] = run.dt;
  out["aborted"] = run.aborted;
  out["reason"] = run.reason;
  out["band"] = run.band;
  out["joints"] = out["reaches"] = json::array();
  const bool complete = !run.aborted && !run.states.empty() && run.states.back().step == run.last_step;
  out["complete"] = complete;

  if (!run.states.empty()) {
    const Tracking tracking = track(run);
    put_tracking(out, run, tracking);
    put_tool(out, run);

    const std::vector<Reach> all = reaches(run);
    out["reach_count"] = all.size();
    put_reach_figures(out, all, -1);
    for (const Reach& reach : all) out["reaches"].push_back(reach_json(run, reach, tracking.joints));
    for (size_t j = 0; j < tracking.joints.size(); ++j) {
      json one{{"name", tracking.joints[j].name}};
      put_joint(one, run, tracking.joints[j]);
      put_reach_figures(one, all, static_cast<int>(j));
      out["joints"].push_back(one);
    }

    const Energy energy = balance(run);
    const bool whole = !energy.energy.empty();
    put(out, "energy_first", whole ? energy.energy.front() : NAN);
    put(out, "energy_last", whole ? energy.energy.back() : NAN);
    put(out, "work", whole ? energy.work.back() : NAN);
    put(out, "energy_drift", energy.drift);
    put(out, "energy_drift_relative", energy.scale > 0 ? energy.drift / energy.scale : NAN);
  }

  out["verdicts"] = verdicts(out, expect);
  bool passed = complete;
  for (const json& one : out["verdicts"]) passed = passed && one["ok"].get<bool>();
  out["passed"] = passed;
  return out;
}

}  // namespace lab
