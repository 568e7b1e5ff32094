// The robot of an experiment: the same model in every process.
#pragma once
#include <rbd/model/geometry.h>
#include <rbd/model/model.h>

#include <cstdint>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"

namespace lab {

struct Robot {
  rbd::Model model;             ///< nominal: with armature, locked joints and gravity as the experiment says
  rbd::GeometryModel geometry;  ///< what it looks like
  std::string urdf;             ///< text of the URDF; empty for builtin models
  std::string file;             ///< where the text came from; empty for builtin models
  int64_t hash = 0;             ///< XXH3 of text (or builtin name) and of the options under `robot`; never 0
  std::vector<std::string> warnings;  ///< "FILE:LINE: warning: .."
};

/// From the file that robot.model names. Throws ExperimentError: file not found (and where it was looked
/// for), or one line per fault of the URDF.
Robot load_robot(const Experiment&);

/// From text, as RUN carries it; `file` only helps to find meshes. Same model and hash as from the file.
Robot load_robot(const Experiment&, const std::string& urdf, const std::string& file = "RUN");

/// Absolute path of the URDF; "" for builtin models. package:// looks into LAB_PACKAGE_PATH, ROS_PACKAGE_PATH
/// and AMENT_PREFIX_PATH; a relative path is looked for beside the experiment's file and in the folders above
/// it.
std::string find_model(const Experiment&);

/// Welds some joints at the positions in `where` (rad, m). All frames are kept; shapes stay on their bodies.
void lock_joints(rbd::Model&, rbd::GeometryModel&, const std::map<std::string, double>& where);

}  // namespace lab
