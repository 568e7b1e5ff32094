#include "render/mesh/stand_in.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace lab::render {
namespace {

using Eigen::Vector3f;

constexpr size_t kFineEnough = 1500;  // triangles below which a stand-in saves nothing

struct Cell {
  int x, y, z;
  bool operator==(const Cell&) const = default;
};

struct Hash {
  size_t operator()(const std::array<uint32_t, 3>& a) const {
    uint64_t h = 0x9e3779b97f4a7c15ull;
    for (uint32_t v : a) {
      h = (h ^ v) * 0xff51afd7ed558ccdull;
      h ^= h >> 32;
    }
    return h;
  }
  size_t operator()(const Cell& c) const {
    return (*this)(std::array<uint32_t, 3>{static_cast<uint32_t>(c.x), static_cast<uint32_t>(c.y),
                                           static_cast<uint32_t>(c.z)});
  }
};

}  // namespace

CoarseMesh coarsen(const Mesh& mesh, float cell) {
  CoarseMesh out;
  std::unordered_map<Cell, uint32_t, Hash> seen;
  std::vector<uint32_t> point_of(mesh.positions.size()), count;
  const Vector3f origin = mesh.bounds.min().cast<float>();
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vector3f p = (mesh.positions[i] - origin) / cell;
    const Cell key{static_cast<int>(p.x()), static_cast<int>(p.y()), static_cast<int>(p.z())};
    const auto [it, fresh] = seen.try_emplace(key, static_cast<uint32_t>(out.positions.size()));
    if (fresh) {
      out.positions.emplace_back(Vector3f::Zero());
      count.push_back(0);
    }
    point_of[i] = it->second;
    out.positions[it->second] += mesh.positions[i];
    ++count[it->second];
  }
  for (size_t i = 0; i < count.size(); ++i) out.positions[i] /= static_cast<float>(count[i]);
  std::unordered_set<std::array<uint32_t, 3>, Hash> kept;
  for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    std::array<uint32_t, 3> p{point_of[mesh.indices[t]], point_of[mesh.indices[t + 1]],
                              point_of[mesh.indices[t + 2]]};
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    std::array<uint32_t, 3> key = p;
    std::sort(key.begin(), key.end());
    if (kept.insert(key).second) out.indices.insert(out.indices.end(), p.begin(), p.end());
  }
  return out;
}

CoarseMesh shadow_stand_in(const Mesh& mesh) {
  if (mesh.triangles() <= kFineEnough) return {mesh.positions, mesh.indices};
  double area = 0;
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Eigen::Vector3f& a = mesh.positions[mesh.indices[i]];
    area +=
        (mesh.positions[mesh.indices[i + 1]] - a).cross(mesh.positions[mesh.indices[i + 2]] - a).norm() / 2;
  }
  const double triangle = std::sqrt(area / static_cast<double>(mesh.triangles()));
  const double cell = std::min(4 * triangle, mesh.bounds.diagonal().norm() / 20);
  return coarsen(mesh, static_cast<float>(cell));
}

}  // namespace lab::render
