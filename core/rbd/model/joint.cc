#include "rbd/model/joint.h"

#include <cmath>
#include <stdexcept>

namespace rbd {
namespace {

struct KindRow {
  const char* letter;  // "RZ" for the z axis ..
  const char* name;    // .. and this for any other axis, or for kinds without an axis
  int nq, nv;
};

// Indexed by JointKind.
constexpr KindRow kKinds[] = {
    {nullptr, "FIXED", 0, 0},          {"R", "RevoluteUnaligned", 1, 1}, {"C", "ContinuousUnaligned", 1, 1},
    {"P", "PrismaticUnaligned", 1, 1}, {nullptr, "FreeFlyer", 7, 6},
};

const KindRow& row(JointKind kind) { return kKinds[static_cast<int>(kind)]; }

}  // namespace

JointModel::JointModel(JointKind kind, const Eigen::Vector3d& axis) : kind_(kind), axis_(axis) {
  const double n = axis.norm();
  if (!(n > 0) || !std::isfinite(n)) {
    throw std::invalid_argument(std::string(row(kind).name) + ": the axis must be finite and not zero (" +
                                std::to_string(axis.x()) + " " + std::to_string(axis.y()) + " " +
                                std::to_string(axis.z()) + ")");
  }
  if (std::abs(n - 1) > 1e-15) axis_ /= n;  // a unit axis stays as it is, bit for bit
}

std::string JointModel::shortname() const {
  if (row(kind_).letter) {
    for (int k = 0; k < 3; ++k) {
      if (axis_ == Eigen::Vector3d::Unit(k)) return std::string(row(kind_).letter) + "XYZ"[k];
    }
  }
  return row(kind_).name;
}

int JointModel::nq() const { return row(kind_).nq; }
int JointModel::nv() const { return row(kind_).nv; }

}  // namespace rbd
