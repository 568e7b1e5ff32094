#include "render/mesh/primitives.h"

#include <cmath>
#include <span>
#include <stdexcept>

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

void need(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

bool positive(double x) { return x > 0 && std::isfinite(x); }

class Builder {
 public:
  uint32_t vertex(const Vector3d& p, const Vector3d& n) {
    mesh_->positions.push_back(p.cast<float>());
    mesh_->normals.push_back(n.cast<float>());
    mesh_->bounds.extend(mesh_->positions.back().cast<double>());
    return static_cast<uint32_t>(mesh_->positions.size() - 1);
  }
  void triangle(uint32_t a, uint32_t b, uint32_t c) {
    mesh_->indices.insert(mesh_->indices.end(), {a, b, c});
  }
  MeshPtr done() {
    Surface all;
    all.count = static_cast<uint32_t>(mesh_->indices.size());
    mesh_->surfaces.push_back(all);
    return mesh_;
  }

 private:
  std::shared_ptr<Mesh> mesh_ = std::make_shared<Mesh>();
};

Vector3d direction(int i, int segments) {
  const double a = 2 * M_PI * (i % segments) / segments;  // the seam closes exactly
  return {std::cos(a), std::sin(a), 0};
}

// A surface of revolution around z from rings of (radius, z, normal) listed from the top down; a ring of
// radius 0 is one point.
struct Ring {
  double radius, z;
  double normal_r, normal_z;
};

void revolve(Builder& b, std::span<const Ring> rings, int segments) {
  std::vector<uint32_t> above;
  for (const Ring& ring : rings) {
    std::vector<uint32_t> here;
    for (int i = 0; i < (ring.radius > 0 ? segments : 1); ++i) {
      const Vector3d d = direction(i, segments), z = Vector3d::UnitZ();
      here.push_back(b.vertex(ring.radius * d + ring.z * z, ring.normal_r * d + ring.normal_z * z));
    }
    const size_t na = above.size(), nh = here.size();
    for (int i = 0; na > 0 && i < segments; ++i) {
      const int j = (i + 1) % segments;
      if (nh > 1) b.triangle(above[i % na], here[i], here[j]);
      if (na > 1) b.triangle(above[i], here[j % nh], above[j]);
    }
    above = std::move(here);
  }
}

}  // namespace

MeshPtr make_box(const Vector3d& size) {
  need(positive(size.x()) && positive(size.y()) && positive(size.z()),
       "box: sizes must be positive and finite");
  Builder b;
  for (int axis = 0; axis < 3; ++axis) {
    for (int sign : {1, -1}) {
      const Vector3d n = sign * Vector3d::Unit(axis), u = Vector3d::Unit((axis + 1) % 3), v = n.cross(u);
      const auto corner = [&](int su, int sv) {
        return b.vertex(size.cwiseProduct(n + su * u + sv * v) / 2, n);
      };
      const uint32_t c[4] = {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
      b.triangle(c[0], c[1], c[2]);
      b.triangle(c[0], c[2], c[3]);
    }
  }
  return b.done();
}

MeshPtr make_cylinder(double radius, double length, int segments) {
  need(positive(radius) && positive(length), "cylinder: radius and length must be positive and finite");
  need(segments >= 3 && segments <= 1024, "cylinder: segments must be 3..1024");
  const double h = length / 2;
  Builder b;
  const Ring top[] = {{0, h, 0, 1}, {radius, h, 0, 1}};
  const Ring side[] = {{radius, h, 1, 0}, {radius, -h, 1, 0}};
  const Ring bottom[] = {{radius, -h, 0, -1}, {0, -h, 0, -1}};
  revolve(b, top, segments);
  revolve(b, side, segments);
  revolve(b, bottom, segments);
  return b.done();
}

MeshPtr make_cone(double radius, double length, int segments) {
  need(positive(radius) && positive(length), "cone: radius and length must be positive and finite");
  need(segments >= 3 && segments <= 1024, "cone: segments must be 3..1024");
  const double slant = std::hypot(radius, length), nr = length / slant, nz = radius / slant;
  Builder b;
  // At the tip every segment has a normal of its own: a ring of no size instead of a point.
  const Ring side[] = {{1e-9 * radius, length, nr, nz}, {radius, 0, nr, nz}};
  const Ring base[] = {{radius, 0, 0, -1}, {0, 0, 0, -1}};
  revolve(b, side, segments);
  revolve(b, base, segments);
  return b.done();
}

MeshPtr make_capsule(double radius, double length, int segments) {
  need(positive(radius) && length >= 0 && std::isfinite(length),
       "capsule: radius must be positive, length not negative, both finite");
  need(segments >= 3 && segments <= 1024, "capsule: segments must be 3..1024");
  const int quarter = std::max(2, segments / 4);
  std::vector<Ring> rings;
  for (int i = 0; i <= 2 * quarter; ++i) {
    const double a = M_PI / 2 * i / quarter;  // from the upper pole
    const bool pole = i == 0 || i == 2 * quarter;
    const double r = pole ? 0 : std::sin(a), z = i == quarter ? 0 : std::cos(a);
    const double shift = i <= quarter ? length / 2 : -length / 2;
    rings.push_back({radius * r, radius * z + shift, r, z});
    if (i == quarter && length > 0) rings.push_back({radius, -length / 2, 1, 0});
  }
  Builder b;
  revolve(b, rings, segments);
  return b.done();
}

MeshPtr make_sphere(double radius, int segments) {
  need(positive(radius), "sphere: radius must be positive and finite");
  need(segments >= 3 && segments <= 1024, "sphere: segments must be 3..1024");
  return make_capsule(radius, 0, segments);
}

}  // namespace lab::render
