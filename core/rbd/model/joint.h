// Joints as the user defines them: kind, axis, size in q and v. Plain values.
//
// traits() below defines each kind; kernel/joint_kinds.h has its kinematics, kernel/manifold.h the integration and
// difference of its configurations. No other place distinguishes kinds, and no switch over them has a default: the
// compiler reports each place that does not handle a new kind.
//
// clang-format off
//   kind                    shortname                      q                              v
//   universe (joint 0)      FIXED                          -                              -
//   revolute                RX RY RZ RevoluteUnaligned     angle                          rate
//   continuous (no limit)   CX CY CZ ContinuousUnaligned   one unbounded angle            rate
//   prismatic               PX PY PZ PrismaticUnaligned    position                       rate
//   helical                 HX HY HZ HelicalUnaligned      angle (slides by pitch*angle)  rate
//   universal               Universal                      two angles                     two rates
//   spherical               Spherical                      quaternion xyzw                angular velocity, body axes
//   planar                  Planar                         x y cos sin                    vx vy wz, body axes
//   translation             Translation                    x y z                          rates
//   free-flyer              FreeFlyer                      x y z, quaternion xyzw         body twist, angular first
// clang-format on
//
// A one-dof joint may follow another (Model::setMimic): then it has nq = nv = 0 and idx_q, idx_v are those of
// the joint it follows.
#pragma once

#include <string>

#include "rbd/spatial/so3.h"

namespace rbd {

using JointIndex = int;
using FrameIndex = int;

enum class JointKind {
  Fixed,
  Revolute,
  Continuous,
  Prismatic,
  Helical,
  Universal,
  Spherical,
  Planar,
  Translation,
  FreeFlyer
};

// The configuration space of a joint.
enum class Manifold {
  Angles,      // nq = nv, angles, added as numbers
  Lengths,     // nq = nv, lengths, added as numbers
  Rotation,    // unit quaternion
  PlanarPose,  // x y cos sin
  Pose         // position, unit quaternion
};

// How a joint moves in the kernels, where its axis is z (packed_joint.h).
enum class KernelKind { None, TurnZ, SlideZ, ScrewZ, Ball, Planar, Translate, Free };

// The properties of a joint kind.
struct JointTraits {
  const char* letter;  // "RZ" for the z axis ..
  const char* name;    // .. and this for any other axis, or for kinds without an axis
  int nq, nv;
  Manifold manifold;
  KernelKind kernel;
  int kernel_joints;  // number of kernel joints, in series, that it becomes in the kernels' tree
};

constexpr JointTraits traits(JointKind kind) {
  switch (kind) {
    case JointKind::Fixed:
      return {nullptr, "FIXED", 0, 0, Manifold::Angles, KernelKind::None, 1};
    case JointKind::Revolute:
      return {"R", "RevoluteUnaligned", 1, 1, Manifold::Angles, KernelKind::TurnZ, 1};
    case JointKind::Continuous:
      return {"C", "ContinuousUnaligned", 1, 1, Manifold::Angles, KernelKind::TurnZ, 1};
    case JointKind::Prismatic:
      return {"P", "PrismaticUnaligned", 1, 1, Manifold::Lengths, KernelKind::SlideZ, 1};
    case JointKind::Helical:
      return {"H", "HelicalUnaligned", 1, 1, Manifold::Angles, KernelKind::ScrewZ, 1};
    case JointKind::Universal:
      return {nullptr, "Universal", 2, 2, Manifold::Angles, KernelKind::TurnZ, 2};
    case JointKind::Spherical:
      return {nullptr, "Spherical", 4, 3, Manifold::Rotation, KernelKind::Ball, 1};
    case JointKind::Planar:
      return {nullptr, "Planar", 4, 3, Manifold::PlanarPose, KernelKind::Planar, 1};
    case JointKind::Translation:
      return {nullptr, "Translation", 3, 3, Manifold::Lengths, KernelKind::Translate, 1};
    case JointKind::FreeFlyer:
      return {nullptr, "FreeFlyer", 7, 6, Manifold::Pose, KernelKind::Free, 1};
  }
  __builtin_unreachable();
}

// Number of entries at the end of a configuration that form a unit vector: a quaternion, or cosine and sine.
constexpr int unitSize(Manifold manifold) {
  switch (manifold) {
    case Manifold::Angles:
    case Manifold::Lengths:
      return 0;
    case Manifold::PlanarPose:
      return 2;
    case Manifold::Rotation:
    case Manifold::Pose:
      return 4;
  }
  __builtin_unreachable();
}

// Whether configurations form a vector space: nq = nv, q + v.
constexpr bool isVectorSpace(Manifold manifold) { return unitSize(manifold) == 0; }

// The entries of a joint in q that form a unit vector.
struct UnitPart {
  int at = 0, size = 0;   // q[at] .. q[at + size - 1]; size 0: there is none
  const char* name = "";  // "quaternion (x, y, z, w)", "direction (cos, sin)"
};

class JointModel {
 public:
  // The joint of the universe. Users construct the types below.
  JointModel() = default;

  JointKind kind() const { return kind_; }
  Manifold manifold() const { return traits(kind_).manifold; }
  UnitPart unit_part() const;
  // Unit axis in the joint's frame; zero where a kind has none. Planar: the normal. Universal: the first
  // axis, fixed in the parent; axis2() is fixed in the child.
  const Eigen::Vector3d& axis() const { return axis_; }
  const Eigen::Vector3d& axis2() const { return axis2_; }
  double pitch() const { return pitch_; }  // helical: m/rad
  std::string shortname() const;
  int nq() const { return mimics_ ? 0 : kind_nq(); }
  int nv() const { return mimics_ ? 0 : kind_nv(); }
  // Sizes of the kind, also when the joint follows another.
  int kind_nq() const { return traits(kind_).nq; }
  int kind_nv() const { return traits(kind_).nv; }
  // First index of this joint in q and in v; set by Model, -1 before.
  int idx_q() const { return idx_q_; }
  int idx_v() const { return idx_v_; }
  bool mimics() const { return mimics_; }

 protected:
  explicit JointModel(JointKind kind) : kind_(kind) {}
  // Normalises the axes; throws std::invalid_argument when one is zero or not finite.
  JointModel(JointKind kind, const Eigen::Vector3d& axis);
  JointModel(JointKind kind, const Eigen::Vector3d& axis, double pitch);
  JointModel(JointKind kind, const Eigen::Vector3d& axis, const Eigen::Vector3d& axis2);

 private:
  friend class Model;
  JointKind kind_ = JointKind::Fixed;
  Eigen::Vector3d axis_ = Eigen::Vector3d::Zero(), axis2_ = Eigen::Vector3d::Zero();
  double pitch_ = 0;
  int idx_q_ = -1, idx_v_ = -1;
  bool mimics_ = false;
};

// About or along any axis (normalised here; its sign is kept).
struct JointModelRevoluteUnaligned : JointModel {
  explicit JointModelRevoluteUnaligned(const Eigen::Vector3d& axis) : JointModel(JointKind::Revolute, axis) {}
  JointModelRevoluteUnaligned(double x, double y, double z)
      : JointModelRevoluteUnaligned(Eigen::Vector3d(x, y, z)) {}
};
struct JointModelPrismaticUnaligned : JointModel {
  explicit JointModelPrismaticUnaligned(const Eigen::Vector3d& axis)
      : JointModel(JointKind::Prismatic, axis) {}
  JointModelPrismaticUnaligned(double x, double y, double z)
      : JointModelPrismaticUnaligned(Eigen::Vector3d(x, y, z)) {}
};
// One unbounded angle: the same motion as a revolute joint, no limits, random angles in [-pi, pi].
struct JointModelContinuous : JointModel {
  explicit JointModelContinuous(const Eigen::Vector3d& axis) : JointModel(JointKind::Continuous, axis) {}
  JointModelContinuous(double x, double y, double z) : JointModelContinuous(Eigen::Vector3d(x, y, z)) {}
};

struct JointModelRX : JointModelRevoluteUnaligned {
  JointModelRX() : JointModelRevoluteUnaligned(1, 0, 0) {}
};
struct JointModelRY : JointModelRevoluteUnaligned {
  JointModelRY() : JointModelRevoluteUnaligned(0, 1, 0) {}
};
struct JointModelRZ : JointModelRevoluteUnaligned {
  JointModelRZ() : JointModelRevoluteUnaligned(0, 0, 1) {}
};
struct JointModelPX : JointModelPrismaticUnaligned {
  JointModelPX() : JointModelPrismaticUnaligned(1, 0, 0) {}
};
struct JointModelPY : JointModelPrismaticUnaligned {
  JointModelPY() : JointModelPrismaticUnaligned(0, 1, 0) {}
};
struct JointModelPZ : JointModelPrismaticUnaligned {
  JointModelPZ() : JointModelPrismaticUnaligned(0, 0, 1) {}
};
// Rotates by q about the axis and translates by pitch * q along it. Throws when pitch is not finite.
struct JointModelHelicalUnaligned : JointModel {
  JointModelHelicalUnaligned(const Eigen::Vector3d& axis, double pitch)
      : JointModel(JointKind::Helical, axis, pitch) {}
};
struct JointModelHX : JointModelHelicalUnaligned {
  explicit JointModelHX(double pitch) : JointModelHelicalUnaligned({1, 0, 0}, pitch) {}
};
struct JointModelHY : JointModelHelicalUnaligned {
  explicit JointModelHY(double pitch) : JointModelHelicalUnaligned({0, 1, 0}, pitch) {}
};
struct JointModelHZ : JointModelHelicalUnaligned {
  explicit JointModelHZ(double pitch) : JointModelHelicalUnaligned({0, 0, 1}, pitch) {}
};
// Rotates by q[0] about `first`, then by q[1] about `second` (which moves with the first). Not parallel.
struct JointModelUniversal : JointModel {
  JointModelUniversal(const Eigen::Vector3d& first, const Eigen::Vector3d& second)
      : JointModel(JointKind::Universal, first, second) {}
};
struct JointModelSpherical : JointModel {
  JointModelSpherical() : JointModel(JointKind::Spherical) {}
};
// Translates across `normal` and rotates about it. With normal z, x and y are the frame's own.
struct JointModelPlanar : JointModel {
  explicit JointModelPlanar(const Eigen::Vector3d& normal = Eigen::Vector3d::UnitZ())
      : JointModel(JointKind::Planar, normal) {}
};
struct JointModelTranslation : JointModel {
  JointModelTranslation() : JointModel(JointKind::Translation) {}
};
struct JointModelFreeFlyer : JointModel {
  JointModelFreeFlyer() : JointModel(JointKind::FreeFlyer) {}
};

}  // namespace rbd
