#include "lab/evaluation/evaluate.h"

#include <nlohmann/json.hpp>

#include "lab/evaluation/energy.h"
#include "lab/evaluation/reaches.h"
#include "lab/evaluation/tool.h"
#include "lab/evaluation/tracking.h"
#include "lab/experiment/joints.h"

namespace lab {

using nlohmann::json;

Run begin_run(const Experiment& e, const rbd::Model& model) {
  Run run;
  run.model = model;
  run.dt = e.simulator.dt;
  run.damping = joint_vector(e, "simulator.damping", e.simulator.damping, model, 0);
  run.friction = joint_vector(e, "simulator.friction", e.simulator.friction, model, 0);
  run.last_step = e.last_step();
  run.until_ended = e.runs_until_ended();
  run.band = e.evaluation.band;
  run.tool = e.evaluation.frame;
  return run;
}

json evaluate(const Run& run, const std::map<std::string, Bound>& expect) {
  json out;
  const int64_t last_step = run.steps.empty() ? -1 : run.steps.back().state.step;
  out["last_step"] = last_step;
  out["wanted_last_step"] = run.last_step;
  out["dt"] = run.dt;
  out["aborted"] = run.aborted;
  out["reason"] = run.reason;
  out["band"] = run.band;
  out["joints"] = out["reaches"] = json::array();
  const bool complete = !run.aborted && last_step >= 0 && (run.until_ended || last_step == run.last_step);
  out["complete"] = complete;

  if (!run.steps.empty()) {
    for (const TrackedJoint& joint : joints_of(run.model)) out["joints"].push_back({{"name", joint.name}});
    add_tracking_metrics(out, run);
    add_tool_metrics(out, run);
    add_reach_metrics(out, run);
    add_energy_metrics(out, run);
  }

  out["verdicts"] = verdicts(out, expect);
  bool passed = complete;
  for (const json& one : out["verdicts"]) passed = passed && one["ok"].get<bool>();
  out["passed"] = passed;
  return out;
}

}  // namespace lab
