// A URDF file as plain values: read once, then checked, then built into a model. Lines are those of the file.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rbd/urdf/diagnostic.h"

namespace rbd::urdf {

// <origin>: translation in m, then fixed-axis angles in rad.
struct Origin {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();
};

struct Inertial {
  Origin origin;    // of the centre of mass and the tensor's axes, in the link
  double mass = 0;  // kg
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();  // kg m^2, about the centre of mass
  int tensor_line = 0;
};

struct Link {
  std::string name;
  int line = 0;
  std::optional<Inertial> inertial;
};

enum class JointType { Fixed, Revolute, Continuous, Prismatic, Planar, Floating };

// As a URDF writes it: "revolute".
const char* name_of(JointType type);

// One of the two links of a joint.
struct JointEnd {
  std::string link;
  int line = 0;
};

// What <limit> gives; position limits count for revolute and prismatic joints only.
struct Limit {
  double lower = 0, upper = 0;      // rad or m
  double effort = 0, velocity = 0;  // N m or N; rad/s or m/s
};

struct Mimic {
  std::string leader;
  double multiplier = 1, offset = 0;
  int line = 0;
  std::vector<Diagnostic> faults;  // in its own text; reported by check_mimic, after the checks of the tree
};

struct Joint {
  std::string name;
  int line = 0, name_line = 0;  // of the element, of its attribute
  JointType type = JointType::Fixed;
  JointEnd parent, child;
  Origin origin;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // as written, of any length
  std::optional<Limit> limit;
  double damping = 0, friction = 0;
  std::optional<Mimic> mimic;
};

// Links and joints by name.
struct Description {
  std::string name;
  std::map<std::string, Link> links;
  std::map<std::string, Joint> joints;
};

// How messages name an element: "link 'hand'"; "link" if it has no name.
std::string owner_of(const Link& link);
std::string owner_of(const Joint& joint);

}  // namespace rbd::urdf
