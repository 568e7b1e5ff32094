#include "lab/evaluation/tool.h"

#include <rbd/rbd.h>
#include <rbd/spatial/so3.h>

namespace lab {

int tool_frame(const Run& run) {
  const rbd::Model& model = run.model;
  if (!run.tool.empty()) return model.frameId(run.tool);
  for (int f = model.nframes - 1; f > 0; --f)
    if (model.frames[f].type == rbd::BODY) return f;
  return -1;
}

ToolPath tool_path(const Run& run) {
  ToolPath out;
  const int frame = tool_frame(run);
  if (frame < 0) return out;
  out.frame = run.model.frames[frame].name;
  rbd::Data data(run.model);
  const auto place = [&](const Eigen::VectorXd& q) {
    rbd::forwardKinematics(run.model, data, q);
    return data.oMf[frame];
  };
  for (size_t k = 0; k < run.states.size(); ++k) {
    const rbd::SE3 is = place(run.states[k].q), shall = place(run.references[k].q);
    out.actual.push_back(is.translation());
    out.reference.push_back(shall.translation());
    out.error.push_back((is.translation() - shall.translation()).norm());
    const Eigen::Matrix3d turn = shall.rotation().transpose() * is.rotation();
    out.turn.push_back(rbd::log3(turn).norm());
  }
  return out;
}

}  // namespace lab
