// Roll, pitch and yaw of an <origin> as a quaternion, in urdfdom's order of operations.
#pragma once

#include <Eigen/Geometry>

namespace rbd::urdf {

// Unit quaternion of Rz(yaw) Ry(pitch) Rx(roll). Every number is urdfdom's to the last bit.
Eigen::Quaterniond rpy_to_quaternion(const Eigen::Vector3d& rpy);

}  // namespace rbd::urdf
