#include "rbd/model/joint.h"

#include <cmath>
#include <stdexcept>

namespace rbd {
namespace {

struct KindRow {
  const char* letter;  // "RZ" for the z axis ..
  const char* name;    // .. and this for any other axis, or for kinds without an axis
  int nq, nv;
  Manifold manifold;
};

// Indexed by JointKind.
constexpr KindRow kKinds[] = {
    {nullptr, "FIXED", 0, 0, Manifold::Angles},
    {"R", "RevoluteUnaligned", 1, 1, Manifold::Angles},
    {"C", "ContinuousUnaligned", 1, 1, Manifold::Angles},
    {"P", "PrismaticUnaligned", 1, 1, Manifold::Lengths},
    {"H", "HelicalUnaligned", 1, 1, Manifold::Angles},
    {nullptr, "Universal", 2, 2, Manifold::Angles},
    {nullptr, "Spherical", 4, 3, Manifold::Rotation},
    {nullptr, "Planar", 4, 3, Manifold::PlanarPose},
    {nullptr, "Translation", 3, 3, Manifold::Lengths},
    {nullptr, "FreeFlyer", 7, 6, Manifold::Pose},
};

// How many of the last numbers of a configuration have length 1.
int unitSize(Manifold manifold) {
  switch (manifold) {
    case Manifold::Angles:
    case Manifold::Lengths:
      return 0;
    case Manifold::Rotation:
    case Manifold::Pose:
      return 4;
    case Manifold::PlanarPose:
      return 2;
  }
  __builtin_unreachable();
}

const KindRow& row(JointKind kind) { return kKinds[static_cast<int>(kind)]; }

[[noreturn]] void fail(JointKind kind, const std::string& text) {
  throw std::invalid_argument(std::string(row(kind).name) + ": " + text);
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
  if (row(kind_).letter) {
    for (int k = 0; k < 3; ++k) {
      if (axis_ == Eigen::Vector3d::Unit(k)) return std::string(row(kind_).letter) + "XYZ"[k];
    }
  }
  return row(kind_).name;
}

bool isVectorSpace(Manifold manifold) { return unitSize(manifold) == 0; }

UnitPart JointModel::unit_part() const {
  const int size = unitSize(manifold());
  if (size == 0) return {};
  return {idx_q_ + kind_nq() - size, size, size == 4 ? "quaternion (x, y, z, w)" : "direction (cos, sin)"};
}

Manifold JointModel::manifold() const { return row(kind_).manifold; }
int JointModel::kind_nq() const { return row(kind_).nq; }
int JointModel::kind_nv() const { return row(kind_).nv; }

}  // namespace rbd
