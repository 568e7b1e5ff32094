// What the renderer makes of a mesh before OpenGL sees it. In software every triangle costs, seen or not, so
// meshes are cut into clusters of triangles that lie together and face alike: a cluster that looks away from
// the eye as a whole is left out. Shadows make do with a coarse stand-in.
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

// Can any triangle of the cluster face the viewer? viewer: its place and 1, or the direction towards it and 0
// (far away); in the mesh's axes. Never wrongly false.
bool may_face(const Cluster& cluster, const Eigen::Vector4f& viewer);

struct Coarse {
  std::vector<Eigen::Vector3f> positions;
  std::vector<uint32_t> indices;
};

// All points of one cell of a grid become their mean; what is left of the triangles. No point moves by more
// than the diagonal of a cell, `cell` metres wide.
Coarse coarsen(const Mesh& mesh, float cell);

}  // namespace lab::render
