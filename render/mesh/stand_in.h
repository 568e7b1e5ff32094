// Coarse stand-ins for meshes that cast shadows: a shadow shows less detail than the mesh has.
#pragma once

#include "render/mesh/mesh.h"

namespace lab::render {

struct CoarseMesh {
  std::vector<Eigen::Vector3f> positions;
  std::vector<uint32_t> indices;
};

// All points of one cell of a grid become their mean; triangles that collapse or repeat are dropped. No point moves by
// more than the diagonal of a cell, `cell` metres wide.
CoarseMesh coarsen(const Mesh& mesh, float cell);

// What to draw into a shadow map: small meshes as they are; others coarsened with cells as wide as four triangles, but
// not so wide that they show at the edge of a shadow.
CoarseMesh shadow_stand_in(const Mesh& mesh);

}  // namespace lab::render
