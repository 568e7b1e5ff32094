#include "render/camera.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace lab::render {
namespace {

using Eigen::Vector3d;

constexpr double kMargin = 1.08;  // the picture's size over that of what it shows

const std::vector<std::pair<std::string, View>>& named_views() {
  static const std::vector<std::pair<std::string, View>> views{{"iso", {-0.70, 0.40}},
                                                               {"front", {0, 0.12}},
                                                               {"side", {-M_PI / 2, 0.12}},
                                                               {"top", {-M_PI / 2, M_PI / 2}}};
  return views;
}

// What has to be in the picture: the box's corners, for an orbit at many angles about its vertical axis.
std::vector<Vector3d> points_to_frame(const Bounds& box, bool all_around) {
  std::vector<Vector3d> points;
  const int angles = all_around ? 36 : 1;
  for (int k = 0; k < angles; ++k) {
    const Eigen::AngleAxisd turn(2 * M_PI * k / angles, Vector3d::UnitZ());
    for (int i = 0; i < 8; ++i) {
      const Vector3d corner = box.corner(static_cast<Bounds::CornerType>(i));
      points.push_back(box.center() + turn * (corner - box.center()));
    }
  }
  return points;
}

}  // namespace

Eigen::Isometry3d Camera::view() const {
  if (!eye.allFinite() || !target.allFinite() || !up.allFinite() || !(fov > 0 && fov < M_PI))
    throw std::invalid_argument("camera: eye, target and up must be finite, fov between 0 and pi");
  if (!(height >= 0) || !std::isfinite(height))
    throw std::invalid_argument("camera: the height of an orthographic picture must be finite and positive");
  const Vector3d back = eye - target;
  const Vector3d right = up.cross(back);
  if (!(right.norm() > 1e-9 * up.norm() * back.norm()) || back.norm() == 0)
    throw std::invalid_argument("camera: eye on target, or up along the line of sight");
  const Vector3d z = back.normalized(), x = right.normalized();
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.linear() << x, z.cross(x), z;
  world_from_camera.translation() = eye;
  return world_from_camera.inverse();
}

Eigen::Matrix4d Camera::projection(double aspect, double near, double far) const {
  Eigen::Matrix4d p = Eigen::Matrix4d::Zero();
  if (orthographic()) {
    p(0, 0) = 2 / (height * aspect);
    p(1, 1) = 2 / height;
    p(2, 2) = 2 / (near - far);
    p(2, 3) = (far + near) / (near - far);
    p(3, 3) = 1;
  } else {
    const double f = 1 / std::tan(fov / 2);
    p(0, 0) = f / aspect;
    p(1, 1) = f;
    p(2, 2) = (far + near) / (near - far);
    p(2, 3) = 2 * far * near / (near - far);
    p(3, 2) = -1;
  }
  return p;
}

Vector3d Camera::pixel(const Vector3d& point, int width, int rows) const {
  const Vector3d c = view() * point;
  const double depth = -c.z();
  const double scale = rows / (orthographic() ? height : 2 * std::tan(fov / 2) * depth);
  return {width / 2.0 + c.x() * scale, rows / 2.0 - c.y() * scale, depth};
}

const std::vector<std::string>& view_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, view] : named_views()) all.push_back(name);
    return all;
  }();
  return names;
}

View view_from_name(const std::string& name) {
  std::string known;
  for (const auto& [each, view] : named_views()) {
    if (each == name) return view;
    known += (known.empty() ? "" : ", ") + each;
  }
  throw std::invalid_argument("camera: unknown view '" + name + "' (known: " + known + ")");
}

Camera auto_frame(const Bounds& box, const View& view, double aspect) {
  if (!(aspect > 0.01 && aspect < 100))
    throw std::invalid_argument("camera: aspect must be between 0.01 and 100");
  if (!std::isfinite(view.azimuth) || !(std::abs(view.elevation) <= M_PI / 2) || !std::isfinite(view.orbit))
    throw std::invalid_argument("camera: azimuth and orbit must be finite, elevation between -pi/2 and pi/2");
  if (!(view.distance > 0.01 && view.distance < 100))
    throw std::invalid_argument("camera: distance is a factor between 0.01 and 100");
  Bounds b = box;
  if (b.isEmpty()) b = Bounds(Vector3d(-.5, -.5, 0), Vector3d(.5, .5, 1));
  if (!b.min().allFinite() || !b.max().allFinite())
    throw std::invalid_argument("camera: the box to frame is not finite");

  const double ca = std::cos(view.azimuth), sa = std::sin(view.azimuth);
  const double ce = std::cos(view.elevation), se = std::sin(view.elevation);
  const Vector3d towards(ce * ca, ce * sa, se);  // from the box to the eye
  const double radius = std::max(b.diagonal().norm() / 2, 1e-3);
  const std::vector<Vector3d> points = points_to_frame(b, view.orbit != 0);
  Camera camera;
  camera.up = {-se * ca, -se * sa, ce};
  camera.target = b.center();
  camera.eye = camera.target + towards * 4 * radius;

  // The nearest eye on this line of sight from which every point lies inside the picture, less a margin. Each
  // pass also centres what the one before saw; an orbit keeps to its axis.
  const double tan_y = std::tan(camera.fov / 2) / kMargin, tan_x = tan_y * aspect;
  double distance = 0, extent = 0;
  for (int pass = 0; pass < 4; ++pass) {
    const Eigen::Isometry3d to_camera = camera.view();
    const double middle = -(to_camera * camera.target).z();
    Eigen::AlignedBox2d seen;  // at the target's depth
    distance = extent = 0;
    for (const Vector3d& point : points) {
      const Vector3d c = to_camera * point;
      const double depth = -c.z(), towards_eye = middle - depth;
      seen.extend(c.head<2>() * (view.orthographic ? 1 : middle / depth));
      distance =
          std::max({distance, towards_eye + std::abs(c.x()) / tan_x, towards_eye + std::abs(c.y()) / tan_y});
      extent = std::max({extent, std::abs(c.y()), std::abs(c.x()) / aspect});
    }
    distance = std::max(distance, 1.05 * radius);
    if (pass < 3 && view.orbit == 0) {
      const Eigen::Vector2d off = seen.center();
      camera.target += to_camera.linear().transpose() * Vector3d(off.x(), off.y(), 0);
    }
    camera.eye = camera.target + towards * (view.orthographic ? 4 * radius : distance);
  }
  if (view.orthographic)
    camera.height = 2 * kMargin * std::max(extent, 1e-3) * view.distance;
  else
    camera.eye = camera.target + towards * distance * view.distance;
  return camera;
}

Camera auto_frame(const Bounds& box, const std::string& view, double aspect) {
  return auto_frame(box, view_from_name(view), aspect);
}

Camera turned(const Camera& camera, double radians) {
  const Eigen::AngleAxisd turn(radians, Vector3d::UnitZ());
  return moved(camera, Eigen::Translation3d(camera.target) * turn * Eigen::Translation3d(-camera.target));
}

Camera moved(const Camera& camera, const Eigen::Isometry3d& motion) {
  Camera out = camera;
  out.eye = motion * camera.eye;
  out.target = motion * camera.target;
  out.up = motion.linear() * camera.up;
  return out;
}

}  // namespace lab::render
