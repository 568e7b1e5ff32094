#include "render/mesh/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "render/mesh/primitives.h"

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

Vector3d point(const Mesh& m, size_t i) { return m.positions[m.indices[i]].cast<double>(); }

double area(const Mesh& m) {
  double sum = 0;
  for (size_t i = 0; i < m.indices.size(); i += 3)
    sum += (point(m, i + 1) - point(m, i)).cross(point(m, i + 2) - point(m, i)).norm() / 2;
  return sum;
}

double volume(const Mesh& m) {  // divergence theorem: positive only if faces point outward
  double sum = 0;
  for (size_t i = 0; i < m.indices.size(); i += 3)
    sum += point(m, i).dot(point(m, i + 1).cross(point(m, i + 2))) / 6;
  return sum;
}

// Every side of a triangle is passed exactly once in each direction.
void expect_closed(const Mesh& m) {
  std::map<std::array<float, 6>, int> sides;
  for (size_t i = 0; i < m.indices.size(); ++i) {
    const Vector3f a = m.positions[m.indices[i]], b = m.positions[m.indices[i % 3 == 2 ? i - 2 : i + 1]];
    ++sides[{a[0] + 0.f, a[1] + 0.f, a[2] + 0.f, b[0] + 0.f, b[1] + 0.f, b[2] + 0.f}];
  }
  for (const auto& [s, n] : sides) {
    EXPECT_EQ(n, 1);
    EXPECT_EQ(sides.count({s[3], s[4], s[5], s[0], s[1], s[2]}), 1u);
  }
}

// Unit normals that look outward from a convex shape around the origin, and to their faces' side.
void expect_outward(const Mesh& m) {
  for (size_t i = 0; i < m.indices.size(); ++i) {
    const Vector3d n = m.normals[m.indices[i]].cast<double>();
    EXPECT_NEAR(n.norm(), 1, 1e-6);
    EXPECT_GT(n.dot(point(m, i)), 0);
    const size_t t = i / 3 * 3;
    EXPECT_GT(n.dot((point(m, t + 1) - point(m, t)).cross(point(m, t + 2) - point(m, t)).normalized()), 0.5);
  }
}

// Float coordinates: relative error of a few 1e-7.
constexpr double kEps = 2e-6;

TEST(Mesh, Box) {
  const MeshPtr m = make_box({2, 3, 4});
  EXPECT_EQ(m->triangles(), 12u);
  EXPECT_NEAR(volume(*m), 24, 24 * kEps);
  EXPECT_NEAR(area(*m), 52, 52 * kEps);
  EXPECT_TRUE(m->bounds.isApprox(Bounds(Vector3d(-1, -1.5, -2), Vector3d(1, 1.5, 2))));
  expect_closed(*m);
  expect_outward(*m);
}

TEST(Mesh, CylinderIsTheRegularPrism) {
  for (int n : {3, 12, 48}) {
    const double r = 0.3, h = 0.7, base = n / 2.0 * std::sin(2 * M_PI / n) * r * r;
    const MeshPtr m = make_cylinder(r, h, n);
    EXPECT_NEAR(volume(*m), base * h, base * h * kEps);
    const double all = 2 * base + n * 2 * r * std::sin(M_PI / n) * h;
    EXPECT_NEAR(area(*m), all, all * kEps);
    EXPECT_EQ(m->triangles(), static_cast<size_t>(4 * n));
    expect_closed(*m);
  }
  expect_outward(*make_cylinder(0.3, 0.7, 24));
}

TEST(Mesh, SphereConvergesWithSecondOrder) {
  const double r = 0.4, v = 4.0 / 3 * M_PI * r * r * r, s = 4 * M_PI * r * r;
  double dv[2], ds[2];
  for (int k : {0, 1}) {
    const MeshPtr m = make_sphere(r, 24 << k);
    dv[k] = v - volume(*m);
    ds[k] = s - area(*m);
    expect_closed(*m);
    expect_outward(*m);
    for (size_t i = 0; i < m->positions.size(); ++i)
      EXPECT_LT((m->normals[i] * r - m->positions[i]).norm(), 1e-6);
  }
  EXPECT_GT(dv[1], 0);  // inscribed
  EXPECT_GT(ds[1], 0);
  EXPECT_NEAR(dv[0] / dv[1], 4, 0.1);
  EXPECT_NEAR(ds[0] / ds[1], 4, 0.1);
  EXPECT_LT(dv[1] / v, 0.01);
}

TEST(Mesh, CapsuleIsSphereAndPrism) {
  const int n = 32;
  const double r = 0.2, h = 0.5;
  const MeshPtr capsule = make_capsule(r, h, n), sphere = make_sphere(r, n);
  const double prism = n / 2.0 * std::sin(2 * M_PI / n) * r * r * h,
               side = n * 2 * r * std::sin(M_PI / n) * h;
  EXPECT_NEAR(volume(*capsule), volume(*sphere) + prism, kEps);
  EXPECT_NEAR(area(*capsule), area(*sphere) + side, kEps);
  EXPECT_NEAR(capsule->bounds.sizes().z(), h + 2 * r, 1e-6);
  expect_closed(*capsule);
  expect_outward(*capsule);
}

TEST(Mesh, PrimitivesRefuseBadSizes) {
  const double nan = std::nan("");
  EXPECT_THROW(make_box({1, 0, 1}), std::invalid_argument);
  EXPECT_THROW(make_box({1, nan, 1}), std::invalid_argument);
  EXPECT_THROW(make_cylinder(-1, 1), std::invalid_argument);
  EXPECT_THROW(make_cylinder(1, HUGE_VAL), std::invalid_argument);
  EXPECT_THROW(make_cylinder(1, 1, 2), std::invalid_argument);
  EXPECT_THROW(make_sphere(0), std::invalid_argument);
  EXPECT_THROW(make_sphere(1, 100000), std::invalid_argument);
  EXPECT_THROW(make_capsule(1, -0.1), std::invalid_argument);
}

// A primitive taken apart: every triangle with corners of its own, as an STL file has them.
Soup apart(const Mesh& m) {
  Soup soup;
  for (uint32_t i : m.indices) {
    soup.indices.push_back(static_cast<uint32_t>(soup.positions.size()));
    soup.positions.push_back(m.positions[i]);
  }
  return soup;
}

TEST(Mesh, WeldingAndCreasesRebuildABox) {
  const MeshPtr m = make_mesh(apart(*make_box({1, 2, 3})));
  EXPECT_EQ(m->positions.size(), 24u);  // three normals at each of eight corners
  for (const Vector3f& n : m->normals) EXPECT_NEAR(n.cwiseAbs().maxCoeff(), 1, 1e-6);
  expect_outward(*m);
  ASSERT_EQ(m->surfaces.size(), 1u);
  EXPECT_FALSE(m->surfaces[0].two_sided);
}

TEST(Mesh, WeldingAndSmoothingRebuildASphere) {
  const MeshPtr ball = make_sphere(1, 48), m = make_mesh(apart(*ball));
  EXPECT_EQ(m->positions.size(), ball->positions.size());
  for (size_t i = 0; i < m->positions.size(); ++i)  // the faces' mean is radial to within half a face's angle
    EXPECT_GT(m->normals[i].dot(m->positions[i]), std::cos(M_PI / 48));
}

TEST(Mesh, InsideOutIsTurned) {
  Soup soup = apart(*make_cylinder(.5, 1, 12));
  for (size_t t = 0; t < soup.indices.size(); t += 3) std::swap(soup.indices[t], soup.indices[t + 1]);
  const MeshPtr m = make_mesh(soup);
  EXPECT_GT(volume(*m), 0);
  expect_outward(*m);
}

TEST(Mesh, HolesAreFoundAndSlitsAreNot) {
  Soup box = apart(*make_box({1, 1, 1}));
  box.indices.resize(box.indices.size() - 6);  // one face of six is gone
  EXPECT_TRUE(make_mesh(box)->surfaces[0].two_sided);

  // A slit: one corner of one triangle is a hair's breadth off, so that it no longer welds.
  Soup ball = apart(*make_sphere(1, 48));
  ball.positions[300].x() += 1e-5f;
  EXPECT_FALSE(make_mesh(ball)->surfaces[0].two_sided);

  // An open tube: its two ends' areas point in opposite directions and must not cancel.
  Soup tube;
  for (int i = 0; i < 8; ++i)
    for (float z : {0.f, 1.f})
      tube.positions.emplace_back(std::cos(i * float(M_PI) / 4), std::sin(i * float(M_PI) / 4), z);
  for (uint32_t i = 0; i < 8; ++i) {
    const uint32_t a = 2 * i, b = 2 * ((i + 1) % 8);
    tube.indices.insert(tube.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
  }
  EXPECT_TRUE(make_mesh(tube)->surfaces[0].two_sided);
}

TEST(Mesh, ColoursMakeSurfaces) {
  Soup soup = apart(*make_box({1, 1, 1}));
  soup.looks.resize(2);
  soup.looks[1].coloured = true;
  for (uint32_t t = 0; t < 12; ++t) soup.triangle_look.push_back(t < 4);
  const MeshPtr m = make_mesh(soup);
  ASSERT_EQ(m->surfaces.size(), 2u);
  EXPECT_EQ(m->surfaces[0].count, 12u);
  EXPECT_TRUE(m->surfaces[0].coloured);
  EXPECT_FALSE(m->surfaces[1].coloured);
  EXPECT_EQ(m->surfaces[1].first + m->surfaces[1].count, m->indices.size());
  expect_closed(*m);
}

TEST(Mesh, GivenNormalsAreKeptWhenTheyMeanSomething) {
  const MeshPtr ball = make_sphere(1, 12);
  Soup soup;
  soup.positions = ball->positions;
  soup.normals = ball->normals;
  soup.indices = ball->indices;
  const MeshPtr kept = make_mesh(soup);
  for (size_t i = 0; i < kept->positions.size(); ++i)
    EXPECT_LT((kept->normals[i] - kept->positions[i]).norm(), 1e-4);
  for (Vector3f& n : soup.normals) n = -n;  // nonsense: our own instead
  expect_outward(*make_mesh(soup));
}

TEST(Mesh, BadSoupIsRefused) {
  const Soup good = apart(*make_box({1, 1, 1}));
  Soup soup = good;
  soup.indices[5] = 1000;
  EXPECT_THROW(make_mesh(soup), std::invalid_argument);
  soup = good;
  soup.positions[3].y() = NAN;
  EXPECT_THROW(make_mesh(soup), std::invalid_argument);
  soup = good;
  soup.indices.pop_back();
  EXPECT_THROW(make_mesh(soup), std::invalid_argument);
  soup = good;
  soup.looks.resize(1);
  soup.triangle_look.resize(3);
  EXPECT_THROW(make_mesh(soup), std::invalid_argument);
  soup = good;
  soup.triangle_look.resize(12, 0);
  EXPECT_THROW(make_mesh(soup), std::invalid_argument);
  soup = good;
  soup.uvs.resize(3);
  EXPECT_THROW(make_mesh(soup), std::invalid_argument);
  soup = good;
  soup.normals.resize(3);
  EXPECT_THROW(make_mesh(soup), std::invalid_argument);
  EXPECT_THROW(make_mesh({}), std::invalid_argument);
  for (Vector3f& p : soup.positions) {
    p.z() = 0;
    p.y() = 0;
  }  // a line
  soup.normals.clear();
  EXPECT_THROW(make_mesh(soup), std::invalid_argument);
}

}  // namespace
}  // namespace lab::render
