#include "render/mesh_store.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "render/gl.h"
#include "render/mesh/stand_in.h"

namespace lab::render {
namespace {

void fill(unsigned kind, unsigned& id, const void* data, size_t bytes) {
  glGenBuffers(1, &id);
  glBindBuffer(kind, id);
  glBufferData(kind, static_cast<GLsizeiptr>(bytes), data, GL_STATIC_DRAW);
}

void attribute(unsigned place, int size, size_t stride, size_t offset) {
  glEnableVertexAttribArray(place);
  glVertexAttribPointer(place, size, GL_FLOAT, GL_FALSE, static_cast<int>(stride * sizeof(float)),
                        reinterpret_cast<void*>(offset * sizeof(float)));
}

Buffers upload(const MeshPtr& mesh) {
  const size_t n = mesh->positions.size();
  const auto fits = [&](size_t size) { return size == 0 || size == n; };
  if (mesh->normals.size() != n || !fits(mesh->uvs.size()) || !fits(mesh->colours.size()))
    throw std::invalid_argument(
        "renderer: a mesh has positions, normals, uvs or colours of different numbers");
  Buffers b;
  b.alive = mesh;
  b.has_uvs = !mesh->uvs.empty();
  b.has_colours = !mesh->colours.empty();
  b.clusters = cut_into_clusters(*mesh);
  std::vector<float> data, extra;
  data.reserve(n * 6);
  for (size_t i = 0; i < n; ++i) {
    data.insert(data.end(), mesh->positions[i].data(), mesh->positions[i].data() + 3);
    data.insert(data.end(), mesh->normals[i].data(), mesh->normals[i].data() + 3);
    if (b.has_uvs) extra.insert(extra.end(), {mesh->uvs[i].x(), 1 - mesh->uvs[i].y()});  // GL: row 0 is v = 0
    if (!b.has_colours) continue;
    const Eigen::Vector4f& c = mesh->colours[i];
    extra.insert(extra.end(), {c[0] * c[0], c[1] * c[1], c[2] * c[2], c[3]});
  }
  glGenVertexArrays(1, &b.array);
  glBindVertexArray(b.array);
  fill(GL_ARRAY_BUFFER, b.vertices, data.data(), data.size() * sizeof(float));
  attribute(0, 3, 6, 0);
  attribute(1, 3, 6, 3);
  if (!extra.empty()) {
    fill(GL_ARRAY_BUFFER, b.extra, extra.data(), extra.size() * sizeof(float));
    const size_t stride = extra.size() / n;
    if (b.has_uvs) attribute(2, 2, stride, 0);
    if (b.has_colours) attribute(3, 4, stride, b.has_uvs ? 2 : 0);
  }
  fill(GL_ELEMENT_ARRAY_BUFFER, b.indices, b.clusters.indices.data(),
       b.clusters.indices.size() * sizeof(uint32_t));
  b.clusters.indices = {};

  const CoarseMesh coarse = shadow_stand_in(*mesh);
  b.coarse_count = static_cast<int>(coarse.indices.size());
  glGenVertexArrays(1, &b.coarse_array);
  glBindVertexArray(b.coarse_array);
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  fill(GL_ARRAY_BUFFER, b.coarse_vertices, coarse.positions.data(),
       coarse.positions.size() * 3 * sizeof(float));
  attribute(0, 3, 3, 0);
  fill(GL_ELEMENT_ARRAY_BUFFER, b.coarse_indices, coarse.indices.data(),
       coarse.indices.size() * sizeof(uint32_t));
  check_gl("upload of a mesh");
  return b;
}

unsigned upload(const Texture& texture) {
  if (texture.width < 1 || texture.height < 1 || texture.width > 16384 || texture.height > 16384 ||
      texture.rgba.size() != static_cast<size_t>(texture.width) * texture.height * 4)
    throw std::invalid_argument("renderer: a texture of " + std::to_string(texture.width) + " x " +
                                std::to_string(texture.height) + " with " +
                                std::to_string(texture.rgba.size()) + " bytes cannot be used");
  unsigned id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, texture.width, texture.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               texture.rgba.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  check_gl("upload of a texture");
  return id;
}

}  // namespace

const Buffers& MeshStore::get(const MeshPtr& mesh) {
  const auto it = meshes_.find(mesh.get());
  if (it != meshes_.end()) return it->second;
  return meshes_.emplace(mesh.get(), upload(mesh)).first->second;
}

unsigned MeshStore::get(const std::shared_ptr<const Texture>& texture) {
  const auto it = textures_.find(texture.get());
  if (it != textures_.end()) return it->second.id;
  return textures_.emplace(texture.get(), Uploaded{texture, upload(*texture)}).first->second.id;
}

void MeshStore::forget_dead() {
  for (auto it = meshes_.begin(); it != meshes_.end();) {
    const Buffers& b = it->second;
    if (!b.alive.expired()) {
      ++it;
      continue;
    }
    const unsigned arrays[] = {b.array, b.coarse_array};
    const unsigned buffers[] = {b.vertices, b.extra, b.indices, b.coarse_vertices, b.coarse_indices};
    glDeleteVertexArrays(2, arrays);
    glDeleteBuffers(5, buffers);
    it = meshes_.erase(it);
  }
  std::erase_if(textures_, [](const auto& entry) {
    if (entry.second.alive.expired()) glDeleteTextures(1, &entry.second.id);
    return entry.second.alive.expired();
  });
}

size_t draw_surface(const Buffers& mesh, size_t surface, const Eigen::Vector4f& viewer) {
  static thread_local std::vector<int> counts;
  static thread_local std::vector<const void*> firsts;
  counts.clear();
  firsts.clear();
  uint32_t end = ~0u;  // of the last range: neighbours are drawn in one go
  for (uint32_t i = mesh.clusters.of_surface[surface]; i < mesh.clusters.of_surface[surface + 1]; ++i) {
    const Cluster& c = mesh.clusters.all[i];
    if (!may_face(c, viewer)) continue;
    if (c.first == end) {
      counts.back() += static_cast<int>(c.count);
    } else {
      counts.push_back(static_cast<int>(c.count));
      firsts.push_back(reinterpret_cast<const void*>(static_cast<uintptr_t>(c.first) * sizeof(uint32_t)));
    }
    end = c.first + c.count;
  }
  if (counts.empty()) return 0;
  glBindVertexArray(mesh.array);
  glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, firsts.data(),
                      static_cast<int>(counts.size()));
  return static_cast<size_t>(std::accumulate(counts.begin(), counts.end(), 0)) / 3;
}

size_t draw_coarse(const Buffers& mesh) {
  glBindVertexArray(mesh.coarse_array);
  glDrawElements(GL_TRIANGLES, mesh.coarse_count, GL_UNSIGNED_INT, nullptr);
  return static_cast<size_t>(mesh.coarse_count) / 3;
}

}  // namespace lab::render
