#include "render/view_frame.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lab::render {

using Eigen::Matrix4d;
using Eigen::Vector3d;

Eigen::AlignedBox2d ViewFrame::floor() const {
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(floor_radius);
  return {floor_centre - half, floor_centre + half};
}

Matrix4d ViewFrame::shadow_from_world() const {
  Matrix4d m = Matrix4d::Identity();
  m.topLeftCorner<3, 3>() *= 0.5;
  m.topRightCorner<3, 1>().setConstant(0.5);
  return m * shadow.clip_from_world;
}

ViewFrame make_view_frame(const Scene& scene, const Camera& camera, const Bounds& all, int width,
                          int height) {
  ViewFrame s;
  const Eigen::Isometry3d to_camera = camera.view();
  s.sun = scene.light.towards.normalized();
  if (!s.sun.allFinite() || s.sun.norm() < 0.5 || !(scene.light.strength >= 0 && scene.light.strength <= 100))
    throw std::invalid_argument("renderer: the light needs a direction and a strength of 0 to 100");
  if (!std::isfinite(scene.ground.height) || !(scene.ground.spacing > 0) ||
      !std::isfinite(scene.ground.spacing))
    throw std::invalid_argument("renderer: the floor needs a finite height and a positive grid spacing");

  const Vector3d back = to_camera.linear().row(2).transpose();
  s.eye = camera.orthographic() ? Eigen::Vector4d(back.x(), back.y(), back.z(), 0) : camera.eye.homogeneous();
  const double reach = (camera.eye - camera.target).norm(), above = camera.eye.z() - scene.ground.height;
  s.floor_visible = scene.ground.visible && (camera.orthographic() ? back.z() > 1e-3 : above > 0);
  s.floor_centre = camera.target.head<2>();
  s.floor_radius = 7 * std::max(reach, above);
  // Depth range: from close to the eye to behind both the bodies and the end of the floor.
  double far = reach + 2 * s.floor_radius;
  if (!all.isEmpty()) far = std::max(far, (all.center() - camera.eye).norm() + all.diagonal().norm());
  const double aspect = static_cast<double>(width) / height;
  const double near = camera.orthographic() ? -far : 0.01 * reach;
  s.clip_from_world = camera.projection(aspect, near, far) * to_camera.matrix();
  s.depth_from_world = -to_camera.matrix().row(2).transpose();
  // An orthographic eye would see one line of sight and so one colour: its sky is a pinhole camera's.
  Camera pinhole = camera;
  pinhole.height = 0;
  Matrix4d turn = Matrix4d::Identity();
  turn.topLeftCorner<3, 3>() = to_camera.linear();
  s.ray_from_clip = (pinhole.projection(aspect, 1, 2) * turn).inverse();
  return s;
}

Eigen::Array4i covered_pixels(const ViewFrame& view, const Bounds& box, int width, int height) {
  if (box.isEmpty()) return {0, 0, 0, 0};
  Eigen::AlignedBox2d seen;
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner = box.corner(static_cast<Bounds::CornerType>(i));
    const Eigen::Vector4d c = view.clip_from_world * corner.homogeneous();
    if (!(c.w() > 1e-6)) return {0, 0, width, height};  // it reaches behind the eye
    seen.extend(c.head<2>() / c.w());
  }
  const Eigen::Array2d size(width, height);
  const Eigen::Array2d low = ((seen.min().array() + 1) / 2 * size - 2).floor().max(0).min(size);
  const Eigen::Array2d high = ((seen.max().array() + 1) / 2 * size + 2).ceil().max(0).min(size);
  return {static_cast<int>(low.x()), static_cast<int>(low.y()),
          static_cast<int>(std::max(0., high.x() - low.x())),
          static_cast<int>(std::max(0., high.y() - low.y()))};
}

}  // namespace lab::render
