#include "render/mesh/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "render/mesh/primitives.h"
#include "render/mesh/stand_in.h"

namespace lab::render {
namespace {

using Eigen::Vector3f;
using Eigen::Vector4f;

using Triangle = std::array<uint32_t, 3>;

std::vector<Triangle> sorted_triangles(const std::vector<uint32_t>& indices) {
  std::vector<Triangle> all;
  for (size_t i = 0; i < indices.size(); i += 3) all.push_back({indices[i], indices[i + 1], indices[i + 2]});
  std::sort(all.begin(), all.end());
  return all;
}

// Does the viewer see the front of this triangle? By the sign of a volume.
bool faces(const Mesh& mesh, const uint32_t* i, const Vector4f& viewer) {
  const Eigen::Vector3d a = mesh.positions[i[0]].cast<double>(), b = mesh.positions[i[1]].cast<double>(),
                        c = mesh.positions[i[2]].cast<double>(), eye = viewer.head<3>().cast<double>();
  return (b - a).cross(c - a).dot(viewer.w() != 0 ? Eigen::Vector3d(eye - a) : eye) > 0;
}

TEST(Clusters, HoldEveryTriangleOnce) {
  const MeshPtr mesh = make_capsule(.1, .4, 64);
  const Clusters c = cut_into_clusters(*mesh);
  EXPECT_EQ(sorted_triangles(c.indices), sorted_triangles(mesh->indices));
  uint32_t next = 0;
  for (const Cluster& each : c.all) {
    EXPECT_EQ(each.first, next);
    next += each.count;
  }
  EXPECT_EQ(next, mesh->indices.size());
  EXPECT_EQ(c.of_surface, (std::vector<uint32_t>{0, static_cast<uint32_t>(c.all.size())}));
}

TEST(Clusters, NoTriangleThatFacesTheViewerIsLeftOut) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (const MeshPtr& mesh : {make_capsule(.1, .4, 64), make_sphere(.3, 80), make_box({1, .2, .5}),
                              make_cylinder(.02, 1.5, 96), make_cone(.3, .2, 64)}) {
    const Clusters c = cut_into_clusters(*mesh);
    size_t left_out = 0, looks_away = 0, total = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const Vector3f at(uniform(random), uniform(random), uniform(random));
      Vector4f viewer;
      viewer << (trial % 3 == 0 ? 0.3f : 4.f) * at, trial % 2 ? 1.f : 0.f;  // near, far, infinitely far
      for (const Cluster& each : c.all) {
        const bool drawn = may_face(each, viewer);
        for (uint32_t i = each.first; i < each.first + each.count; i += 3) {
          const bool seen = faces(*mesh, &c.indices[i], viewer);
          ASSERT_TRUE(drawn || !seen);
          left_out += !drawn;
          looks_away += !seen;
          ++total;
        }
      }
    }
    if (mesh->triangles() > 3000) {
      EXPECT_GT(left_out, looks_away / 2) << mesh->triangles() << " of " << total;
    }
  }
}

TEST(Clusters, OpenSurfacesAreSeenFromBothSides) {
  Soup soup;  // a square
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  soup.indices = {0, 1, 2, 0, 2, 3};
  const MeshPtr mesh = make_mesh(soup);
  ASSERT_TRUE(mesh->surfaces[0].two_sided);
  for (const Cluster& each : cut_into_clusters(*mesh).all)
    for (float z : {1.f, -1.f}) EXPECT_TRUE(may_face(each, Vector4f(.5f, .5f, z, 1)));
}

TEST(Clusters, CoarseMeshStaysWithinACell) {
  const MeshPtr ball = make_sphere(.5, 96);
  const float cell = .05f;
  const CoarseMesh coarse = coarsen(*ball, cell);
  EXPECT_LT(coarse.indices.size(), ball->indices.size() / 3);
  EXPECT_GT(coarse.indices.size(), 600u);
  for (const Vector3f& p : coarse.positions) EXPECT_NEAR(p.norm(), .5f, cell * std::sqrt(3.f));
  for (uint32_t i : coarse.indices) ASSERT_LT(i, coarse.positions.size());
  double volume = 0;
  for (size_t i = 0; i < coarse.indices.size(); i += 3) {
    const auto p = [&](size_t k) { return coarse.positions[coarse.indices[i + k]]; };
    volume += p(0).dot(p(1).cross(p(2))) / 6;
  }
  EXPECT_NEAR(volume, 4. / 3 * M_PI * .125, .03) << "closed and right side out";
}

}  // namespace
}  // namespace lab::render
