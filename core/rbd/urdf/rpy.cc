// Compiled without fused multiply-add (CMakeLists.txt), as urdfdom is. Keep other code out of this file.
#include "rbd/urdf/rpy.h"

#include <cmath>

namespace rbd::urdf {

Eigen::Quaterniond rpy_to_quaternion(const Eigen::Vector3d& rpy) {
  const double roll = rpy[0] / 2, pitch = rpy[1] / 2, yaw = rpy[2] / 2;
  const double sr = std::sin(roll), cr = std::cos(roll);
  const double sp = std::sin(pitch), cp = std::cos(pitch);
  const double sy = std::sin(yaw), cy = std::cos(yaw);
  const double x = sr * cp * cy - cr * sp * sy;
  const double y = cr * sp * cy + sr * cp * sy;
  const double z = cr * cp * sy - sr * sp * cy;
  const double w = cr * cp * cy + sr * sp * sy;
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  return {w / length, x / length, y / length, z / length};
}

}  // namespace rbd::urdf
