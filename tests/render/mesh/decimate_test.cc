#include "render/mesh/decimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/mesh/mesh.h"
#include "render/mesh/primitives.h"

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

Vector3d point(const Mesh& m, size_t corner) { return m.positions[m.indices[corner]].cast<double>(); }

double volume(const Mesh& m) {
  double sum = 0;
  for (size_t i = 0; i < m.indices.size(); i += 3)
    sum += point(m, i).dot(point(m, i + 1).cross(point(m, i + 2))) / 6;
  return sum;
}

// Distance of a point from a triangle, by the nearest of face, sides and corners.
double distance(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d n = (b - a).cross(c - a).normalized();
  const Vector3d q = p - n.dot(p - a) * n;
  if (n.dot((b - a).cross(q - a)) >= 0 && n.dot((c - b).cross(q - b)) >= 0 &&
      n.dot((a - c).cross(q - c)) >= 0)
    return (p - q).norm();
  const auto to_side = [&](const Vector3d& s, const Vector3d& e) {
    const double t = std::clamp((p - s).dot(e - s) / (e - s).squaredNorm(), 0.0, 1.0);
    return (p - s - t * (e - s)).norm();
  };
  return std::min({to_side(a, b), to_side(b, c), to_side(c, a)});
}

// How far the farthest vertex of `from` is from the surface of `to`.
double deviation(const Mesh& from, const Mesh& to) {
  double worst = 0;
  for (const Vector3f& v : from.positions) {
    double nearest = HUGE_VAL;
    for (size_t i = 0; i < to.indices.size(); i += 3)
      nearest =
          std::min(nearest, distance(v.cast<double>(), point(to, i), point(to, i + 1), point(to, i + 2)));
    worst = std::max(worst, nearest);
  }
  return worst;
}

// A unit box whose faces are n x n squares of two triangles, welded and creased by make_mesh.
Soup fine_box(int n) {
  Soup soup;
  for (int axis = 0; axis < 3; ++axis)
    for (int side : {-1, 1})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            Vector3f p;
            p[axis] = 0.5f * static_cast<float>(side);
            p[(axis + 1) % 3] = static_cast<float>(i + di) / static_cast<float>(n) - 0.5f;
            p[(axis + 2) % 3] = static_cast<float>(j + dj) / static_cast<float>(n) - 0.5f;
            return p;
          };
          const uint32_t base = static_cast<uint32_t>(soup.positions.size());
          soup.positions.insert(soup.positions.end(),
                                {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)});
          if (side > 0)
            soup.indices.insert(soup.indices.end(), {base, base + 1, base + 2, base, base + 2, base + 3});
          if (side < 0)
            soup.indices.insert(soup.indices.end(), {base, base + 2, base + 1, base, base + 3, base + 2});
        }
  return soup;
}

TEST(Decimate, FlatPartsBecomeTwoTrianglesAFace) {
  const MeshPtr fine = make_mesh(fine_box(8));
  ASSERT_EQ(fine->triangles(), 768u);
  const MeshPtr m = decimate(*fine, 0, 1e-6);  // nothing but rounding is given away
  EXPECT_EQ(m->triangles(), 12u);
  EXPECT_EQ(m->positions.size(), 24u) << "each corner keeps its three normals";
  EXPECT_NEAR(volume(*m), 1, 1e-6);
  EXPECT_TRUE(m->bounds.isApprox(fine->bounds));
  for (size_t i = 0; i < m->indices.size(); ++i) {
    const size_t t = i / 3 * 3;
    const Vector3d face =
        (point(*m, t + 1) - point(*m, t)).cross(point(*m, t + 2) - point(*m, t)).normalized();
    EXPECT_NEAR(face.dot(m->normals[m->indices[i]].cast<double>()), 1, 1e-6);
  }
}

TEST(Decimate, NeverFartherThanTheError) {
  // The bound is on distances to planes; beside a blunt ridge (these bend by less than 45 degrees) the
  // surface itself is at most 1 / cos(22.5) farther away.
  for (const MeshPtr& fine : {make_sphere(1, 40), make_capsule(.3, 1, 32), make_cylinder(.4, 1, 40)})
    for (double error : {0.02, 0.04}) {
      const MeshPtr m = decimate(*fine, 0, error);
      EXPECT_LT(m->triangles(), fine->triangles() * 3 / 4) << error;
      EXPECT_LE(deviation(*fine, *m), error / std::cos(M_PI / 8)) << error;
      EXPECT_LT(std::abs(volume(*m) - volume(*fine)), 7 * error) << "surface of 4 pi or less times the error";
    }
  EXPECT_LT(decimate(*make_sphere(1, 96), 0, 0.03)->triangles(), 1800u) << "of 9000: it does save something";
}

TEST(Decimate, StopsAtTheBudgetAndIsDeterministic) {
  const MeshPtr fine = make_sphere(1, 96), a = decimate(*fine, 2000, 1), b = decimate(*fine, 2000, 1);
  EXPECT_LE(a->triangles(), 2000u);
  EXPECT_GE(a->triangles(), 1998u);
  EXPECT_EQ(a->indices, b->indices);
  EXPECT_EQ(a->positions, b->positions);
  for (size_t i = 0; i < a->positions.size(); ++i) {
    EXPECT_NEAR(a->positions[i].norm(), 1, 1e-6) << "every vertex is one of the sphere's";
    EXPECT_LT((a->normals[i] - a->positions[i]).norm(), 0.16)
        << "2 sides of 0.08, each leaning by half of it, all on one hand";
  }
}

// A board with a bump of few triangles: whoever stands at its foot belongs to the board, which is wider.
TEST(Decimate, NormalsGoByArea) {
  Soup soup;
  soup.positions = {{-1, -1, 0},    {1, -1, 0},    {1, 1, 0},      {-1, 1, 0},  {-.1f, -.1f, 0},
                    {.1f, -.1f, 0}, {.1f, .1f, 0}, {-.1f, .1f, 0}, {0, 0, .05f}};
  for (uint32_t k = 0; k < 4; ++k) {
    const uint32_t next = (k + 1) % 4;
    soup.indices.insert(soup.indices.end(), {k, next, 4 + next, k, 4 + next, 4 + k, 4 + k, 4 + next, 8});
  }
  const MeshPtr m = decimate(*make_mesh(soup), 0, 0);
  ASSERT_EQ(m->triangles(), 12u);
  for (size_t v = 0; v < m->positions.size(); ++v) {
    const Vector3f& p = m->positions[v];
    if (p.z() == 0) {
      EXPECT_GT(m->normals[v].z(), .999) << p.transpose();
    }
  }
}

TEST(Decimate, RimsLooksAndTextureSeamsStay) {
  Soup soup = fine_box(8);
  soup.indices.resize(soup.indices.size() - 6 * 64);  // the last face is missing: its rim must stay
  soup.looks.resize(2);
  soup.looks[1].coloured = true;
  for (uint32_t t = 0; t < soup.indices.size() / 3; ++t)
    soup.triangle_look.push_back(t < 40);  // within a face
  const MeshPtr fine = make_mesh(soup), m = decimate(*fine, 0, 1e-6);
  EXPECT_LT(m->triangles(), fine->triangles() / 2);
  double area[2] = {0, 0};
  for (int which : {0, 1}) {
    const Mesh& mesh = which ? *m : *fine;
    for (const Surface& s : mesh.surfaces)
      for (size_t c = s.first; c < s.first + s.count && s.coloured; c += 3)
        area[which] +=
            (point(mesh, c + 1) - point(mesh, c)).cross(point(mesh, c + 2) - point(mesh, c)).norm() / 2;
  }
  EXPECT_NEAR(area[0], 20.0 / 64, 1e-6);
  EXPECT_NEAR(area[1], area[0], 1e-6) << "the coloured patch keeps its outline";
  EXPECT_LT(deviation(*fine, *m), 1e-6) << "and so does the rim";
}

}  // namespace
}  // namespace lab::render
