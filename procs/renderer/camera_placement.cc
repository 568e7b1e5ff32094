#include "procs/renderer/camera_placement.h"

#include <cmath>

namespace lab::renderer {
namespace {

constexpr double kAllowance = 0.05;  // of the box's diagonal, by which a run may leave the planned volume

void include(render::Bounds& planned, const render::Bounds& seen) {
  const Eigen::Vector3d room = Eigen::Vector3d::Constant(kAllowance * planned.diagonal().norm());
  if (!planned.isEmpty() && render::Bounds(planned.min() - room, planned.max() + room).contains(seen)) return;
  planned.extend(seen);
}

}  // namespace

CameraPlacement::CameraPlacement(const Experiment::Renderer& settings, bool follows,
                                 const Eigen::Vector3d& home)
    : settings_(settings), follows_(follows), home_(home) {}

void CameraPlacement::extend(Extent& extent, const std::vector<render::Body>& robot,
                             const Eigen::Vector3d& followed) const {
  for (const render::Body& body : robot) {
    render::Bounds box = render::bounds(body);
    extent.world.extend(box);
    if (!box.isEmpty()) extent.followed.extend(box.translate(home_ - followed));
  }
}

void CameraPlacement::set_planned(const Extent& planned) {
  extent_ = planned;
  place();
}

void CameraPlacement::include_run(const Extent& seen) {
  include(extent_.world, seen.world);
  include(extent_.followed, seen.followed);
  place();
}

double CameraPlacement::aspect() const {
  return static_cast<double>(settings_.size[0]) / static_cast<double>(settings_.size[1]);
}

void CameraPlacement::place() {
  render::View view = render::view_from_name(settings_.camera);
  view.orthographic = settings_.orthographic;
  still_ = render::auto_frame(extent_.world, view, aspect());
  view.orbit = settings_.orbit;
  camera_ = render::auto_frame(follows_ ? extent_.followed : extent_.world, view, aspect());
}

render::Camera CameraPlacement::at(double time, const Eigen::Vector3d& followed) const {
  render::Camera camera = camera_;
  if (settings_.orbit != 0) camera = render::turned(camera, settings_.orbit * time);
  if (follows_) camera = render::moved(camera, Eigen::Isometry3d(Eigen::Translation3d(followed - home_)));
  return camera;
}

double CameraPlacement::picture_width() const {
  if (still_.orthographic()) return still_.height * aspect();
  return 2 * std::tan(still_.fov / 2) * (still_.eye - still_.target).norm() * aspect();
}

}  // namespace lab::renderer
