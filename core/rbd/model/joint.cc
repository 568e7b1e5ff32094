#include "rbd/model/joint.h"

#include <cmath>
#include <stdexcept>

namespace rbd {
namespace {

[[noreturn]] void fail(JointKind kind, const std::string& text) {
  throw std::invalid_argument(std::string(traits(kind).name) + ": " + text);
}

std::string text(const Eigen::Vector3d& x) {
  return std::to_string(x.x()) + " " + std::to_string(x.y()) + " " + std::to_string(x.z());
}

Eigen::Vector3d unitAxis(JointKind kind, const Eigen::Vector3d& axis) {
  const double n = axis.norm();
  if (!(n > 0) || !std::isfinite(n)) fail(kind, "the axis must be finite and not zero (" + text(axis) + ")");
  return std::abs(n - 1) > 1e-15 ? Eigen::Vector3d(axis / n)
                                 : axis;  // a unit axis stays as it is, bit for bit
}

}  // namespace

JointModel::JointModel(JointKind kind, const Eigen::Vector3d& axis)
    : kind_(kind), axis_(unitAxis(kind, axis)) {}

JointModel::JointModel(JointKind kind, const Eigen::Vector3d& axis, double pitch) : JointModel(kind, axis) {
  if (!std::isfinite(pitch)) fail(kind, "the pitch must be finite (" + std::to_string(pitch) + ")");
  pitch_ = pitch;
}

JointModel::JointModel(JointKind kind, const Eigen::Vector3d& axis, const Eigen::Vector3d& axis2)
    : JointModel(kind, axis) {
  axis2_ = unitAxis(kind, axis2);
  if (axis_.cross(axis2_).norm() < 1e-6)
    fail(kind, "the axes must not be parallel (" + text(axis) + "; " + text(axis2) + ")");
}

std::string JointModel::shortname() const {
  if (traits(kind_).letter) {
    for (int k = 0; k < 3; ++k) {
      if (axis_ == Eigen::Vector3d::Unit(k)) return std::string(traits(kind_).letter) + "XYZ"[k];
    }
  }
  return traits(kind_).name;
}

UnitPart JointModel::unit_part() const {
  const int size = unitSize(manifold());
  if (size == 0) return {};
  return {idx_q_ + kind_nq() - size, size, size == 4 ? "quaternion (x, y, z, w)" : "direction (cos, sin)"};
}

}  // namespace rbd
