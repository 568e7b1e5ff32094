#include "render/mesh/sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lab::render {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSide = 192, kDirections = 80;
constexpr uint32_t kNothing = ~0u;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// A picture in which each pixel knows the triangle that is nearest at its centre.
class View {
 public:
  View() : depth_(kSide * kSide), triangle_(kSide * kSide) {}

  void clear() {
    std::fill(depth_.begin(), depth_.end(), std::numeric_limits<double>::infinity());
    std::fill(triangle_.begin(), triangle_.end(), kNothing);
  }

  // Corners in pixels and depth.
  void draw(uint32_t triangle, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const Vector2d p = a.head<2>(), q = b.head<2>(), r = c.head<2>();
    const double area = cross(q - p, r - p);
    if (area == 0) return;
    const auto pixels = [](double low, double high, int& from, int& to) {
      from = std::max(0, static_cast<int>(std::ceil(low - 0.5)));
      to = std::min(kSide - 1, static_cast<int>(std::floor(high - 0.5)));
    };
    int left, right, top, bottom;
    pixels(std::min({p.x(), q.x(), r.x()}), std::max({p.x(), q.x(), r.x()}), left, right);
    pixels(std::min({p.y(), q.y(), r.y()}), std::max({p.y(), q.y(), r.y()}), top, bottom);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        const Vector2d s(x + 0.5, y + 0.5);
        const double u = cross(r - q, s - q) / area, v = cross(p - r, s - r) / area, w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const double depth = u * a.z() + v * b.z() + w * c.z();
        const size_t at = static_cast<size_t>(y) * kSide + static_cast<size_t>(x);
        if (depth >= depth_[at]) continue;
        depth_[at] = depth;
        triangle_[at] = triangle;
      }
  }

  const std::vector<uint32_t>& triangles() const { return triangle_; }

 private:
  std::vector<double> depth_;
  std::vector<uint32_t> triangle_;
};

}  // namespace

std::vector<Seen> look_from_all_around(const std::vector<Eigen::Vector3f>& points,
                                       const std::vector<uint32_t>& corners) {
  std::vector<Seen> seen(corners.size() / 3);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : points) box.extend(p.cast<double>());
  const double scale = (kSide - 2) / std::max(box.diagonal().norm(), 1e-30);
  View view;
  std::vector<Vector3d> place(points.size());
  for (int i = 0; i < kDirections; ++i) {  // evenly over a sphere: a spiral by the golden angle
    const double z = 1 - (2 * i + 1.0) / kDirections, across = std::sqrt(1 - z * z), turn = 2.399963 * i;
    const Vector3d away(across * std::cos(turn), across * std::sin(turn), z);
    const Vector3d right = away.unitOrthogonal(), up = away.cross(right);
    for (size_t k = 0; k < points.size(); ++k) {
      const Vector3d p = points[k].cast<double>() - box.center();
      place[k] = {right.dot(p) * scale + kSide / 2.0, up.dot(p) * scale + kSide / 2.0, away.dot(p)};
    }
    view.clear();
    for (uint32_t t = 0; t < seen.size(); ++t)
      view.draw(t, place[corners[3 * t]], place[corners[3 * t + 1]], place[corners[3 * t + 2]]);
    for (uint32_t t : view.triangles()) {
      if (t == kNothing) continue;
      const Vector3d &a = place[corners[3 * t]], &b = place[corners[3 * t + 1]],
                     &c = place[corners[3 * t + 2]];
      // right, up, away are right-handed: what runs counterclockwise in them looks away
      cross((b - a).head<2>(), (c - a).head<2>()) < 0 ? ++seen[t].front : ++seen[t].back;
    }
  }
  return seen;
}

}  // namespace lab::render
