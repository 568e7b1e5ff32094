// Meshes and textures on the GL side: uploaded when first drawn, kept as long as the mesh itself is.
#pragma once

#include <unordered_map>

#include "render/mesh/clusters.h"

namespace lab::render {

// A mesh on the GL side. Vertex attributes: 0 position, 1 normal, 2 texture coordinate, 3 colour (linear).
struct Buffers {
  std::weak_ptr<const Mesh> alive;  // expired when the mesh is gone
  unsigned array = 0, vertices = 0, extra = 0, indices = 0;
  bool has_uvs = false, has_colours = false;
  Clusters clusters;  // without their indices: those are uploaded
  // The stand-in for shadows: positions only.
  unsigned coarse_array = 0, coarse_vertices = 0, coarse_indices = 0;
  int coarse_count = 0;
};

class MeshStore {
 public:
  const Buffers& get(const MeshPtr& mesh);
  unsigned get(const std::shared_ptr<const Texture>& texture);
  // A new mesh may get the address of a freed one: call this before get() in every frame.
  void forget_dead();

 private:
  struct Uploaded {
    std::weak_ptr<const Texture> alive;
    unsigned id;
  };
  std::unordered_map<const Mesh*, Buffers> meshes_;
  std::unordered_map<const Texture*, Uploaded> textures_;
};

// Draws those triangles of a surface that may face the viewer (in the mesh's axes, as may_face takes it); both
// return how many they drew.
size_t draw_surface(const Buffers& mesh, size_t surface, const Eigen::Vector4f& viewer);
size_t draw_coarse(const Buffers& mesh);

}  // namespace lab::render
