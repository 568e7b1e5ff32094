#include "rbd/spatial/transform.h"

#include <cmath>

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

namespace {

// The lower left block of leftJacobian6. Below 0.1 rad by series: the closed forms cancel.
Eigen::Matrix3d couplingBlock(const Motion& v) {
  const Eigen::Matrix3d W = skew(v.angular()), V = skew(v.linear());
  const double t2 = v.angular().squaredNorm(), t = std::sqrt(t2);
  double a, b, c;
  if (t < 0.1) {
    a = 1.0 / 6 + t2 * (-1.0 / 120 + t2 * (1.0 / 5040 - t2 / 362880));
    b = 1.0 / 24 + t2 * (-1.0 / 720 + t2 * (1.0 / 40320 - t2 / 3628800));
    c = 1.0 / 120 + t2 * (-1.0 / 2520 + t2 * (1.0 / 120960 - t2 / 9979200));
  } else {
    const double s = std::sin(t), k = std::cos(t);
    a = (t - s) / (t2 * t);
    b = (t2 + 2 * k - 2) / (2 * t2 * t2);
    c = (2 * t - 3 * s + t * k) / (2 * t2 * t2 * t);
  }
  const Eigen::Matrix3d WV = W * V, VW = V * W, WVW = WV * W;
  return 0.5 * V + a * (WV + VW + WVW) + b * (W * WV + VW * W - 3 * WVW) + c * (WVW * W + W * WVW);
}

}  // namespace

Matrix6d leftJacobian6(const Motion& v) {
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = leftJacobian3(v.angular());
  J.bottomLeftCorner<3, 3>() = couplingBlock(v);
  return J;
}

Matrix6d leftJacobian6Inverse(const Motion& v) {
  const Eigen::Matrix3d inverse = leftJacobian3Inverse(v.angular());
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = inverse;
  J.bottomLeftCorner<3, 3>() = -inverse * couplingBlock(v) * inverse;
  return J;
}

}  // namespace rbd
