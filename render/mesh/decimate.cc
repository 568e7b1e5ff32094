#include "render/mesh/decimate.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <queue>
#include <unordered_map>

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Sum of squared distances to planes n.x + d = 0 of unit normals. Each plane weighs 1, so that the root of
// the sum is never below the distance to the farthest of them.
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double c = 0;

  void add(const Vector3d& n, double d) {
    a += n * n.transpose();
    b += d * n;
    c += d * d;
  }
  Quadric& operator+=(const Quadric& q) {
    a += q.a;
    b += q.b;
    c += q.c;
    return *this;
  }
  double operator()(const Vector3d& x) const { return std::max(0.0, x.dot(a * x) + 2 * b.dot(x) + c); }
};

struct Move {
  double rank;
  uint32_t from, to;                     // points
  uint32_t from_age, to_age;             // stale when a point has changed since
  bool operator<(const Move& o) const {  // the cheapest on top; ties by number, so that the result is one
    return rank != o.rank ? rank > o.rank : from != o.from ? from > o.from : to > o.to;
  }
};

// Vertices get the mean direction of their triangles, by area: a wide flat face stays flat, whatever is at
// its edge.
void make_normals(Mesh& mesh) {
  std::vector<Vector3d> sums(mesh.positions.size(), Vector3d::Zero());
  for (size_t c = 0; c < mesh.indices.size(); c += 3) {
    const auto corner = [&](size_t k) {
      return Vector3d(mesh.positions[mesh.indices[c + k]].cast<double>());
    };
    const Vector3d twice_area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (size_t k = 0; k < 3; ++k) sums[mesh.indices[c + k]] += twice_area;
  }
  for (size_t v = 0; v < sums.size(); ++v)
    if (sums[v].norm() > 0) mesh.normals[v] = sums[v].normalized().cast<float>();
}

// A vertex is only ever moved onto a neighbour, so every vertex that is left is one of the file's, with its own
// texture coordinate; creases stay.
class Decimator {
 public:
  explicit Decimator(const Mesh& mesh) : mesh_(mesh), corners_(mesh.indices) {
    find_points();
    find_planes();
    find_fixed();
  }

  void run(size_t triangles, double error) {
    for (uint32_t p = 0; p < place_.size(); ++p)
      for (uint32_t q : neighbours(p)) offer(p, q);
    while (alive_ > triangles && !moves_.empty()) {
      const Move m = moves_.top();
      moves_.pop();
      if (age_[m.from] != m.from_age || age_[m.to] != m.to_age) continue;
      if (cost(m.from, m.to) <= error * error && possible(m.from, m.to)) collapse(m.from, m.to);
    }
  }

  MeshPtr result() const {
    auto out = std::make_shared<Mesh>();
    constexpr uint32_t kNone = ~0u;
    std::vector<uint32_t> vertex(mesh_.positions.size(), kNone);
    for (const Surface& surface : mesh_.surfaces) {
      Surface kept = surface;
      kept.first = static_cast<uint32_t>(out->indices.size());
      for (uint32_t c = surface.first; c < surface.first + surface.count; ++c) {
        if (dead_[c / 3]) continue;
        uint32_t& v = vertex[corners_[c]];
        if (v == kNone) {
          v = static_cast<uint32_t>(out->positions.size());
          out->positions.push_back(mesh_.positions[corners_[c]]);
          out->normals.push_back(mesh_.normals[corners_[c]]);
          if (!mesh_.uvs.empty()) out->uvs.push_back(mesh_.uvs[corners_[c]]);
          if (!mesh_.colours.empty()) out->colours.push_back(mesh_.colours[corners_[c]]);
          out->bounds.extend(out->positions.back().cast<double>());
        }
        out->indices.push_back(v);
      }
      kept.count = static_cast<uint32_t>(out->indices.size()) - kept.first;
      if (kept.count) out->surfaces.push_back(kept);
    }
    make_normals(*out);
    return out;
  }

 private:
  struct Hash {
    size_t operator()(const Vector3f& p) const {
      uint32_t bits[3];
      std::memcpy(bits, p.data(), sizeof bits);
      return (bits[0] * 0x9e3779b97f4a7c15ull) ^ (bits[1] * 0xff51afd7ed558ccdull) ^
             (bits[2] * 0xc4ceb9fe1a85ec53ull);
    }
  };

  uint32_t point(uint32_t corner) const { return point_of_[corners_[corner]]; }

  // Vertices in one place (with several normals or texture coordinates) are one point.
  void find_points() {
    std::unordered_map<Vector3f, uint32_t, Hash> seen;
    for (const Vector3f& p : mesh_.positions) {
      const auto [it, fresh] = seen.try_emplace(p, static_cast<uint32_t>(place_.size()));
      if (fresh) place_.push_back(p.cast<double>());
      point_of_.push_back(it->second);
    }
    around_.resize(place_.size());
    age_.resize(place_.size(), 0);
    alive_ = corners_.size() / 3;
    dead_.resize(alive_, false);
    for (uint32_t c = 0; c < corners_.size(); ++c) around_[point(c)].push_back(c / 3);
  }

  Vector3d normal(const std::array<Vector3d, 3>& p) const { return (p[1] - p[0]).cross(p[2] - p[0]); }
  std::array<Vector3d, 3> triangle(uint32_t t) const {
    return {place_[point(3 * t)], place_[point(3 * t + 1)], place_[point(3 * t + 2)]};
  }

  void find_planes() {
    quadrics_.resize(place_.size());
    for (uint32_t t = 0; t < dead_.size(); ++t) {
      const auto p = triangle(t);
      const Vector3d n = normal(p).normalized();
      for (int k = 0; k < 3; ++k) quadrics_[point(3 * t + k)].add(n, -n.dot(p[0]));
    }
  }

  Vector3d face(uint32_t t) const { return normal(triangle(t)).normalized(); }

  // A plane along a side, upright on its triangle: to leave the side costs as much as to leave a surface.
  void add_wall(uint32_t low, uint32_t high, uint32_t t) {
    const Vector3d wall = (place_[high] - place_[low]).cross(normal(triangle(t))).normalized();
    for (uint32_t p : {low, high}) quadrics_[p].add(wall, -wall.dot(place_[low]));
  }

  // Points on the rim of a hole, which move along it; and points that must stay: on a side of two triangles
  // in the same direction or of more than two, where rims meet, where looks meet, where the texture is cut.
  void find_fixed() {
    fixed_.resize(place_.size(), false);
    rim_.resize(place_.size(), false);
    struct Side {
      uint32_t low, high;
      bool forward;
      uint32_t triangle;
    };
    std::vector<Side> sides;
    for (uint32_t c = 0; c < corners_.size(); ++c) {
      const uint32_t a = point(c), b = point(c % 3 == 2 ? c - 2 : c + 1);
      sides.push_back({std::min(a, b), std::max(a, b), a < b, c / 3});
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.forward < b.forward;
    });
    std::vector<int> rims(place_.size(), 0);
    for (size_t i = 0; i < sides.size();) {
      size_t end = i + 1;
      while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
      const uint32_t low = sides[i].low, high = sides[i].high;
      const bool pair = end - i == 2 && sides[i].forward != sides[i + 1].forward;
      if (end - i == 1) {
        ++rims[low];
        ++rims[high];
        add_wall(low, high, sides[i].triangle);
      } else if (!pair) {
        fixed_[low] = fixed_[high] = true;
      } else if (face(sides[i].triangle).dot(face(sides[i + 1].triangle)) < -0.5) {
        add_wall(low, high, sides[i].triangle);  // the edge of a blade
      }
      i = end;
    }
    for (uint32_t p = 0; p < place_.size(); ++p) {
      rim_[p] = rims[p] == 2;
      if (rims[p] != 0 && rims[p] != 2) fixed_[p] = true;
    }
    std::vector<uint32_t> look(place_.size(), ~0u), vertex(place_.size(), ~0u);
    for (uint32_t s = 0; s < mesh_.surfaces.size(); ++s)
      for (uint32_t c = mesh_.surfaces[s].first; c < mesh_.surfaces[s].first + mesh_.surfaces[s].count; ++c) {
        const uint32_t p = point(c);
        if (look[p] != ~0u && !looks_alike(mesh_.surfaces[look[p]], mesh_.surfaces[s])) fixed_[p] = true;
        if (vertex[p] != ~0u && !mesh_.uvs.empty() && mesh_.uvs[vertex[p]] != mesh_.uvs[corners_[c]])
          fixed_[p] = true;
        look[p] = s;
        vertex[p] = corners_[c];
      }
  }

  static bool looks_alike(const Surface& a, const Surface& b) {
    return a.coloured == b.coloured && a.rgba == b.rgba && a.texture == b.texture &&
           a.roughness == b.roughness;
  }

  std::vector<uint32_t> neighbours(uint32_t p) const {
    std::vector<uint32_t> out;
    for (uint32_t t : around_[p])
      for (int k = 0; k < 3; ++k)
        if (point(3 * t + k) != p) out.push_back(point(3 * t + k));
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  double cost(uint32_t from, uint32_t to) const {
    return quadrics_[from](place_[to]) + quadrics_[to](place_[to]);
  }

  void offer(uint32_t from, uint32_t to) {
    if (fixed_[from]) return;
    // In flat parts every move is free: there the short ones come first.
    const double length = (place_[from] - place_[to]).squaredNorm();
    moves_.push({cost(from, to) + 1e-6 * length, from, to, age_[from], age_[to]});
  }

  bool has(uint32_t t, uint32_t p) const {
    return point(3 * t) == p || point(3 * t + 1) == p || point(3 * t + 2) == p;
  }

  // Two triangles vanish (one at a rim), none of the others turns over or loses the side that its normals are
  // on.
  bool possible(uint32_t from, uint32_t to) const {
    const std::vector<uint32_t> a = neighbours(from), b = neighbours(to);
    std::vector<uint32_t> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    // A point on a rim moves along it. With other common neighbours the surface would be pinched.
    const auto shared =
        std::count_if(around_[from].begin(), around_[from].end(), [&](uint32_t t) { return has(t, to); });
    if (rim_[from] ? shared != 1 || common.size() != 1 : shared != 2 || common.size() != 2) return false;
    for (uint32_t t : around_[from]) {
      if (has(t, to)) continue;
      auto p = triangle(t);
      const Vector3d before = normal(p);
      for (int k = 0; k < 3; ++k)
        if (point(3 * t + k) == from) p[k] = place_[to];
      const Vector3d after = normal(p);
      const double sides =
          (p[1] - p[0]).squaredNorm() + (p[2] - p[1]).squaredNorm() + (p[0] - p[2]).squaredNorm();
      if (!(after.norm() > 1e-4 * sides) || !(after.dot(before) > 0.7 * after.norm() * before.norm()))
        return false;
      for (int k = 0; k < 3; ++k) {
        const Vector3d n = mesh_.normals[vertex_at(t, k, from, to, after)].cast<double>();
        if (!(n.dot(after) > 0.3 * after.norm())) return false;
      }
    }
    return true;
  }

  // The vertex of a corner once `from` has moved to `to`: of the vertices there on both sides of the line
  // that vanishes the one whose normal suits the face.
  uint32_t vertex_at(uint32_t t, int k, uint32_t from, uint32_t to, const Vector3d& face) const {
    if (point(3 * t + k) != from) return corners_[3 * t + k];
    uint32_t best = ~0u;
    double most = -2;
    for (uint32_t gone : around_[from])
      for (uint32_t c = 3 * gone; c < 3 * gone + 3; ++c) {
        if (point(c) != to) continue;
        const double suits = mesh_.normals[corners_[c]].cast<double>().dot(face);
        if (best == ~0u || suits > most) {
          best = corners_[c];
          most = suits;
        }
      }
    return best;
  }

  void collapse(uint32_t from, uint32_t to) {
    std::vector<std::pair<uint32_t, uint32_t>> changes;  // corner, vertex
    for (uint32_t t : around_[from]) {
      if (has(t, to)) continue;
      auto p = triangle(t);
      for (int k = 0; k < 3; ++k)
        if (point(3 * t + k) == from) p[k] = place_[to];
      for (int k = 0; k < 3; ++k)
        if (point(3 * t + k) == from) changes.emplace_back(3 * t + k, vertex_at(t, k, from, to, normal(p)));
    }
    for (uint32_t t : around_[from])
      if (has(t, to)) {
        dead_[t] = true;
        --alive_;
      }
    const std::vector<uint32_t> ring = neighbours(from);
    for (const auto& [corner, vertex] : changes) {
      corners_[corner] = vertex;
      around_[to].push_back(corner / 3);
    }
    around_[from].clear();
    for (uint32_t p : ring) std::erase_if(around_[p], [&](uint32_t t) { return dead_[t]; });
    quadrics_[to] += quadrics_[from];
    ++age_[from];
    ++age_[to];
    for (uint32_t q : neighbours(to)) {
      offer(to, q);
      offer(q, to);
    }
  }

  const Mesh& mesh_;
  std::vector<uint32_t> corners_;   // vertex of each corner, as Mesh::indices
  std::vector<uint32_t> point_of_;  // of each vertex
  std::vector<Vector3d> place_;     // of each point
  std::vector<Quadric> quadrics_;
  std::vector<std::vector<uint32_t>> around_;  // living triangles at each point
  std::vector<uint32_t> age_;
  std::vector<bool> fixed_, rim_, dead_;
  size_t alive_ = 0;
  std::priority_queue<Move> moves_;
};

}  // namespace

MeshPtr decimate(const Mesh& mesh, size_t triangles, double error) {
  Decimator work(mesh);
  work.run(triangles, error);
  return work.result();
}

}  // namespace lab::render
