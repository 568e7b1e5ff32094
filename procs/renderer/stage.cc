#include "procs/renderer/stage.h"

#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/kinematics.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lab/check/check.h"
#include "lab/experiment/joints.h"
#include "procs/renderer/robot_scene.h"
#include "render/markers.h"

namespace lab::renderer {
namespace {

constexpr int kPlanned = 48;           // poses of the plan that the camera is set by
constexpr double kAllowance = 0.05;    // of the box's diagonal, by which a run may leave it
constexpr int kReferenceGroup = 1000;  // of translucent bodies; ghosts count from 1
const Eigen::Vector4f kReferenceTint(.16f, .72f, .40f, .75f);

/// Whether a body stands where another one does, as far as an eye could tell.
bool coincide(const render::Body& a, const render::Body& b) {
  constexpr double kSeen = 0.003;  // m
  const render::Bounds box = render::bounds(a);
  const double reach =
      box.isEmpty() ? 0 : (box.center() - a.pose.translation()).norm() + box.diagonal().norm() / 2;
  const double turn = Eigen::AngleAxisd(a.pose.linear().transpose() * b.pose.linear()).angle();
  return (a.pose.translation() - b.pose.translation()).norm() + std::abs(turn) * reach < kSeen;
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
      traced_(settings_.trace.empty() ? 0 : named_frame(e, "renderer.trace", settings_.trace, model_)),
      followed_(settings_.follow.empty() ? 0 : named_frame(e, "renderer.follow", settings_.follow, model_)) {
  const std::vector<Eigen::VectorXd> plan = planned_poses(e, model_, kPlanned);
  rbd::forwardKinematics(model_, data_, plan.front());
  home_ = data_.oMf[followed_].translation();
  for (const Eigen::VectorXd& q : plan) extend(q, box_, followed_box_);
  // the plan's last rest does not count for the colours of time
  for (size_t i = plan.size(); i-- > 1 && plan[i] == plan[i - 1];)
    moving_ = duration_ * static_cast<double>(i - 1) / (kPlanned - 1);
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
    if (!planned.isEmpty() && render::Bounds(planned.min() - room, planned.max() + room).contains(seen))
      return;
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
    camera = render::moved(
        camera, Eigen::Isometry3d(Eigen::Translation3d(data_.oMf[followed_].translation() - home_)));
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
  if (moment.v.size() > 0)
    rbd::forwardKinematics(model_, data_, moment.q, moment.v);
  else
    rbd::forwardKinematics(model_, data_, moment.q);
  const Eigen::Vector3d& here = data_.oMf[traced_].translation();
  if (moment.wanted.size() > 0) out.error = (here - out.point).norm();
  if (moment.v.size() > 0)
    out.speed = rbd::getFrameVelocity(model_, data_, traced_, rbd::LOCAL_WORLD_ALIGNED).linear().norm();
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
  if (extras_.trace_by == "time") return s.moment.time / (moving_ > 0 ? moving_ : duration_);
  return most_ > 0 ? (extras_.trace_by == "error" ? s.error : s.speed) / most_ : 0;
}

Eigen::Vector4f Stage::colour(const Sample& s) const {
  return extras_.trace_by == "time" ? render::ramp_time(share(s)) : render::ramp_value(share(s));
}

void Stage::add_trace(const std::vector<Sample>& samples, const std::vector<Eigen::Vector4f>& colours,
                      render::Scene& scene) const {
  std::vector<Eigen::Vector3d> points;
  for (const Sample& s : samples) points.push_back(s.point);
  scene.bodies.push_back(render::make_trace(points, colours, 0.0033 * width()));
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
    scene.bodies.push_back(render::make_bead(samples.back().point, 0.007 * width(), colours.back()));
  }
  std::vector<render::Body> bodies;
  if (settings_.reference && moment.wanted.size() > 0)
    bodies = render::ghost(robot_at(moment.wanted), kReferenceGroup, kReferenceTint, .5f);
  const std::vector<render::Body> actual = robot_at(moment.q);
  for (size_t i = 0; i < bodies.size(); ++i)  // the ghost shows where it is not the robot
    if (!coincide(bodies[i], actual[i])) scene.bodies.push_back(std::move(bodies[i]));
  scene.bodies.insert(scene.bodies.end(), actual.begin(), actual.end());
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
    const auto after =
        static_cast<size_t>(std::lower_bound(along.begin(), along.end(), wanted) - along.begin());
    const size_t i = after > 0 && wanted - along[after - 1] < along[after] - wanted ? after - 1 : after;
    if (chosen.empty() || i > chosen.back()) chosen.push_back(i);
  }
  // where the way has ended; what rests there afterwards adds nothing
  const auto end = static_cast<size_t>(std::lower_bound(along.begin(), along.end(), all) - along.begin());
  while (!chosen.empty() && chosen.back() >= end) chosen.pop_back();
  const std::vector<render::Body> last = robot_at(way_.back().moment.q);
  std::vector<render::Body> next;
  for (size_t k = chosen.size(); k-- > 0;) {
    Eigen::Vector4f tint = render::ramp_time(at(chosen[k]));
    tint[3] = .62f;
    std::vector<render::Body> bodies =
        render::ghost(robot_at(way_[chosen[k]].moment.q), static_cast<int>(k + 1), tint, .42f);
    for (size_t i = 0; i < bodies.size();
         ++i)  // what has not moved, as a base, is shown once: by the solid robot or the next ghost
      if (!coincide(bodies[i], last[i]) && (next.empty() || !coincide(bodies[i], next[i])))
        scene.bodies.push_back(bodies[i]);
    next = std::move(bodies);
  }
  for (const render::Body& body : last) scene.bodies.push_back(body);

  if (!settings_.trace.empty()) {
    std::vector<Eigen::Vector4f> colours;
    for (size_t i = 0; i < way_.size(); ++i)
      colours.push_back(extras_.trace_by == "time" ? render::ramp_time(at(i)) : colour(way_[i]));
    add_trace(way_, colours, scene);
    chosen.push_back(way_.size() - 1);
    for (size_t i : chosen)
      scene.bodies.push_back(render::make_bead(way_[i].point, 0.007 * width(), colours[i]));
  }
  return scene;
}

}  // namespace lab::renderer
