#include "procs/renderer/stage.h"

#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/kinematics.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "procs/experiment/check.h"
#include "procs/renderer/robot_scene.h"
#include "render/markers.h"

namespace lab::renderer {
namespace {

constexpr int kPlanned = 48;             // poses of the plan that the camera is set by
constexpr double kAllowance = 0.05;      // of the box's diagonal, by which a run may leave it
constexpr int kReferenceGroup = 1000;    // of translucent bodies; ghosts count from 1
const Eigen::Vector4f kReferenceTint(.16f, .72f, .40f, .75f);

rbd::FrameIndex frame_of(const Experiment& experiment, const std::string& key, const std::string& name, const rbd::Model& model) {
  if (name.empty() || model.existFrame(name)) return name.empty() ? 0 : model.frameId(name);
  std::vector<std::string> names;
  for (const rbd::Frame& frame : model.frames) names.push_back(frame.name);
  fail(experiment, key, "no frame '" + name + "'" + did_you_mean(name, names));
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

Stage::Stage(const Robot& robot, const Experiment& e, Extras extras)
    : settings_(e.renderer),
      extras_(std::move(extras)),
      duration_(static_cast<double>(e.last_step()) * e.simulator.dt),
      model_(robot.model),
      data_(model_),
      robot_(make_bodies(robot, e.renderer.quality, links_, warnings_)),
      traced_(frame_of(e, "renderer.trace", settings_.trace, model_)),
      followed_(frame_of(e, "renderer.follow", settings_.follow, model_)) {
  const std::vector<Eigen::VectorXd> plan = planned_poses(e, model_, kPlanned);
  rbd::forwardKinematics(model_, data_, plan.front());
  home_ = data_.oMf[followed_].translation();
  for (const Eigen::VectorXd& q : plan) extend(q, box_, followed_box_);
  set_cameras();
}

std::vector<render::Body> Stage::robot_at(const Eigen::VectorXd& q) {
  pose_bodies(model_, data_, q, robot_);
  return robot_;
}

void Stage::extend(const Eigen::VectorXd& q, render::Bounds& world, render::Bounds& followed) {
  pose_bodies(model_, data_, q, robot_);
  for (const render::Body& body : robot_) {
    render::Bounds box = render::bounds(body);
    world.extend(box);
    if (!box.isEmpty()) followed.extend(box.translate(home_ - data_.oMf[followed_].translation()));
  }
}

void Stage::set_cameras() {
  const double aspect = static_cast<double>(settings_.size[0]) / static_cast<double>(settings_.size[1]);
  render::View view = render::view_from_name(settings_.camera);
  view.orthographic = settings_.orthographic;
  still_camera_ = render::auto_frame(box_, view, aspect);
  view.turn = settings_.orbit;
  camera_ = render::auto_frame(followed_ ? followed_box_ : box_, view, aspect);
}

void Stage::frame_all() {
  render::Bounds box, followed;
  for (const Sample& each : way_) extend(each.moment.q, box, followed);
  const auto keep = [](render::Bounds& planned, const render::Bounds& seen) {
    const Eigen::Vector3d room = Eigen::Vector3d::Constant(kAllowance * planned.diagonal().norm());
    if (!planned.isEmpty() && render::Bounds(planned.min() - room, planned.max() + room).contains(seen)) return;
    planned.extend(seen);
  };
  keep(box_, box), keep(followed_box_, followed);
  set_cameras();
  set_scales();
}

render::Camera Stage::camera(const Moment& moment) {
  render::Camera camera = camera_;
  if (settings_.orbit != 0) camera = render::turned(camera, settings_.orbit * moment.time);
  if (followed_) {
    rbd::forwardKinematics(model_, data_, moment.q);
    camera = render::moved(camera, Eigen::Isometry3d(Eigen::Translation3d(data_.oMf[followed_].translation() - home_)));
  }
  return camera;
}

double Stage::width() const {
  const double aspect = static_cast<double>(settings_.size[0]) / static_cast<double>(settings_.size[1]);
  if (still_camera_.orthographic()) return still_camera_.height * aspect;
  return 2 * std::tan(still_camera_.fov / 2) * (still_camera_.eye - still_camera_.target).norm() * aspect;
}

// ---- the way

Stage::Sample Stage::sample(const Moment& moment) {
  Sample out{moment, Eigen::Vector3d::Zero(), 0, 0};
  if (moment.wanted.size() > 0) {
    rbd::forwardKinematics(model_, data_, moment.wanted);
    out.point = data_.oMf[traced_].translation();
  }
  if (moment.v.size() > 0) rbd::forwardKinematics(model_, data_, moment.q, moment.v);
  else rbd::forwardKinematics(model_, data_, moment.q);
  const Eigen::Vector3d& here = data_.oMf[traced_].translation();
  if (moment.wanted.size() > 0) out.error = (here - out.point).norm();
  if (moment.v.size() > 0) out.speed = rbd::getFrameVelocity(model_, data_, traced_, rbd::LOCAL_WORLD_ALIGNED).linear().norm();
  out.point = here;
  return out;
}

void Stage::remember(const Moment& moment) {
  if (!way_.empty() && moment.step <= way_.back().moment.step) return;
  way_.push_back(sample(moment));
  const double value = extras_.trace_by == "error" ? way_.back().error : way_.back().speed;
  most_ = std::max(most_, value);
}

double Stage::share(const Sample& s) const {
  if (extras_.trace_by == "time") return s.moment.time / duration_;
  return most_ > 0 ? (extras_.trace_by == "error" ? s.error : s.speed) / most_ : 0;
}

Eigen::Vector4f Stage::colour(const Sample& s) const {
  return extras_.trace_by == "time" ? render::ramp_time(share(s)) : render::ramp_value(share(s));
}

void Stage::add_trace(const std::vector<Sample>& samples, const std::vector<Eigen::Vector4f>& colours, render::Scene& scene) const {
  std::vector<Eigen::Vector3d> points;
  for (const Sample& s : samples) points.push_back(s.point);
  scene.bodies.push_back(render::make_trace(points, colours, 0.0028 * width()));
}

// ---- scenes

render::Scene Stage::scene(const Moment& moment) {
  render::Scene scene;
  if (!settings_.trace.empty()) {
    std::vector<Sample> samples;
    std::vector<Eigen::Vector4f> colours;
    for (const Sample& s : way_)
      if (s.moment.step < moment.step) samples.push_back(s);
    samples.push_back(sample(moment));  // the trace ends where the tool is
    for (const Sample& s : samples) colours.push_back(colour(s));
    add_trace(samples, colours, scene);
    scene.bodies.push_back(render::make_bead(samples.back().point, 0.006 * width(), colours.back()));
  }
  if (settings_.reference && moment.wanted.size() > 0)
    for (render::Body& body : render::ghost(robot_at(moment.wanted), kReferenceGroup, kReferenceTint, .42f))
      scene.bodies.push_back(std::move(body));
  for (render::Body& body : robot_at(moment.q)) scene.bodies.push_back(std::move(body));
  add_arrows(moment, scene);
  return scene;
}

render::Scene Stage::robot_alone(const Moment& moment) {
  render::Scene scene;
  scene.bodies = robot_at(moment.q);
  return scene;
}

render::Scene Stage::ghosts(int64_t n) {
  render::Scene scene;
  if (way_.empty()) return scene;
  // how far along the way each sample is: in joint space, so that a rest takes no room
  std::vector<double> along{0};
  for (size_t i = 1; i < way_.size(); ++i)
    along.push_back(along.back() + length(rbd::difference(model_, way_[i - 1].moment.q, way_[i].moment.q)));
  const double all = along.back();
  const auto at = [&](size_t i) { return all > 0 ? along[i] / all : 1; };

  std::vector<size_t> chosen;  // the samples nearest to even distances
  for (int64_t k = 0; all > 0 && k + 1 < n; ++k) {
    const double wanted = all * static_cast<double>(k) / static_cast<double>(n - 1);
    const auto after = static_cast<size_t>(std::lower_bound(along.begin(), along.end(), wanted) - along.begin());
    const size_t i = after > 0 && wanted - along[after - 1] < along[after] - wanted ? after - 1 : after;
    if (chosen.empty() || i > chosen.back()) chosen.push_back(i);
  }
  // where the way has ended; what rests there afterwards adds nothing
  const auto end = static_cast<size_t>(std::lower_bound(along.begin(), along.end(), all) - along.begin());
  while (!chosen.empty() && chosen.back() >= end) chosen.pop_back();
  for (size_t k = 0; k < chosen.size(); ++k) {
    Eigen::Vector4f tint = render::ramp_time(at(chosen[k]));
    tint[3] = .62f;
    for (render::Body& body : render::ghost(robot_at(way_[chosen[k]].moment.q), static_cast<int>(k + 1), tint, .40f))
      scene.bodies.push_back(std::move(body));
  }
  for (render::Body& body : robot_at(way_.back().moment.q)) scene.bodies.push_back(std::move(body));

  if (!settings_.trace.empty()) {
    std::vector<Eigen::Vector4f> colours;
    for (size_t i = 0; i < way_.size(); ++i) colours.push_back(extras_.trace_by == "time" ? render::ramp_time(at(i)) : colour(way_[i]));
    add_trace(way_, colours, scene);
    chosen.push_back(way_.size() - 1);
    for (size_t i : chosen) scene.bodies.push_back(render::make_bead(way_[i].point, 0.006 * width(), colours[i]));
  }
  return scene;
}

}  // namespace lab::renderer
