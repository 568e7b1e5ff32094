#include "lab/evaluation/tracking.h"

#include <rbd/rbd.h>

#include <limits>

namespace lab {
namespace {

/// |value| as a share of the limit in its direction; 0 where nobody said one.
double share(double value, double lower, double upper) {
  const double limit = value < 0 ? -lower : upper;
  return limit > 0 && std::isfinite(limit) ? std::abs(value) / limit : 0;
}

}  // namespace

std::vector<JointFigures> joints_of(const rbd::Model& model) {
  std::vector<JointFigures> joints;
  for (int j = 1; j < model.njoints; ++j) {
    if (model.joints[j].nv() != 1) continue;
    JointFigures& joint = joints.emplace_back();
    joint.name = model.names[j], joint.iq = model.joints[j].idx_q(), joint.iv = model.joints[j].idx_v();
    joint.margin = std::numeric_limits<double>::infinity();
  }
  return joints;
}

Tracking track(const Run& run) {
  const rbd::Model& model = run.model;
  Tracking out{joints_of(model), 0};
  Eigen::VectorXd e(model.nv);
  for (size_t k = 0; k < run.states.size(); ++k) {
    const RobotState& state = run.states[k];
    rbd::difference(model, state.q, run.references[k].q, e);
    double squares = 0;
    for (JointFigures& joint : out.joints) {
      const double error = e[joint.iv], v = state.v[joint.iv], q = state.q[joint.iq];
      joint.error.add(error);
      squares += error * error;
      if (std::abs(error) > run.band)
        joint.settled_since = -1;
      else if (joint.settled_since < 0)
        joint.settled_since = state.step;
      joint.speed.add(v);
      joint.speed_share = std::max(joint.speed_share, share(v, model.lowerVelocityLimit[joint.iv],
                                                            model.upperVelocityLimit[joint.iv]));
      joint.margin = std::min(
          {joint.margin, q - model.lowerPositionLimit[joint.iq], model.upperPositionLimit[joint.iq] - q});
      if (k == 0) continue;  // nothing acted before step 0
      const double tau = state.tau[joint.iv];
      joint.effort.add(tau);
      joint.effort_share = std::max(
          joint.effort_share, share(tau, model.lowerEffortLimit[joint.iv], model.upperEffortLimit[joint.iv]));
    }
    out.handbook += std::sqrt(squares) / model.nq;
  }
  out.handbook /= static_cast<double>(run.states.size());
  return out;
}

}  // namespace lab
