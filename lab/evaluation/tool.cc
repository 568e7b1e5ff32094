#include "lab/evaluation/tool.h"

#include <rbd/rbd.h>
#include <rbd/spatial/so3.h>

#include "lab/evaluation/running_stats.h"

namespace lab {
namespace {

/// run.tool, or else the last link of the model. -1 if there is none.
int tool_frame(const Run& run) {
  const rbd::Model& model = run.model;
  if (!run.tool.empty()) return model.frameId(run.tool);
  for (int f = model.nframes - 1; f > 0; --f)
    if (model.frames[f].type == rbd::BODY) return f;
  return -1;
}

}  // namespace

ToolPath tool_path(const Run& run) {
  ToolPath out;
  const int frame = tool_frame(run);
  if (frame < 0) return out;
  out.frame = run.model.frames[frame].name;
  rbd::Data data(run.model);
  const auto pose = [&](const Eigen::VectorXd& q) {
    rbd::forwardKinematics(run.model, data, q);
    return data.oMf[frame];
  };
  for (size_t k = 0; k < run.states.size(); ++k) {
    const rbd::SE3 actual = pose(run.states[k].q), reference = pose(run.references[k].q);
    out.actual.push_back(actual.translation());
    out.reference.push_back(reference.translation());
    out.error.push_back((actual.translation() - reference.translation()).norm());
    const Eigen::Matrix3d rotation = reference.rotation().transpose() * actual.rotation();
    out.angle.push_back(rbd::log3(rotation).norm());
  }
  return out;
}

void add_tool_metrics(nlohmann::json& out, const Run& run) {
  const ToolPath path = tool_path(run);
  RunningStats error, angle;
  for (double one : path.error) error.add(one);
  for (double one : path.angle) angle.add(one);
  if (path.error.empty()) error.max = error.last = angle.max = NAN;  // no such frame; the means are 0 / 0
  out["tool_frame"] = path.frame.empty() ? nlohmann::json(nullptr) : nlohmann::json(path.frame);
  put(out, "max_tool_error", error.max);
  put(out, "mean_tool_error", error.mean());
  put(out, "rms_tool_error", error.rms());
  put(out, "final_tool_error", error.last);
  put(out, "max_tool_turn", angle.max);
  put(out, "mean_tool_turn", angle.mean());
  put(out, "rms_tool_turn", angle.rms());
}

}  // namespace lab
