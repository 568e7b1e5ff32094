// Reads mesh files (STL, Collada, OBJ, glTF) through assimp, without a cache (mesh_cache.h).
#pragma once

#include <string>
#include <vector>

#include "render/mesh/mesh.h"

namespace lab::render {

// Reads .stl, .dae, .obj, .gltf or .glb (any assimp can). Node transforms and the Collada unit are applied,
// up axes are NOT (Collada's up_axis, glTF's y up): robots are drawn in the file's own axes, as RViz does.
// STL has no colour of its own. Textures (PNG, JPEG) are looked for beside the mesh, or inside it; one that
// cannot be read is left out. Throws std::runtime_error "PATH: reason" for a missing, truncated, unknown, empty,
// non-finite or absurdly large file.
MeshPtr load_mesh(const std::string& path);

struct MeshFile {
  MeshPtr mesh;
  std::vector<std::string> warnings;  // "PATH: what was left out and why"
  std::vector<std::string> others;  // files beside it that were asked for, there or not: materials, textures
};

// What load_mesh(path) reads, with warnings and the names of the files beside it. Throws as load_mesh does.
MeshFile read_mesh_file(const std::string& path);

// The whole file; false if it cannot be read or is larger than any mesh (1 GB).
bool read_bytes(const std::string& path, std::string& bytes);

}  // namespace lab::render
