#include "lab/experiment/robot.h"

#include <rbd/model/near_names.h>
#include <rbd/model/sample_geometries.h>
#include <rbd/rbd.h>
#include <rbd/urdf/shapes.h>
#include <rbd/urdf/urdf.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/util/number.h"
#include "core/util/printable.h"
#include "lab/experiment/hash.h"
#include "lab/experiment/joints.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

bool is_builtin(const Experiment& e) { return e.robot.model.starts_with("builtin:"); }

bool is_file(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

void build_builtin(const Experiment& e, Robot& robot) {
  const std::string name = e.robot.model.substr(8);
  if (name == "manipulator") {
    rbd::buildModels::manipulator(robot.model);
    robot.geometry = rbd::buildModels::manipulatorGeometries(robot.model);
  } else if (name == "humanoid") {
    rbd::buildModels::humanoid(robot.model);
    robot.geometry = rbd::buildModels::humanoidGeometries(robot.model);
  } else {
    const std::vector<std::string> known{"builtin:manipulator", "builtin:humanoid"};
    fail(e, "robot.model", "'" + e.robot.model + "' is not known; builtin are " + list_of(known));
  }
  if (e.robot.floating_base)
    fail(e, "robot.floating_base", "is for URDF robots; builtin:humanoid floats anyway");
}

void build_urdf(const Experiment& e, const std::string& text, const std::string& file, Robot& robot) {
  rbd::urdf::Options options;
  options.floating_base = e.robot.floating_base;
  options.mimic = e.robot.mimic;
  rbd::urdf::Loaded loaded = rbd::urdf::loadXML(text, options, file);
  std::string errors;
  for (const rbd::urdf::Diagnostic& d : loaded.diagnostics) {
    if (d.severity == rbd::urdf::Severity::Error)
      errors += (errors.empty() ? "" : "\n") + printable(d.text());
    if (d.severity == rbd::urdf::Severity::Warning) robot.warnings.push_back(d.text());
  }
  if (!errors.empty()) throw ExperimentError(errors);
  robot.model = std::move(loaded.model);
  robot.geometry = std::move(loaded.geometry);
  robot.urdf = text;
  robot.file = file;
}

/// What two processes must agree on before they work with the same vectors.
int64_t model_hash(const Experiment& e, const Robot& robot) {
  std::string text = robot.urdf.empty() ? e.robot.model : robot.urdf;
  text += '\0';
  text += std::string("mimic ") + (e.robot.mimic ? "1" : "0") + " floating " +
          (e.robot.floating_base ? "1" : "0");
  for (const auto& [joint, q] : e.robot.lock) text += " lock " + joint + " " + number(q);
  for (Eigen::Index i = 0; i < robot.model.nv; ++i) text += " " + number(robot.model.armature[i]);
  for (double g : e.simulator.gravity) text += " " + number(g);
  const int64_t hash = hash_of(text);
  return hash ? hash : 1;
}

void apply_options(const Experiment& e, Robot& robot) {
  rbd::Model& model = robot.model;
  for (const auto& [joint, q] : e.robot.lock) {
    const std::string key = "robot.lock." + joint;
    if (const std::string fault = joint_fault(model, joint); !fault.empty()) fail(e, key, fault);
    const int at = model.joints[model.getJointId(joint)].idx_q();
    if (q < model.lowerPositionLimit[at] || q > model.upperPositionLimit[at])
      fail(e, key,
           number(q) + " is outside the joint's limits " + number(model.lowerPositionLimit[at]) + " .. " +
               number(model.upperPositionLimit[at]));
  }
  if (!e.robot.lock.empty()) lock_joints(model, robot.geometry, e.robot.lock);
  if (model.nv == 0) fail(e, "robot.model", "'" + model.name + "' has no joint that moves");
  if (e.robot.armature.given())
    model.armature = joint_vector(e, "robot.armature", e.robot.armature, model, model.armature);
  model.gravity.linear() =
      Eigen::Vector3d(e.simulator.gravity[0], e.simulator.gravity[1], e.simulator.gravity[2]);
}

/// `name` with its last part as a file near it is called, in the first of the folders that exists; empty if there is none.
std::string near_file(const std::string& name, const std::vector<std::string>& tried) {
  for (const std::string& file : tried) {
    std::error_code none;
    std::vector<std::string> there;
    for (const auto& entry : fs::directory_iterator(fs::path(file).parent_path(), none))
      if (entry.path().extension() == ".urdf") there.push_back(entry.path().stem());
    std::sort(there.begin(), there.end());
    const auto near = rbd::nearNames(fs::path(file).stem(), there, 1);
    if (!near.empty()) return name.substr(0, name.rfind('/') + 1) + near[0] + ".urdf";
  }
  return "";
}

}  // namespace

std::string find_model(const Experiment& e) {
  const std::string& name = e.robot.model;
  if (is_builtin(e)) return "";
  if (name == "urdf")
    fail(e, "robot.model", "'urdf' stands for a text that comes apart, as in a log; name a file");
  std::vector<std::string> tried;
  if (name.find("://") != std::string::npos) {
    tried = rbd::urdf::mesh_candidates(name, e.file, {});
    if (tried.empty())
      fail(e, "robot.model", "'" + name + "' is not known; give builtin:NAME, package://.. or a file");
  } else if (fs::path(name).is_absolute()) {
    tried = {name};
  } else {
    fs::path folder = fs::absolute(e.file).lexically_normal().parent_path();
    for (;; folder = folder.parent_path()) {
      tried.push_back(folder / name);
      if (folder == folder.parent_path()) break;
    }
  }
  for (const std::string& file : tried)
    if (is_file(file)) return fs::absolute(file).lexically_normal();
  std::string hint = near_file(name, tried);
  if (!hint.empty())
    hint = "; did you mean '" + hint + "'?";
  else if (name.starts_with("package://example-robot-data/"))
    hint = "; get it with scripts/lab robots";
  else if (name.starts_with("package://"))
    hint = "; add the folder that holds the package to LAB_PACKAGE_PATH";
  fail(e, "robot.model", "'" + name + "' cannot be found" + hint + " (tried " + list_of(tried) + ")");
}

Robot load_robot(const Experiment& e) {
  const std::string file = find_model(e);
  if (file.empty()) return load_robot(e, "");
  std::ifstream in(file, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  if (!in.good() && !in.eof()) fail(e, "robot.model", "'" + file + "' cannot be read");
  return load_robot(e, text, file);
}

Robot load_robot(const Experiment& e, const std::string& urdf, const std::string& file) {
  Robot robot;
  if (is_builtin(e))
    build_builtin(e, robot);
  else
    build_urdf(e, urdf, file, robot);
  apply_options(e, robot);
  robot.hash = model_hash(e, robot);
  return robot;
}

}  // namespace lab
