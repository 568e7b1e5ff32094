#include "procs/renderer/run_scene.h"

#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/kinematics.h>

#include <algorithm>
#include <cmath>

#include "lab/check/check.h"
#include "lab/experiment/joints.h"
#include "procs/renderer/robot_scene.h"
#include "render/markers.h"

namespace lab::renderer {
namespace {

constexpr int kPlanned = 48;           // poses of the plan that the camera is placed for
constexpr int kReferenceGroup = 1000;  // of translucent bodies; ghosts count from 1
constexpr double kTraceRadius = 0.0033, kBeadRadius = 0.007;  // of the picture's width
const Eigen::Vector4f kReferenceTint(.16f, .72f, .40f, .75f);

/// Whether two bodies are in the same place, as far as an eye can tell.
bool coincide(const render::Body& a, const render::Body& b) {
  constexpr double kVisible = 0.003;  // m
  const render::Bounds box = render::bounds(a);
  const double reach =
      box.isEmpty() ? 0 : (box.center() - a.pose.translation()).norm() + box.diagonal().norm() / 2;
  const double turn = Eigen::AngleAxisd(a.pose.linear().transpose() * b.pose.linear()).angle();
  return (a.pose.translation() - b.pose.translation()).norm() + std::abs(turn) * reach < kVisible;
}

double length(const Eigen::VectorXd& x) {
  double squares = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) squares += x[i] * x[i];
  return std::sqrt(squares);
}

}  // namespace

int64_t sample_gap(const Experiment& e) {
  const auto hundredth = static_cast<int64_t>(std::ceil(0.01 / e.simulator.dt - 1e-9));
  return std::max({int64_t{1}, hundredth, (e.last_step() + 999) / 1000});
}

RunScene::RunScene(const Robot& robot, const Experiment& e, Extras extras)
    : settings_(e.renderer),
      extras_(std::move(extras)),
      duration_(static_cast<double>(e.last_step()) * e.simulator.dt),
      model_(robot.model),
      data_(model_),
      reference_data_(model_),
      robot_(make_bodies(robot, e.renderer.quality, links_, warnings_)),
      traced_(settings_.trace.empty() ? 0 : named_frame(e, "renderer.trace", settings_.trace, model_)),
      followed_(settings_.follow.empty() ? 0 : named_frame(e, "renderer.follow", settings_.follow, model_)),
      placement_(place_camera(e)) {}

/// The camera for the planned motion; also sets moving_.
CameraPlacement RunScene::place_camera(const Experiment& e) {
  const std::vector<Eigen::VectorXd> plan = planned_poses(e, model_, kPlanned);
  rbd::forwardKinematics(model_, data_, plan.front());
  CameraPlacement placement(settings_, followed_ != 0, followed());
  Extent planned;
  for (const Eigen::VectorXd& q : plan) {
    pose_bodies(model_, data_, q, robot_);
    placement.extend(planned, robot_, followed());
  }
  placement.set_planned(planned);
  // the plan's last rest does not count for the colours of time
  for (size_t i = plan.size() - 1; i > 0 && plan[i] == plan[i - 1]; --i)
    moving_ = duration_ * static_cast<double>(i - 1) / (kPlanned - 1);
  return placement;
}

/// Kinematics of a snapshot, and of its reference where that is shown: all that a picture needs.
void RunScene::set_pose(const Snapshot& snapshot) {
  if (snapshot.v.size() > 0)
    rbd::forwardKinematics(model_, data_, snapshot.q, snapshot.v);
  else
    rbd::forwardKinematics(model_, data_, snapshot.q);
  if (snapshot.reference.size() > 0 && (settings_.reference || extras_.trace_by == "error"))
    rbd::forwardKinematics(model_, reference_data_, snapshot.reference);
  place_bodies(data_, robot_);
}

std::vector<render::Body> RunScene::robot_at(const Eigen::VectorXd& q) {
  pose_bodies(model_, data_, q, robot_);
  return robot_;
}

// ---- the path

/// Of the snapshot that set_pose() has been called with.
RunScene::Sample RunScene::sample(const Snapshot& snapshot) const {
  Sample out{snapshot.step, snapshot.time, snapshot.q, data_.oMf[traced_].translation(), 0, 0};
  if (snapshot.reference.size() > 0 && extras_.trace_by == "error")
    out.error = (out.point - reference_data_.oMf[traced_].translation()).norm();
  if (snapshot.v.size() > 0)
    out.speed = rbd::getFrameVelocity(model_, data_, traced_, rbd::LOCAL_WORLD_ALIGNED).linear().norm();
  return out;
}

void RunScene::remember(const Snapshot& snapshot) {
  if (!samples_.empty() && snapshot.step <= samples_.back().step) return;
  set_pose(snapshot);
  samples_.push_back(sample(snapshot));
  placement_.extend(extent_, robot_, followed());
  const double value = extras_.trace_by == "error" ? samples_.back().error : samples_.back().speed;
  if (value > max_value_) {
    max_value_ = value;
    if (extras_.trace_by != "time") trace_.reset();  // all its colours change
  }
  if (!shows("velocity") || snapshot.v.size() == 0) return;
  for (rbd::FrameIndex frame : moving_frames())
    max_speed_ = std::max(
        max_speed_, rbd::getFrameVelocity(model_, data_, frame, rbd::LOCAL_WORLD_ALIGNED).linear().norm());
}

void RunScene::finish_run() {
  placement_.include_run(extent_);
  set_scales();
  trace_.reset();  // its radius depends on the camera
}

double RunScene::trace_share(const Sample& s) const {
  if (extras_.trace_by == "time") return s.time / (moving_ > 0 ? moving_ : duration_);
  return max_value_ > 0 ? (extras_.trace_by == "error" ? s.error : s.speed) / max_value_ : 0;
}

Eigen::Vector4f RunScene::colour(const Sample& s) const {
  return extras_.trace_by == "time" ? render::ramp_time(trace_share(s)) : render::ramp_value(trace_share(s));
}

/// The path up to now: the trace of the picture before goes on from where it was.
void RunScene::add_trace(const Sample& now, render::Scene& scene) {
  const double width = placement_.picture_width();
  if (!trace_ || (traced_samples_ > 0 && samples_[traced_samples_ - 1].step >= now.step)) {
    trace_.emplace(kTraceRadius * width);
    traced_samples_ = 0;
  }
  for (; traced_samples_ < samples_.size() && samples_[traced_samples_].step < now.step; ++traced_samples_)
    trace_->add(samples_[traced_samples_].point, colour(samples_[traced_samples_]));
  render::Trace to_now = *trace_;  // it ends where the tool is
  to_now.add(now.point, colour(now));
  scene.bodies.push_back(to_now.body());
  scene.bodies.push_back(render::make_bead(now.point, kBeadRadius * width, colour(now)));
}

// ---- scenes

/// The reference as a ghost, where it is not the robot.
void RunScene::add_reference(const std::vector<render::Body>& robot, render::Scene& scene) {
  std::vector<render::Body> bodies = robot_;
  place_bodies(reference_data_, bodies);
  bodies = render::ghost(std::move(bodies), kReferenceGroup, kReferenceTint, .5f);
  for (size_t i = 0; i < bodies.size(); ++i)
    if (!coincide(bodies[i], robot[i])) scene.bodies.push_back(std::move(bodies[i]));
}

Shot RunScene::shot(const Snapshot& snapshot) {
  set_pose(snapshot);
  Shot shot{snapshot.step, snapshot.time, {}, robot_, placement_.at(snapshot.time, followed())};
  if (!settings_.trace.empty()) add_trace(sample(snapshot), shot.scene);
  if (settings_.reference && snapshot.reference.size() > 0) add_reference(shot.robot, shot.scene);
  shot.scene.bodies.insert(shot.scene.bodies.end(), shot.robot.begin(), shot.robot.end());
  add_arrows(snapshot, shot.scene);
  return shot;
}

/// The samples nearest to n - 1 even distances along the path, without the end of it. along: of each sample.
std::vector<size_t> RunScene::even_samples(const std::vector<double>& along, int64_t n) const {
  const double all = along.back();
  std::vector<size_t> chosen;
  for (int64_t k = 0; all > 0 && k + 1 < n; ++k) {
    const double even = all * static_cast<double>(k) / static_cast<double>(n - 1);
    const auto after =
        static_cast<size_t>(std::lower_bound(along.begin(), along.end(), even) - along.begin());
    const size_t i = after > 0 && even - along[after - 1] < along[after] - even ? after - 1 : after;
    if (chosen.empty() || i > chosen.back()) chosen.push_back(i);
  }
  // where the path has ended; what rests there afterwards adds nothing
  const auto end = static_cast<size_t>(std::lower_bound(along.begin(), along.end(), all) - along.begin());
  while (!chosen.empty() && chosen.back() >= end) chosen.pop_back();
  return chosen;
}

Shot RunScene::ghosts(int64_t n) {
  Shot shot;
  shot.camera = placement_.still();
  render::Scene& scene = shot.scene;
  if (samples_.empty()) return shot;
  // how far along the path each sample is: in joint space, so that a rest takes no room
  std::vector<double> along{0};
  for (size_t i = 1; i < samples_.size(); ++i)
    along.push_back(along.back() + length(rbd::difference(model_, samples_[i - 1].q, samples_[i].q)));
  const auto share = [&](size_t i) { return along.back() > 0 ? along[i] / along.back() : 1; };
  std::vector<size_t> chosen = even_samples(along, n);

  shot.robot = robot_at(samples_.back().q);
  std::vector<render::Body> next;
  for (size_t k = chosen.size(); k-- > 0;) {
    Eigen::Vector4f tint = render::ramp_time(share(chosen[k]));
    tint[3] = .62f;
    std::vector<render::Body> bodies =
        render::ghost(robot_at(samples_[chosen[k]].q), static_cast<int>(k + 1), tint, .42f);
    // what has not moved, as a base, is shown once: by the solid robot or the next ghost
    for (size_t i = 0; i < bodies.size(); ++i)
      if (!coincide(bodies[i], shot.robot[i]) && (next.empty() || !coincide(bodies[i], next[i])))
        scene.bodies.push_back(bodies[i]);
    next = std::move(bodies);
  }
  scene.bodies.insert(scene.bodies.end(), shot.robot.begin(), shot.robot.end());
  if (settings_.trace.empty()) return shot;

  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector4f> colours;
  for (size_t i = 0; i < samples_.size(); ++i) {
    points.push_back(samples_[i].point);
    colours.push_back(extras_.trace_by == "time" ? render::ramp_time(share(i)) : colour(samples_[i]));
  }
  const double width = placement_.picture_width();
  scene.bodies.push_back(render::make_trace(points, colours, kTraceRadius * width));
  chosen.push_back(samples_.size() - 1);
  for (size_t i : chosen)
    scene.bodies.push_back(render::make_bead(points[i], kBeadRadius * width, colours[i]));
  return shot;
}

}  // namespace lab::renderer
