#include "rbd/spatial/so3.h"

#include <cmath>

#include "rbd/spatial/rotation_series.h"

namespace rbd {

using inner::halfSineOverAngle;
using inner::kTiny;

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

Eigen::Vector3d unSkew(const Eigen::Matrix3d& m) {
  return 0.5 * Eigen::Vector3d(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
}

Eigen::Quaterniond exp3Quaternion(const Eigen::Vector3d& w) {
  const double t = w.norm();
  const double s = halfSineOverAngle(t, std::sin(t / 2));
  return Eigen::Quaterniond(std::cos(t / 2), s * w.x(), s * w.y(), s * w.z());
}

Eigen::Matrix3d exp3(const Eigen::Vector3d& w) {
  const double t = w.norm();
  // a = sin t / t, b = (1 - cos t) / t^2 = 2 sin^2(t/2) / t^2, which does not cancel.
  const double a = t < kTiny ? 1 - t * t / 6 : std::sin(t) / t;
  const double h = halfSineOverAngle(t, std::sin(t / 2));
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() + a * W + 2 * h * h * W * W;
}

Eigen::Vector3d log3(const Eigen::Quaterniond& q) {
  // atan2 keeps full accuracy at every angle; q and -q are the same rotation, take the short way.
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double n = v.norm(), w = sign * q.w();
  const double factor = n < kTiny ? 2 / w * (1 - n * n / (3 * w * w)) : 2 * std::atan2(n, w) / n;
  return factor * v;
}

Eigen::Vector3d log3(const Eigen::Matrix3d& R) { return log3(Eigen::Quaterniond(R).normalized()); }

Eigen::Matrix3d leftJacobian3(const Eigen::Vector3d& w) {
  const double t = w.norm();
  const double h = halfSineOverAngle(t, std::sin(t / 2));
  const double c = inner::secondTerm(t, std::sin(t));
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() + 2 * h * h * W + c * W * W;
}

Eigen::Matrix3d leftJacobian3Inverse(const Eigen::Vector3d& w) {
  const double t = w.norm(), t2 = t * t;
  // d = 1/t^2 - (1 + cos t) / (2 t sin t), and (1 + cos t) / sin t = 1 / tan(t/2).
  const double d =
      t < 0.1 ? (1 + t2 / 60 * (1 + t2 / 42 * (1 + t2 / 40))) / 12 : (1 - 0.5 * t / std::tan(t / 2)) / t2;
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() - 0.5 * W + d * W * W;
}

Eigen::Matrix3d rpyToMatrix(double roll, double pitch, double yaw) {
  const double cr = std::cos(roll), sr = std::sin(roll);
  const double cp = std::cos(pitch), sp = std::sin(pitch);
  const double cy = std::cos(yaw), sy = std::sin(yaw);
  Eigen::Matrix3d R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

Eigen::Matrix3d rpyToMatrix(const Eigen::Vector3d& rpy) { return rpyToMatrix(rpy.x(), rpy.y(), rpy.z()); }

Eigen::Vector3d matrixToRpy(const Eigen::Matrix3d& R) {
  const double cp = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cp);
  if (cp < 1e-15) return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  // roll from what is left when yaw is taken back: near pitch = 90 degrees both are ill known, their sum is
  // not
  const double yaw = std::atan2(R(1, 0), R(0, 0)), s = std::sin(yaw), c = std::cos(yaw);
  return {std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1)), pitch, yaw};
}

bool isRotation(const Eigen::Matrix3d& R, double tol) {
  const double error =
      (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  return error <= tol && R.determinant() > 0;
}

Eigen::Matrix3d rotationWithZ(const Eigen::Vector3d& axis) {
  // exact permutations for the coordinate axes, so that no rounding enters the common robots
  Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (axis == Eigen::Vector3d::Unit(k)) {
      R(k, 2) = R((k + 1) % 3, 0) = R((k + 2) % 3, 1) = 1;
      return R;
    }
  }
  // otherwise an orthonormal basis without singular directions (Duff et al. 2017)
  const double s = std::copysign(1.0, axis.z());
  const double a = -1 / (s + axis.z()), b = axis.x() * axis.y() * a;
  R.col(0) << 1 + s * axis.x() * axis.x() * a, s * b, -s * axis.x();
  R.col(1) << b, s + axis.y() * axis.y() * a, -axis.y();
  R.col(2) = axis;
  return R;
}

}  // namespace rbd
