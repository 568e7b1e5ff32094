// Mesh files through assimp.
#include "render/mesh/mesh_file.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>

#include "render/mesh/node_graph.h"
#include "render/mesh/texture.h"

namespace lab::render {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxBytes = 1ull << 30;
constexpr uint64_t kMaxTrianglesInFile = 20'000'000;

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

// Tells the cache which files a mesh was made from.
class Recorder : public Assimp::DefaultIOSystem {
 public:
  explicit Recorder(std::set<std::string>& asked) : asked_(asked) {}
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    asked_.insert(file);
    return DefaultIOSystem::Open(file, mode);
  }

 private:
  std::set<std::string>& asked_;
};

class Reader {
 public:
  Reader(const std::string& path, const std::string& kind)
      : path_(path), folder_(fs::path(path).parent_path()), stl_(kind == ".stl"), collada_(kind == ".dae") {}

  MeshFile read() {
    Assimp::Importer importer;
    importer.SetIOHandler(new Recorder(asked_));  // the importer deletes it
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    scene_ = importer.ReadFile(path_, aiProcess_Triangulate);
    if (!scene_ || !scene_->mRootNode) throw std::runtime_error(importer.GetErrorString());
    for (unsigned i = 0; i < scene_->mNumMaterials; ++i)
      soup_.looks.push_back(look_of(*scene_->mMaterials[i]));
    walk(*scene_->mRootNode, aiMatrix4x4());
    if (stl_) soup_.normals.clear();  // those are of the faces
    asked_.erase(path_);
    warn_of_materials();
    return {make_mesh(soup_), warnings_, {asked_.begin(), asked_.end()}};
  }

 private:
  Surface look_of(const aiMaterial& material) {
    Surface look;
    aiString name;
    aiColor4D diffuse;
    if (stl_ || material.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) != aiReturn_SUCCESS) return look;
    if (material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS &&
        !std::strcmp(name.C_Str(), AI_DEFAULT_MATERIAL_NAME))
      return look;  // assimp's stand-in where the file names no material
    const Eigen::Vector3f rgb(diffuse.r, diffuse.g, diffuse.b);
    if (!rgb.allFinite()) return look;
    // Exporters disagree on the sense of Collada's transparency; nobody draws a robot that cannot be seen at
    // all.
    float alpha = 1;
    if (material.Get(AI_MATKEY_OPACITY, alpha) != aiReturn_SUCCESS || !(alpha > 0.01f && alpha < 1))
      alpha = 1;
    look.rgba << rgb.cwiseMax(0.f).cwiseMin(1.f), alpha;
    look.coloured = true;
    // Only glTF's roughness means the same everywhere; exponents of shininess are mostly exporters' noise.
    float roughness;
    if (material.Get(AI_MATKEY_ROUGHNESS_FACTOR, roughness) == aiReturn_SUCCESS && roughness >= 0 &&
        roughness <= 1)
      look.roughness = roughness;
    look.texture = texture_of(material);
    // In Collada a texture stands in place of the colour; assimp then makes one up.
    if (look.texture && collada_) look.rgba.head<3>().setOnes();
    return look;
  }

  std::shared_ptr<const Texture> texture_of(const aiMaterial& material) {
    aiString name;
    if (material.GetTexture(aiTextureType_BASE_COLOR, 0, &name) != aiReturn_SUCCESS &&
        material.GetTexture(aiTextureType_DIFFUSE, 0, &name) != aiReturn_SUCCESS)
      return nullptr;
    const auto [known, fresh] = textures_.emplace(name.C_Str(), nullptr);
    if (!fresh) return known->second;
    try {
      const aiTexture* inside = scene_->GetEmbeddedTexture(name.C_Str());
      known->second = inside ? embedded(*inside) : beside(name.C_Str());
    } catch (const std::exception& e) {
      warnings_.push_back(path_ + ": texture '" + name.C_Str() + "': " + e.what() + "; drawn without it");
    }
    return known->second;
  }

  static std::shared_ptr<const Texture> embedded(const aiTexture& texture) {
    if (texture.mHeight == 0)
      return decode_texture(std::string(reinterpret_cast<const char*>(texture.pcData), texture.mWidth));
    auto out = std::make_shared<Texture>();
    out->width = static_cast<int>(texture.mWidth);
    out->height = static_cast<int>(texture.mHeight);
    for (size_t i = 0; i < size_t{texture.mWidth} * texture.mHeight; ++i) {
      const aiTexel& t = texture.pcData[i];
      out->rgba.insert(out->rgba.end(), {t.r, t.g, t.b, t.a});
    }
    return out;
  }

  // The path in the file, relative to the mesh; then, since exporters write paths of their own machine, a file
  // of that name beside the mesh or in ../materials/textures (Gazebo's models).
  std::shared_ptr<const Texture> beside(std::string name) {
    if (name.compare(0, 7, "file://") == 0) name.erase(0, 7);
    std::replace(name.begin(), name.end(), '\\', '/');
    for (size_t at; (at = name.find("%20")) != name.npos;) name.replace(at, 3, " ");
    const fs::path bare = fs::path(name).filename();
    std::vector<std::string> tried;
    for (const fs::path& place :
         {folder_ / name, folder_ / bare, folder_ / ".." / "materials" / "textures" / bare}) {
      const std::string candidate = place.lexically_normal().string();
      if (std::find(tried.begin(), tried.end(), candidate) != tried.end()) continue;
      tried.push_back(candidate);
      asked_.insert(candidate);
      std::string bytes;
      if (read_bytes(candidate, bytes)) return decode_texture(bytes);
    }
    std::string places;
    for (const std::string& t : tried) places += (places.empty() ? "tried " : ", ") + t;
    throw std::runtime_error("not found (" + places + ")");
  }

  // assimp only logs an OBJ's missing material file, after a guess of its own.
  void warn_of_materials() {
    std::string tried;
    for (const std::string& file : asked_) {
      if (fs::path(file).extension() != ".mtl") continue;
      if (fs::exists(file)) return;
      tried += (tried.empty() ? "" : ", ") + file;
    }
    if (!tried.empty())
      warnings_.push_back(path_ + ": no material file (tried " + tried + "); its colours are lost");
  }

  void append(const aiMesh& mesh, const aiMatrix4x4& pose) {
    const uint32_t base = static_cast<uint32_t>(soup_.positions.size());
    aiMatrix3x3 turn(pose);
    turn.Inverse().Transpose();
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D p = pose * mesh.mVertices[i],
                       n = mesh.HasNormals() ? turn * mesh.mNormals[i] : aiVector3D();
      const aiVector3D uv = mesh.HasTextureCoords(0) ? mesh.mTextureCoords[0][i] : aiVector3D();
      soup_.positions.emplace_back(p.x, p.y, p.z);
      soup_.normals.emplace_back(n.x, n.y, n.z);
      soup_.uvs.emplace_back(std::isfinite(uv.x) ? uv.x : 0.f, std::isfinite(uv.y) ? uv.y : 0.f);
    }
    const bool mirrored = pose.Determinant() < 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      const unsigned* i = face.mIndices;
      soup_.indices.insert(soup_.indices.end(),
                           {base + i[0], base + i[mirrored ? 2 : 1], base + i[mirrored ? 1 : 2]});
      soup_.triangle_look.push_back(mesh.mMaterialIndex);
    }
    if (soup_.triangle_look.size() > kMaxTrianglesInFile)
      throw std::runtime_error("more than " + std::to_string(kMaxTrianglesInFile) +
                               " triangles: too many to draw");
  }

  void walk(const aiNode& node, const aiMatrix4x4& above) {
    const aiMatrix4x4 pose = above * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_->mMeshes[node.mMeshes[i]];
      if (mesh.mMaterialIndex >= scene_->mNumMaterials)
        throw std::runtime_error("a mesh names a missing material");
      append(mesh, pose);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) walk(*node.mChildren[i], pose);
  }

  const std::string path_;
  const fs::path folder_;
  const bool stl_, collada_;
  const aiScene* scene_ = nullptr;
  Soup soup_;
  std::map<std::string, std::shared_ptr<const Texture>> textures_;
  std::vector<std::string> warnings_;
  std::set<std::string> asked_;
};

// The format of a file by its first bytes, whatever its name; "" if unknown.
std::string kind_by_contents(const std::string& path, uint64_t size) {
  std::ifstream file(path, std::ios::binary);
  char head[512] = {};
  file.read(head, sizeof head);
  const std::string_view text(head, static_cast<size_t>(file.gcount()));
  uint32_t count = 0;
  if (text.size() >= 84) std::memcpy(&count, head + 80, 4);
  if (size > 84 && 84 + 50ull * count == size) return "binary STL";
  if (text.find("<COLLADA") != text.npos) return "Collada";
  if (text.substr(0, 4) == "glTF") return "binary glTF";
  if (text.substr(0, 5) == "solid") return "ASCII STL";
  return "";
}

std::string in_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

MeshFile read_checked(const std::string& path) {
  std::error_code error;
  const uint64_t size = fs::file_size(path, error);
  if (error) throw std::runtime_error("cannot read mesh: " + error.message());
  if (size > kMaxBytes)
    throw std::runtime_error("mesh file of " + std::to_string(size) + " bytes is too large");
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  try {
    if (extension == ".stl") check_stl(path, size);
    if (std::string bytes;
        (extension == ".gltf" || extension == ".glb" || extension == ".dae") && read_bytes(path, bytes))
      (extension == ".dae" ? collada_nodes(bytes) : gltf_nodes(bytes)).check();
    return Reader(path, extension).read();
  } catch (const std::exception& e) {
    const std::string kind = kind_by_contents(path, size);
    const bool matches = kind.empty() || (kind.ends_with("STL") && extension == ".stl") ||
                         (kind == "Collada" && extension == ".dae") ||
                         (kind == "binary glTF" && extension == ".glb");
    throw std::runtime_error("cannot read mesh: " + std::string(e.what()) +
                             (matches ? "" : "; its contents look like " + kind + ", is the name right?"));
  }
}

}  // namespace

bool read_bytes(const std::string& path, std::string& bytes) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  const uint64_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (!file || error || size > kMaxBytes) return false;
  bytes.resize(size);
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  return static_cast<uint64_t>(file.gcount()) == size;
}

MeshFile read_mesh_file(const std::string& path) {
  try {
    return read_checked(path);
  } catch (const std::exception& e) {
    throw std::runtime_error(in_one_line(path + ": " + e.what()));
  }
}

MeshPtr load_mesh(const std::string& path) { return read_mesh_file(path).mesh; }

}  // namespace lab::render
