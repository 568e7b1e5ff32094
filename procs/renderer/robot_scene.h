// A robot's shapes as bodies to draw, and their poses.
#pragma once
#include <rbd/algorithm/data.h>

#include <string>
#include <vector>

#include "lab/experiment/robot.h"
#include "render/scene.h"

namespace lab::renderer {

/// The robot's shapes: one body for each joint. A shape's id is the index of its link in `links`; links that it lacks
/// are added. A mesh that cannot be read becomes a magenta box and a warning. In quality fine, meshes are as in their
/// files, otherwise decimated (parts.h).
std::vector<render::Body> make_bodies(const Robot&, const std::string& quality,
                                      std::vector<std::string>& links, std::vector<std::string>& warnings);

/// Moves them to where the joints are in `data`.
void place_bodies(const rbd::Data& data, std::vector<render::Body>& bodies);

/// The same for a configuration; `data` then has its joints and frames.
void pose_bodies(const rbd::Model&, rbd::Data& data, const Eigen::VectorXd& q,
                 std::vector<render::Body>& bodies);

}  // namespace lab::renderer
