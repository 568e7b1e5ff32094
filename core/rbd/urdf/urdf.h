// URDF in, Model out: with every check, and a message with file, line and element for whatever is wrong.
//
//   rbd::Model model;
//   rbd::urdf::buildModel("models/simple_3dof_arm.urdf", model);
//
// What comes out: moving joints depth first, siblings in alphabetical order of their names. Fixed joints are
// welded: the link's inertia goes to the moving joint above it (or to the universe, joint 0), and a frame
// remains. Frames: one BODY frame a link, and one JOINT or FIXED_JOINT frame a joint, both with the joint's
// pose. Read: link, inertial, joint (fixed, revolute, continuous, prismatic, planar, floating), limit,
// dynamics, mimic, visual, collision, material. Anything else is left out and named in the diagnostics.
//
// Errors: a file that cannot be used is refused (urdf::Error, whose text has one line per error) and nothing
// is returned or changed. Nothing is ever printed. Nothing that would compute to NaN is accepted. Source of
// the format: wiki.ros.org/urdf/XML.
#pragma once

#include <string>
#include <vector>

#include "rbd/model/geometry.h"
#include "rbd/model/model.h"
#include "rbd/urdf/diagnostic.h"

namespace rbd::urdf {

struct Options {
  bool floating_base = false;  // a free-flyer joint named "root_joint" above the root link
  bool mimic = true;           // true: a joint with <mimic> follows its leader; false: it is a free joint
  bool strict = false;         // true: warnings refuse a file, as errors do
  bool meshes = true;          // false: mesh files are not looked for, no warnings about them
  std::vector<std::string>
      package_dirs;  // where package://P/.. is looked for first (folders that hold P, or P)
};

// Everything at once, as values: `model` and `geometry` are empty unless ok().
struct Loaded {
  Model model;
  GeometryModel geometry;
  std::vector<Diagnostic> diagnostics;  // errors, warnings and notes by line

  bool ok() const;
};

Loaded load(const std::string& file, const Options& options = {});

// `name` stands for the file in messages; a path there lets relative and package:// meshes be found from it.
Loaded loadXML(const std::string& text, const Options& options = {}, const std::string& name = "<urdf>");

// The short forms: throw urdf::Error, or set `model` and return the warnings and notes (meshes are not looked
// for).
std::vector<Diagnostic> buildModel(const std::string& file, Model& model, const Options& options = {});
std::vector<Diagnostic> buildModelFromXML(const std::string& text, Model& model, const Options& options = {});

// With a joint above the root link, as in buildModel(file, JointModelFreeFlyer(), model).
std::vector<Diagnostic> buildModel(const std::string& file, const JointModelFreeFlyer& root, Model& model);
std::vector<Diagnostic> buildModelFromXML(const std::string& text, const JointModelFreeFlyer& root,
                                          Model& model);

// With the shapes. Mesh files that are not found leave `mesh` empty and a warning that lists where we looked.
std::vector<Diagnostic> buildModelsFromUrdf(const std::string& file,
                                            const std::vector<std::string>& package_dirs, Model& model,
                                            GeometryModel& geometry, Options options = {});

}  // namespace rbd::urdf
