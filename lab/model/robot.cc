#include "lab/model/robot.h"

#include <fmt/format.h>
#include <rbd/rbd.h>
#include <rbd/urdf/shapes.h>
#include <rbd/urdf/urdf.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace lab::model {
namespace {

namespace fs = std::filesystem;

Robot refused(const std::string& name, const std::string& message) {
  Robot robot;
  robot.file = name;
  robot.diagnostics.push_back({rbd::urdf::Severity::Error, name, 0, "", message});
  return robot;
}

Robot builtin(const std::string& name, const RobotOptions& options) {
  Robot robot;
  robot.file = name;
  if (name == "builtin:manipulator") {
    rbd::buildModels::manipulator(robot.model);
  } else if (name == "builtin:humanoid") {
    rbd::buildModels::humanoid(robot.model);
  } else {
    return refused(name, "is not known; builtin are builtin:manipulator and builtin:humanoid");
  }
  if (options.floating_base)
    return refused(name, "--floating-base is for URDF robots; builtin:humanoid floats anyway");
  return robot;
}

/// The file that a URI stands for; or empty, and why.
std::string find(const std::string& uri, std::string& why) {
  const std::string here = (fs::current_path() / "x").string();
  const std::vector<std::string> tried = rbd::urdf::mesh_candidates(uri, here, {});
  if (tried.empty()) {
    why = "is not known; give builtin:NAME, package://.. or a file";
    return "";
  }
  std::string places;
  for (const std::string& file : tried) {
    std::error_code none;
    if (fs::is_regular_file(file, none)) return file;
    places += (places.empty() ? "" : ", ") + file;
  }
  why = "cannot be found";
  if (uri.starts_with("package://example-robot-data/"))
    why += "; get it with scripts/lab robots, then LAB_PACKAGE_PATH=$(scripts/lab robots --path)";
  else if (uri.starts_with("package://"))
    why += "; add the folder that holds the package to LAB_PACKAGE_PATH";
  why += " (tried " + places + ")";
  return "";
}

}  // namespace

bool Robot::ok() const {
  return std::none_of(diagnostics.begin(), diagnostics.end(),
                      [](const auto& d) { return d.severity == rbd::urdf::Severity::Error; });
}

Robot load(const std::string& name, const RobotOptions& options) {
  Robot robot;
  if (name.starts_with("builtin:")) {
    robot = builtin(name, options);
  } else {
    robot.file = name;
    std::string why;
    if (name.find("://") != name.npos) {
      robot.file = find(name, why);
      if (robot.file.empty()) return refused(name, why);
    }
    rbd::urdf::Options urdf;
    urdf.floating_base = options.floating_base;
    urdf.mimic = options.mimic;
    urdf.meshes = options.meshes;
    rbd::urdf::Loaded loaded = rbd::urdf::load(robot.file, urdf);
    robot.model = std::move(loaded.model);
    robot.diagnostics = std::move(loaded.diagnostics);
  }
  if (options.gravity) robot.model.gravity.linear(*options.gravity);
  return robot;
}

Eigen::Vector3d gravity_of(const std::string& text) {
  Eigen::Vector3d out;
  const char* at = text.c_str();
  for (int k = 0; k < 3; ++k) {
    char* end = nullptr;
    out[k] = std::strtod(at, &end);
    if (end == at || !std::isfinite(out[k]) || *end != (k < 2 ? ',' : '\0'))
      throw std::invalid_argument(fmt::format("'{}' is not x,y,z in m/s2, such as 0,0,-9.81", text));
    at = end + 1;
  }
  return out;
}

}  // namespace lab::model
