// Mesh files through assimp.
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "render/mesh.h"

namespace lab::render {
namespace {

constexpr uint64_t kMaxBytes = 1ull << 30;
constexpr uint64_t kMaxTriangles = 20'000'000;

// assimp reads a cut ASCII STL as if it were whole, and believes counts: look before it does.
void check_stl(const std::string& path, uint64_t size) {
  std::ifstream file(path, std::ios::binary);
  char head[84] = {};
  file.read(head, sizeof head);
  uint32_t count = 0;
  std::memcpy(&count, head + 80, 4);
  if (size >= 84 && 84 + 50ull * count == size) return;
  const std::string start(head, std::strlen(std::string(head, 80).c_str()));
  if (start.compare(
          start.find_first_not_of(" \t\r\n") == std::string::npos ? 0 : start.find_first_not_of(" \t\r\n"), 5,
          "solid") != 0) {
    if (size < 84)
      throw std::runtime_error("neither an ASCII nor a binary STL (" + std::to_string(size) + " bytes)");
    throw std::runtime_error("a binary STL of " + std::to_string(count) + " triangles takes " +
                             std::to_string(84 + 50ull * count) + " bytes, the file has " +
                             std::to_string(size));
  }
  char tail[513] = {};
  file.clear();
  file.seekg(size > 512 ? static_cast<std::streamoff>(size - 512) : 0);
  file.read(tail, 512);
  if (!std::strstr(tail, "endsolid"))
    throw std::runtime_error("an ASCII STL that does not end with 'endsolid': cut?");
}

Eigen::Vector4f colour_of(const aiMaterial& material, bool stl) {
  const Eigen::Vector4f none(-1, 0, 0, 0);
  aiString name;
  aiColor4D diffuse;
  if (stl || material.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) != aiReturn_SUCCESS) return none;
  if (material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS &&
      !std::strcmp(name.C_Str(), AI_DEFAULT_MATERIAL_NAME))
    return none;  // assimp's stand-in where the file names no material
  const Eigen::Vector3f rgb(diffuse.r, diffuse.g, diffuse.b);
  if (!rgb.allFinite()) return none;
  // Exporters disagree on the sense of Collada's transparency; nobody draws a robot that cannot be seen at
  // all.
  float alpha = 1;
  if (material.Get(AI_MATKEY_OPACITY, alpha) != aiReturn_SUCCESS || !(alpha > 0.01f && alpha < 1)) alpha = 1;
  Eigen::Vector4f rgba;
  rgba << rgb.cwiseMax(0.f).cwiseMin(1.f), alpha;
  return rgba;
}

void append(const aiMesh& mesh, const aiMatrix4x4& pose, const Eigen::Vector4f& colour, Soup& soup) {
  const uint32_t base = static_cast<uint32_t>(soup.positions.size());
  aiMatrix3x3 turn(pose);
  turn.Inverse().Transpose();
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D p = pose * mesh.mVertices[i],
                     n = mesh.HasNormals() ? turn * mesh.mNormals[i] : aiVector3D();
    soup.positions.emplace_back(p.x, p.y, p.z);
    soup.normals.emplace_back(n.x, n.y, n.z);
  }
  const bool mirrored = pose.Determinant() < 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines
    const unsigned* i = face.mIndices;
    soup.indices.insert(soup.indices.end(),
                        {base + i[0], base + i[mirrored ? 2 : 1], base + i[mirrored ? 1 : 2]});
    soup.triangle_rgba.push_back(colour);
  }
  if (soup.triangle_rgba.size() > kMaxTriangles)
    throw std::runtime_error("more than " + std::to_string(kMaxTriangles) + " triangles: too many to draw");
}

void walk(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, bool stl, Soup& soup) {
  const aiMatrix4x4 pose = above * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    if (mesh.mMaterialIndex >= scene.mNumMaterials)
      throw std::runtime_error("a mesh names a missing material");
    append(mesh, pose, colour_of(*scene.mMaterials[mesh.mMaterialIndex], stl), soup);
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) walk(scene, *node.mChildren[i], pose, stl, soup);
}

MeshPtr load(const std::string& path) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  if (error) throw std::runtime_error("cannot read mesh: " + error.message());
  if (size > kMaxBytes)
    throw std::runtime_error("mesh file of " + std::to_string(size) + " bytes is too large");
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const bool stl = extension == ".stl";
  if (stl) check_stl(path, size);

  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode)
    throw std::runtime_error(std::string("cannot read mesh: ") + importer.GetErrorString());
  Soup soup;
  walk(*scene, *scene->mRootNode, aiMatrix4x4(), stl, soup);
  if (stl) soup.normals.clear();  // those are of the faces
  return make_mesh(soup);
}

}  // namespace

MeshPtr load_mesh(const std::string& path) {
  try {
    return load(path);
  } catch (const std::exception& e) {
    throw std::runtime_error(path + ": " + e.what());
  }
}

}  // namespace lab::render
