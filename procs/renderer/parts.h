// Shapes of a URDF as parts to draw: primitives and mesh files.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "lab/experiment/robot.h"
#include "render/mesh/mesh_cache.h"
#include "render/scene.h"

namespace lab::renderer {

Eigen::Isometry3d isometry(const rbd::SE3& pose);

/// Turns a robot's shapes into parts. Each mesh file is read once. A missing or broken one becomes a magenta box of 10 cm,
/// with one warning that names every place where it was looked for.
class PartMaker {
 public:
  /// Meshes of more than 500 triangles are decimated, by at most `error` metres; 0: none is decimated.
  PartMaker(const Robot& robot, double error, std::vector<std::string>& warnings)
      : robot_(robot), error_(error), warnings_(warnings) {}

  render::Part part(const rbd::GeometryObject& shape);

 private:
  render::MeshPtr mesh(const rbd::GeometryObject& shape);
  std::string why_missing(const std::string& uri) const;

  const Robot& robot_;
  const double error_;
  std::vector<std::string>& warnings_;
  std::map<std::pair<std::string, double>, render::MeshPtr>
      meshes_;  ///< by URI and largest scale; null: missing or broken
};

}  // namespace lab::renderer
