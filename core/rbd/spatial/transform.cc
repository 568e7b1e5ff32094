#include "rbd/spatial/transform.h"

namespace rbd {

Eigen::Matrix4d SE3::toHomogeneousMatrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation_;
  m.topRightCorner<3, 1>() = translation_;
  return m;
}

Matrix6d SE3::toActionMatrix() const {
  Matrix6d m;
  m << rotation_, Eigen::Matrix3d::Zero(), skew(translation_) * rotation_, rotation_;
  return m;
}

SE3 exp6(const Motion& v) { return {exp3(v.angular()), leftJacobian3(v.angular()) * v.linear()}; }

Motion log6(const SE3& m) {
  const Eigen::Vector3d w = log3(m.rotation());
  return {w, leftJacobian3Inverse(w) * m.translation()};
}

}  // namespace rbd
