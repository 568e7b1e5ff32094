#include "render/camera.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace lab::render {

Eigen::Isometry3d Camera::view() const {
  if (!eye.allFinite() || !target.allFinite() || !up.allFinite() || !(fov > 0 && fov < M_PI))
    throw std::invalid_argument("camera: eye, target and up must be finite, fov between 0 and pi");
  const Eigen::Vector3d back = eye - target;
  const Eigen::Vector3d right = up.cross(back);
  if (!(right.norm() > 1e-9 * up.norm() * back.norm()) || back.norm() == 0)
    throw std::invalid_argument("camera: eye on target, or up along the line of sight");
  const Eigen::Vector3d z = back.normalized(), x = right.normalized();
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.linear() << x, z.cross(x), z;
  world_from_camera.translation() = eye;
  return world_from_camera.inverse();
}

Eigen::Matrix4d Camera::projection(double aspect, double near, double far) const {
  const double f = 1 / std::tan(fov / 2);
  Eigen::Matrix4d p = Eigen::Matrix4d::Zero();
  p(0, 0) = f / aspect;
  p(1, 1) = f;
  p(2, 2) = (far + near) / (near - far);
  p(2, 3) = 2 * far * near / (near - far);
  p(3, 2) = -1;
  return p;
}

Eigen::Vector3d Camera::pixel(const Eigen::Vector3d& point, int width, int height) const {
  const Eigen::Vector3d c = view() * point;
  const double depth = -c.z();
  const double scale = height / (2 * std::tan(fov / 2) * depth);
  return {width / 2.0 + c.x() * scale, height / 2.0 - c.y() * scale, depth};
}

const std::vector<std::string>& view_names() {
  static const std::vector<std::string> names{"iso", "front", "side", "top"};
  return names;
}

Camera auto_frame(const Bounds& box, const std::string& view, double aspect) {
  Eigen::Vector3d towards, up{0, 0, 1};  // from the box to the eye
  if (view == "iso") {
    towards = {1.0, -0.84, 0.56};
  } else if (view == "front") {
    towards = {1, 0, 0.12};
  } else if (view == "side") {
    towards = {0, -1, 0.12};
  } else if (view == "top") {
    towards = {0, 0, 1};
    up = {0, 1, 0};
  } else {
    std::string known;
    for (const std::string& name : view_names()) known += (known.empty() ? "" : ", ") + name;
    throw std::invalid_argument("camera: unknown view '" + view + "' (known: " + known + ")");
  }
  if (!(aspect > 0.01 && aspect < 100))
    throw std::invalid_argument("camera: aspect must be between 0.01 and 100");

  Bounds b = box;
  if (b.isEmpty()) b = Bounds(Eigen::Vector3d(-.5, -.5, 0), Eigen::Vector3d(.5, .5, 1));
  if (!b.min().allFinite() || !b.max().allFinite())
    throw std::invalid_argument("camera: the box to frame is not finite");

  // The nearest eye on this line of sight from which every corner lies inside the picture, less a margin. The
  // first pass frames the corners around the box's centre; the second also centres what the first one saw.
  constexpr double kMargin = 1.08;
  Camera camera;
  camera.up = up;
  camera.target = b.center();
  const double radius = std::max(b.diagonal().norm() / 2, 1e-3);
  const double tan_y = std::tan(camera.fov / 2) / kMargin, tan_x = tan_y * aspect;
  camera.eye = camera.target + towards.normalized() * 4 * radius;
  for (int pass = 0; pass < 4; ++pass) {
    const Eigen::Isometry3d to_camera = camera.view();
    double lo_x = 1e300, hi_x = -1e300, lo_y = 1e300, hi_y = -1e300, distance = 0;
    const double middle = -(to_camera * camera.target).z();
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d c = to_camera * b.corner(static_cast<Bounds::CornerType>(i));
      const double depth = -c.z(), towards_eye = middle - depth;
      lo_x = std::min(lo_x, c.x() / depth), hi_x = std::max(hi_x, c.x() / depth);
      lo_y = std::min(lo_y, c.y() / depth), hi_y = std::max(hi_y, c.y() / depth);
      distance =
          std::max({distance, towards_eye + std::abs(c.x()) / tan_x, towards_eye + std::abs(c.y()) / tan_y});
    }
    distance = std::max(distance, 1.05 * radius);
    const Eigen::Vector3d shift = to_camera.linear().transpose() *
                                  Eigen::Vector3d((lo_x + hi_x) / 2 * middle, (lo_y + hi_y) / 2 * middle, 0);
    if (pass < 3) camera.target += shift;
    camera.eye = camera.target + towards.normalized() * distance;
  }
  return camera;
}

}  // namespace lab::render
