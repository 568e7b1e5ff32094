// Meshes as they are drawn, kept on disk: reading, welding, making normals and decimating a robot's files
// takes seconds, reading the result takes milliseconds.
#pragma once

#include <string>
#include <vector>

#include "render/mesh/mesh.h"

namespace lab::render {

// Where meshes are kept: $LAB_MESH_CACHE ("off": nowhere), else $XDG_CACHE_HOME/lcmlab/meshes, else
// ~/.cache/lcmlab/meshes; "" = nowhere.
std::string mesh_cache_folder();

struct MeshOptions {
  // A mesh of more triangles than this is decimated, by at most `error` (in the file's units); if that leaves
  // four times as many, once more, by twice as much. 0: left as it is.
  size_t triangles = 0;
  double error = 0;
  std::string cache = mesh_cache_folder();
};

// As load_mesh(path), decimated as asked, from the cache if it has an entry for this content: an entry's name is a
// hash of the file's bytes, the options and the code that made it; files beside it (materials, textures) are
// checked by hashes of their own. A corrupt or unknown entry is ignored and made again; a folder that cannot
// be written to is no error. Entries unused for longest are removed once all together are above 1 GB. What
// was left out of the mesh is added to `warnings`.
MeshPtr load_mesh(const std::string& path, const MeshOptions& options,
                  std::vector<std::string>* warnings = nullptr);

}  // namespace lab::render
