#include "lab/evaluation/tool.h"

#include <rbd/rbd.h>
#include <rbd/spatial/so3.h>

#include "lab/evaluation/running_stats.h"

namespace lab {
namespace {

/// run.tool, or else the last link of the model. -1 if there is none.
int frame_of_tool(const Run& run) {
  const rbd::Model& model = run.model;
  if (!run.tool.empty()) return model.frameId(run.tool);
  for (int f = model.nframes - 1; f > 0; --f)
    if (model.frames[f].type == rbd::BODY) return f;
  return -1;
}

}  // namespace

std::string tool_frame(const Run& run) {
  const int frame = frame_of_tool(run);
  return frame < 0 ? "" : run.model.frames[frame].name;
}

void for_each_tool_step(const Run& run, const std::function<void(const ToolStep&)>& visit) {
  const int frame = frame_of_tool(run);
  if (frame < 0) return;
  rbd::Data data(run.model);
  const auto pose = [&](const Eigen::VectorXd& q) {
    rbd::forwardKinematics(run.model, data, q);
    return data.oMf[frame];
  };
  StepReader steps(run.steps);
  for (size_t k = 0; k < run.steps.size(); ++k) {
    const RunStep& step = steps.at(k);
    const rbd::SE3 actual = pose(step.state.q), reference = pose(step.reference.q);
    const Eigen::Matrix3d rotation = reference.rotation().transpose() * actual.rotation();
    visit({.time = static_cast<double>(step.state.step) * run.dt,
           .actual = actual.translation(),
           .reference = reference.translation(),
           .error = (actual.translation() - reference.translation()).norm(),
           .angle = rbd::log3(rotation).norm()});
  }
}

void add_tool_metrics(nlohmann::json& out, const Run& run) {
  RunningStats error, angle;
  for_each_tool_step(run, [&](const ToolStep& step) {
    error.add(step.error);
    angle.add(step.angle);
  });
  if (error.count == 0) error.max = error.last = angle.max = NAN;  // no such frame; the means are 0 / 0
  const std::string frame = tool_frame(run);
  out["tool_frame"] = frame.empty() ? nlohmann::json(nullptr) : nlohmann::json(frame);
  put(out, "max_tool_error", error.max);
  put(out, "mean_tool_error", error.mean());
  put(out, "rms_tool_error", error.rms());
  put(out, "final_tool_error", error.last);
  put(out, "max_tool_turn", angle.max);
  put(out, "mean_tool_turn", angle.mean());
  put(out, "rms_tool_turn", angle.rms());
}

}  // namespace lab
