#include "lab/evaluation/tracking.h"

#include <rbd/rbd.h>

#include <limits>

#include "lab/evaluation/running_stats.h"

namespace lab {
namespace {

using nlohmann::json;

struct JointStats {
  RunningStats error, effort, speed;
  double effort_share = 0, speed_share = 0;                 ///< of the limit; 0 where there is none
  double margin = std::numeric_limits<double>::infinity();  ///< to the nearer position limit
  int64_t settled_since = -1;  ///< step from which the error stays in the band; -1 = it does not

  double settling_time(const Run& run) const {
    return settled_since < 0 ? NAN : static_cast<double>(settled_since) * run.dt;
  }
};

struct Tracking {
  std::vector<JointStats> joints;
  double handbook_error = 0;  ///< mean over steps of norm(e) / nq
};

/// |value| as a share of the limit in its direction; 0 without a limit.
double share(double value, double lower, double upper) {
  const double limit = value < 0 ? -lower : upper;
  return limit > 0 && std::isfinite(limit) ? std::abs(value) / limit : 0;
}

/// The later of two times, NaN ("never") if one of them is.
double later(double a, double b) { return std::isnan(a) || std::isnan(b) ? NAN : std::max(a, b); }

Tracking track(const Run& run, const std::vector<TrackedJoint>& joints) {
  const rbd::Model& model = run.model;
  Tracking out;
  out.joints.resize(joints.size());
  Eigen::VectorXd e(model.nv);
  StepReader steps(run.steps);
  for (size_t k = 0; k < run.steps.size(); ++k) {
    const RunStep& step = steps.at(k);
    const RobotState& state = step.state;
    rbd::difference(model, state.q, step.reference.q, e);
    double squares = 0;
    for (size_t j = 0; j < joints.size(); ++j) {
      const TrackedJoint& joint = joints[j];
      JointStats& stats = out.joints[j];
      const double error = e[joint.iv], v = state.v[joint.iv], q = state.q[joint.iq];
      stats.error.add(error);
      squares += error * error;
      if (std::abs(error) > run.band)
        stats.settled_since = -1;
      else if (stats.settled_since < 0)
        stats.settled_since = state.step;
      stats.speed.add(v);
      stats.speed_share = std::max(stats.speed_share, share(v, model.lowerVelocityLimit[joint.iv],
                                                            model.upperVelocityLimit[joint.iv]));
      stats.margin = std::min(
          {stats.margin, q - model.lowerPositionLimit[joint.iq], model.upperPositionLimit[joint.iq] - q});
      if (k == 0) continue;  // no effort leads to step 0
      const double tau = state.tau[joint.iv];
      stats.effort.add(tau);
      stats.effort_share = std::max(
          stats.effort_share, share(tau, model.lowerEffortLimit[joint.iv], model.upperEffortLimit[joint.iv]));
    }
    out.handbook_error += std::sqrt(squares) / model.nq;
  }
  out.handbook_error /= static_cast<double>(run.steps.size());
  return out;
}

void put_joint(json& out, const Run& run, const JointStats& joint) {
  put(out, "max_error", joint.error.max);
  put(out, "mean_error", joint.error.mean());
  put(out, "rms_error", joint.error.rms());
  put(out, "final_error", joint.error.last);
  put(out, "settling_time", joint.settling_time(run));
  put(out, "max_effort", joint.effort.max);
  put(out, "rms_effort", joint.effort.count ? joint.effort.rms() : 0);
  put(out, "max_effort_share", joint.effort_share);
  put(out, "max_speed", joint.speed.max);
  put(out, "max_speed_share", joint.speed_share);
  put(out, "min_position_margin", joint.margin);
}

/// The same over all joints.
JointStats merged(const std::vector<JointStats>& joints) {
  JointStats all;
  for (const JointStats& joint : joints) {
    all.error.add(joint.error);
    all.error.last = std::max(all.error.last, joint.error.last);
    all.effort.add(joint.effort);
    all.effort_share = std::max(all.effort_share, joint.effort_share);
    all.speed.add(joint.speed);
    all.speed_share = std::max(all.speed_share, joint.speed_share);
    all.margin = std::min(all.margin, joint.margin);
  }
  return all;
}

}  // namespace

std::vector<TrackedJoint> joints_of(const rbd::Model& model) {
  std::vector<TrackedJoint> joints;
  for (int j = 1; j < model.njoints; ++j)
    if (model.joints[j].nv() == 1)
      joints.push_back({model.names[j], model.joints[j].idx_q(), model.joints[j].idx_v()});
  return joints;
}

void add_tracking_metrics(json& out, const Run& run) {
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  const Tracking tracking = track(run, joints);
  put_joint(out, run, merged(tracking.joints));
  double settling = 0;
  for (size_t j = 0; j < joints.size(); ++j) {
    settling = later(settling, tracking.joints[j].settling_time(run));
    put_joint(out["joints"][j], run, tracking.joints[j]);
  }
  put(out, "settling_time", settling);
  put(out, "handbook_error", tracking.handbook_error);
  out["handbook_grade"] = tracking.handbook_error < 0.01   ? "excellent"
                          : tracking.handbook_error < 0.05 ? "good"
                                                           : "needs_tuning";
}

}  // namespace lab
