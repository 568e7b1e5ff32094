// Loads a robot by the name that a person gives: a file, package://.. or builtin:NAME.
#pragma once
#include <rbd/model/model.h>
#include <rbd/urdf/diagnostic.h>

#include <optional>
#include <string>
#include <vector>

namespace lab::model {

struct RobotOptions {
  bool floating_base = false;
  bool mimic = true;                       ///< false: mimic joints are free
  bool meshes = false;                     ///< warn about mesh files that are missing
  std::optional<Eigen::Vector3d> gravity;  ///< m/s2, in place of (0, 0, -9.81)
};

/// The names are builtin:manipulator, builtin:humanoid, package://.., or a file.
struct Robot {
  std::string file;  ///< where it was found, or the name of a builtin one
  rbd::Model model;  ///< empty unless ok()
  std::vector<rbd::urdf::Diagnostic> diagnostics;

  bool ok() const;
};

/// Does not throw for wrong names: a name that leads nowhere is a diagnostic as well.
Robot load(const std::string& name, const RobotOptions& options);

/// "0,0,-1.62" as numbers. Throws std::invalid_argument.
Eigen::Vector3d gravity_of(const std::string& text);

}  // namespace lab::model
