// A mesh file as it is on disk, before any cache.
#pragma once

#include <string>
#include <vector>

#include "render/mesh/mesh.h"

namespace lab::render {

struct MeshFile {
  MeshPtr mesh;
  std::vector<std::string> warnings;  // "PATH: what was left out and why"
  std::vector<std::string> others;  // files beside it that were asked for, there or not: materials, textures
};

// What load_mesh(path) reads, and what else there is to say about it. Throws as load_mesh does.
MeshFile read_mesh_file(const std::string& path);

// The whole file; false if it cannot be read or is larger than any mesh (1 GB).
bool read_bytes(const std::string& path, std::string& bytes);

}  // namespace lab::render
