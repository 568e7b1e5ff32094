// Joints as a user names them: kind, axis, how many numbers they take. Plain values.
//
// This file and joint.cc are the place that names joint kinds and counts their numbers; what a kind does
// inside the algorithms lives in algorithm/joint_kinds.h, how its configurations are added and compared in
// algorithm/configuration.cc. A new kind is one line in each.
//
//   kind                          shortname                      q                       v
//   universe (joint 0, fixed)     FIXED                          -                       -
//   revolute                      RX RY RZ RevoluteUnaligned     angle                   rate
//   continuous (no limit)         CX CY CZ ContinuousUnaligned   one unbounded angle     rate
//   prismatic                     PX PY PZ PrismaticUnaligned    position                rate
//   free-flyer                    FreeFlyer                      position, quaternion xyzw   body twist,
//   angular first
#pragma once

#include <string>

#include "rbd/spatial/so3.h"

namespace rbd {

using JointIndex = int;
using FrameIndex = int;

enum class JointKind { Fixed, Revolute, Continuous, Prismatic, FreeFlyer };

class JointModel {
 public:
  // The joint of the universe. Users build the types below.
  JointModel() = default;

  JointKind kind() const { return kind_; }
  // Unit axis in the joint's frame; zero where a kind has none.
  const Eigen::Vector3d& axis() const { return axis_; }
  std::string shortname() const;
  int nq() const;
  int nv() const;
  // Where this joint's numbers start in q and in v; set by Model::addJoint, -1 before.
  int idx_q() const { return idx_q_; }
  int idx_v() const { return idx_v_; }

 protected:
  // Normalises `axis`; throws std::invalid_argument when it is zero or not finite.
  JointModel(JointKind kind, const Eigen::Vector3d& axis);
  explicit JointModel(JointKind kind) : kind_(kind) {}

 private:
  friend class Model;
  JointKind kind_ = JointKind::Fixed;
  Eigen::Vector3d axis_ = Eigen::Vector3d::Zero();
  int idx_q_ = -1, idx_v_ = -1;
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
struct JointModelFreeFlyer : JointModel {
  JointModelFreeFlyer() : JointModel(JointKind::FreeFlyer) {}
};

}  // namespace rbd
