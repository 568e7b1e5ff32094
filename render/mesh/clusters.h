// Cuts a mesh into clusters of nearby triangles that face the same way. In software rendering every triangle costs
// time, visible or not: a cluster that faces away from the eye as a whole is not drawn.
#pragma once

#include <vector>

#include "render/mesh/mesh.h"

namespace lab::render {

struct Cluster {
  uint32_t first, count;   // in Clusters::indices
  Eigen::Vector3f centre;  // of a ball around its corners
  float radius;
  Eigen::Vector3f axis;  // of a cone around its triangles' normals
  float cosine, sine;    // of the cone's half angle; cosine 0 or less: it may be seen from anywhere
};

struct Clusters {
  std::vector<uint32_t> indices;     // the mesh's, in another order; surface by surface as before
  std::vector<Cluster> all;          // cover all indices, in order
  std::vector<uint32_t> of_surface;  // surface s has clusters of_surface[s] .. of_surface[s + 1]
};

Clusters cut_into_clusters(const Mesh& mesh);

// Can any triangle of the cluster face the viewer? viewer: its position and 1, or the direction towards it and 0
// (far away); in the mesh's axes. May be true in doubt, never wrongly false.
bool may_face(const Cluster& cluster, const Eigen::Vector4f& viewer);

}  // namespace lab::render
