#include "render/mesh/clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace lab::render {
namespace {

using Eigen::Vector3f;

constexpr uint32_t kMaxTriangles = 96;  // of a cluster

// A triangle as a point: its position (in units of the mesh's size) and its normal.
using Place = std::array<float, 6>;

Vector3f face_normal(const Mesh& mesh, uint32_t triangle) {
  const uint32_t* i = &mesh.indices[3 * triangle];
  const Eigen::Vector3d a = mesh.positions[i[0]].cast<double>(), b = mesh.positions[i[1]].cast<double>(),
                        c = mesh.positions[i[2]].cast<double>();
  return (b - a).cross(c - a).normalized().cast<float>();
}

// Halves the range where it is widest until the pieces are small. Ties are broken by the triangle's number:
// the result does not depend on the library's sorting.
void split(uint32_t* begin, uint32_t* end, const std::vector<Place>& places, std::vector<uint32_t>& ends) {
  const size_t count = static_cast<size_t>(end - begin);
  if (count <= kMaxTriangles) return ends.push_back(static_cast<uint32_t>(count));
  Place low = places[*begin], high = low;
  for (const uint32_t* t = begin; t != end; ++t) {
    for (int k = 0; k < 6; ++k) {
      low[k] = std::min(low[k], places[*t][k]);
      high[k] = std::max(high[k], places[*t][k]);
    }
  }
  int widest = 0;
  for (int k = 1; k < 6; ++k)
    if (high[k] - low[k] > high[widest] - low[widest]) widest = k;
  uint32_t* middle = begin + count / 2;
  std::nth_element(begin, middle, end, [&](uint32_t a, uint32_t b) {
    const float pa = places[a][widest], pb = places[b][widest];
    return pa != pb ? pa < pb : a < b;
  });
  std::sort(begin, middle);  // nth_element leaves an order of its own inside the halves
  std::sort(middle, end);
  split(begin, middle, places, ends);
  split(middle, end, places, ends);
}

Cluster measure(const Mesh& mesh, const uint32_t* triangles, uint32_t count, bool two_sided) {
  Cluster c{};
  Eigen::AlignedBox3f box;
  Vector3f sum = Vector3f::Zero();
  for (uint32_t t = 0; t < count; ++t) {
    sum += face_normal(mesh, triangles[t]);
    for (int k = 0; k < 3; ++k) box.extend(mesh.positions[mesh.indices[3 * triangles[t] + k]]);
  }
  c.centre = box.center();
  float far = 0;
  for (uint32_t t = 0; t < count; ++t)
    for (int k = 0; k < 3; ++k)
      far = std::max(far, (mesh.positions[mesh.indices[3 * triangles[t] + k]] - c.centre).squaredNorm());
  c.radius = 1.0001f * std::sqrt(far);
  c.axis = sum.norm() > 0 ? Vector3f(sum.normalized()) : Vector3f::UnitZ();
  float cosine = two_sided ? -1.f : 1.f;
  for (uint32_t t = 0; t < count; ++t) cosine = std::min(cosine, c.axis.dot(face_normal(mesh, triangles[t])));
  c.cosine = cosine - 1e-3f;
  c.sine = std::sqrt(std::max(0.f, 1 - c.cosine * c.cosine));
  return c;
}

}  // namespace

Clusters cut_into_clusters(const Mesh& mesh) {
  const float size = std::max(1e-9f, static_cast<float>(mesh.bounds.diagonal().norm()));
  std::vector<Place> places(mesh.triangles());
  for (uint32_t t = 0; t < places.size(); ++t) {
    const uint32_t* i = &mesh.indices[3 * t];
    const Vector3f middle = (mesh.positions[i[0]] + mesh.positions[i[1]] + mesh.positions[i[2]]) / (3 * size);
    const Vector3f normal = face_normal(mesh, t);
    places[t] = {2 * middle.x(), 2 * middle.y(), 2 * middle.z(), normal.x(), normal.y(), normal.z()};
  }
  Clusters out;
  out.indices.reserve(mesh.indices.size());
  for (const Surface& surface : mesh.surfaces) {
    out.of_surface.push_back(static_cast<uint32_t>(out.all.size()));
    std::vector<uint32_t> order(surface.count / 3), sizes;
    std::iota(order.begin(), order.end(), surface.first / 3);
    if (!order.empty()) split(order.data(), order.data() + order.size(), places, sizes);
    const uint32_t* triangle = order.data();
    for (uint32_t count : sizes) {
      Cluster c = measure(mesh, triangle, count, surface.two_sided);
      c.first = static_cast<uint32_t>(out.indices.size());
      c.count = 3 * count;
      out.all.push_back(c);
      for (const uint32_t* end = triangle + count; triangle != end; ++triangle)
        out.indices.insert(out.indices.end(), &mesh.indices[3 * *triangle], &mesh.indices[3 * *triangle] + 3);
    }
  }
  out.of_surface.push_back(static_cast<uint32_t>(out.all.size()));
  return out;
}

bool may_face(const Cluster& c, const Eigen::Vector4f& viewer) {
  if (c.cosine <= 0) return true;
  // A triangle at p with normal n looks away if n . (p - eye) >= 0. Over the cone and the ball that is least
  // |d| cos(angle(axis, d) + half angle) - radius, with d from the eye to the centre.
  const bool near = viewer.w() != 0;
  const Vector3f d = near ? Vector3f(c.centre - viewer.head<3>()) : Vector3f(-viewer.head<3>());
  const float along = c.axis.dot(d), across = std::sqrt(std::max(0.f, d.squaredNorm() - along * along));
  return along * c.cosine - across * c.sine < (near ? c.radius : 0.f);
}

}  // namespace lab::render
