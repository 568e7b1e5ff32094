#include "render/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

#include "render/mesh/sides.h"

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Bytes of a position as a hash key; -0 is folded into 0 so that both weld.
struct PositionHash {
  size_t operator()(const Vector3f& p) const {
    uint32_t bits[3];
    std::memcpy(bits, p.data(), sizeof bits);
    uint64_t h = 0x9e3779b97f4a7c15ull;
    for (uint32_t b : bits) {
      h = (h ^ b) * 0xff51afd7ed558ccdull;
      h ^= h >> 32;
    }
    return h;
  }
};

// Disjoint sets with path halving.
class Groups {
 public:
  explicit Groups(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) {
    a = find(a);
    b = find(b);
    // the smaller index stays the root: the result does not depend on the order of joins
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

// One side of a triangle, running from corner `corner` to the next one. Sorted so that sides on the same line
// of two points lie next to each other.
struct Side {
  uint32_t low, high;  // welded points
  uint32_t corner;     // triangle * 3 + 0..2
  bool forward;        // runs from low to high
};

uint32_t next_corner(uint32_t c) { return c % 3 == 2 ? c - 2 : c + 1; }

// The working state of make_mesh: welded points, and for each triangle its face normal.
struct Welded {
  std::vector<Vector3f> points;
  std::vector<uint32_t> corners;  // point of each corner
  std::vector<uint32_t> source;   // index of the triangle as the caller counts
  std::vector<Vector3d> normals;  // of the faces, unit length
  std::vector<double> areas;
};

Welded weld(const Soup& soup) {
  const std::vector<Vector3f>& positions = soup.positions;
  const std::vector<uint32_t>& indices = soup.indices;
  Welded w;
  std::unordered_map<Vector3f, uint32_t, PositionHash> seen;
  seen.reserve(positions.size());
  std::vector<uint32_t> point_of(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    if (!positions[i].allFinite())
      throw std::invalid_argument("vertex " + std::to_string(i) +
                                  " has a coordinate that is not a finite number");
    const Vector3f p = positions[i] + Vector3f::Zero();  // -0 + 0 = 0
    const auto [it, fresh] = seen.try_emplace(p, static_cast<uint32_t>(w.points.size()));
    if (fresh) w.points.push_back(p);
    point_of[i] = it->second;
  }
  w.corners.reserve(indices.size());
  for (size_t t = 0; t + 2 < indices.size(); t += 3) {
    uint32_t p[3];
    for (int k = 0; k < 3; ++k) {
      if (indices[t + k] >= positions.size())
        throw std::invalid_argument("triangle " + std::to_string(t / 3) + " names vertex " +
                                    std::to_string(indices[t + k]) + " of " +
                                    std::to_string(positions.size()));
      p[k] = point_of[indices[t + k]];
    }
    const Vector3d a = w.points[p[0]].cast<double>(), b = w.points[p[1]].cast<double>(),
                   c = w.points[p[2]].cast<double>();
    const Vector3d n = (b - a).cross(c - a);
    const double area = n.norm();
    if (!(area > 0) || p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;  // nothing to see
    w.corners.insert(w.corners.end(), p, p + 3);
    w.source.push_back(static_cast<uint32_t>(t / 3));
    w.normals.push_back(n / area);
    w.areas.push_back(area / 2);
  }
  if (w.corners.empty()) throw std::invalid_argument("no triangle with an area");
  return w;
}

// Angle of the triangle at a corner: the weight of its face in the vertex normal.
double corner_angle(const Welded& w, uint32_t c) {
  const Vector3d p = w.points[w.corners[c]].cast<double>();
  const Vector3d u = w.points[w.corners[next_corner(c)]].cast<double>() - p;
  const Vector3d v = w.points[w.corners[next_corner(next_corner(c))]].cast<double>() - p;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

// A stretch of rim: a line of two points that the surface passes `times` more often from `from` to `to` than
// back.
struct Rim {
  uint32_t from, to;  // welded points
  int times;
  uint32_t triangle;  // one that touches it
};

// For each piece (by its root triangle): is it open? Real meshes are full of slits of no width (unwelded
// seams, T junctions), which would make nearly all of them open. So a piece counts as open only when the
// holes that its rims enclose are more than 1/1000 of its surface. Rims always form closed loops, and the
// area of a loop is |sum of from x to| / 2.
std::vector<bool> find_open(const Welded& w, Groups& pieces, const std::vector<Rim>& rims) {
  const size_t count = w.corners.size() / 3;
  std::vector<bool> open(count, false);
  if (rims.empty()) return open;
  Groups loops(w.points.size());
  for (const Rim& r : rims) loops.join(r.from, r.to);
  std::unordered_map<uint32_t, Vector3d> loop_area;  // by the root point
  std::unordered_map<uint32_t, uint32_t> piece_of_loop;
  for (const Rim& r : rims) {
    const uint32_t root = loops.find(r.from);
    const Vector3d origin = w.points[root].cast<double>();
    const Vector3d a = w.points[r.from].cast<double>() - origin, b = w.points[r.to].cast<double>() - origin;
    loop_area.try_emplace(root, Vector3d::Zero()).first->second += r.times * a.cross(b) / 2;
    piece_of_loop[root] = pieces.find(r.triangle);
  }
  std::vector<double> holes(count, 0.0), area(count, 0.0);
  for (const Rim& r : rims) {  // in the order of rims, each loop once: sums do not depend on hashing
    const auto it = loop_area.find(loops.find(r.from));
    if (it == loop_area.end()) continue;
    holes[piece_of_loop[it->first]] += it->second.norm();
    loop_area.erase(it);
  }
  for (uint32_t t = 0; t < count; ++t) area[pieces.find(t)] += w.areas[t];
  for (uint32_t t = 0; t < count; ++t) open[t] = holes[t] > 1e-3 * area[t];
  return open;
}

// The caller's normals, one per corner. None if there are none, if more than one in a hundred does not suit
// its triangle, or if nine in ten are just their triangle's own: flat shading by an exporter, not by intent.
std::vector<Vector3f> given_normals(const Welded& w, const Soup& soup) {
  std::vector<Vector3f> normals;
  if (soup.normals.empty()) return normals;
  size_t wrong = 0, flat = 0;
  for (uint32_t c = 0; c < w.corners.size(); ++c) {
    const Vector3d given = soup.normals[soup.indices[3 * w.source[c / 3] + c % 3]].cast<double>();
    const double length = given.norm();
    const double along = given.dot(w.normals[c / 3]);
    const bool suits = std::isfinite(length) && length > 1e-3 && along > 0.1 * length;
    wrong += !suits;
    flat += along > 0.9999 * length;
    normals.push_back((suits ? Vector3d(given / length) : w.normals[c / 3]).cast<float>());
  }
  if (100 * wrong > normals.size() || 10 * flat > 9 * normals.size()) normals.clear();
  return normals;
}

// One normal per corner: the mean of its smooth group's faces, by their angle at the point.
std::vector<Vector3f> made_normals(const Welded& w, Groups& smooth) {
  std::vector<Vector3d> sums(w.corners.size(), Vector3d::Zero());
  for (uint32_t c = 0; c < sums.size(); ++c) sums[smooth.find(c)] += corner_angle(w, c) * w.normals[c / 3];
  std::vector<Vector3f> normals;
  for (uint32_t c = 0; c < sums.size(); ++c) {
    const Vector3d& sum = sums[smooth.find(c)];
    const double length = sum.norm();
    normals.push_back((length > 1e-12 ? Vector3d(sum / length) : w.normals[c / 3]).cast<float>());
  }
  return normals;
}

// Corners at one point with (nearly) one normal and one place in the texture become one vertex; returns the
// vertex of each corner.
std::vector<uint32_t> share_vertices(const Welded& w, const Soup& soup, const std::vector<Vector3f>& normals,
                                     Mesh& mesh) {
  const bool textured =
      !soup.uvs.empty() && std::any_of(soup.looks.begin(), soup.looks.end(),
                                       [](const Surface& s) { return s.texture != nullptr; });
  const auto uv_of = [&](uint32_t c) -> Eigen::Vector2f {
    return textured ? soup.uvs[soup.indices[3 * w.source[c / 3] + c % 3]] : Eigen::Vector2f::Zero();
  };
  constexpr uint32_t kNone = ~0u;
  std::vector<uint32_t> first(w.points.size(), kNone), next, vertex_of;
  for (uint32_t c = 0; c < w.corners.size(); ++c) {
    uint32_t v = first[w.corners[c]];
    while (v != kNone &&
           ((mesh.normals[v] - normals[c]).squaredNorm() > 1e-6f || (textured && mesh.uvs[v] != uv_of(c))))
      v = next[v];
    if (v == kNone) {
      v = static_cast<uint32_t>(mesh.positions.size());
      mesh.positions.push_back(w.points[w.corners[c]]);
      mesh.normals.push_back(normals[c]);
      if (textured) mesh.uvs.push_back(uv_of(c));
      mesh.bounds.extend(mesh.positions.back().cast<double>());
      next.push_back(first[w.corners[c]]);
      first[w.corners[c]] = v;
    }
    vertex_of.push_back(v);
  }
  return vertex_of;
}

// Triangles that are seen from behind by a viewer outside, through holes or because they are the wrong way round,
// and what touches them: between two looks there is always another one. All others may be drawn from their
// front alone.
std::vector<bool> find_two_sided(const Welded& w, const std::vector<bool>& turned) {
  std::vector<uint32_t> corners = w.corners;
  for (size_t t = 0; t < turned.size(); ++t)
    if (turned[t]) std::swap(corners[3 * t + 1], corners[3 * t + 2]);
  const std::vector<Seen> seen = look_from_all_around(w.points, corners);
  std::vector<bool> both(seen.size());
  std::vector<bool> touched(w.points.size(), false);
  for (uint32_t c = 0; c < w.corners.size(); ++c)
    if (seen[c / 3].back > 0) touched[w.corners[c]] = true;
  for (uint32_t c = 0; c < w.corners.size(); ++c)
    if (touched[w.corners[c]]) both[c / 3] = true;
  return both;
}

}  // namespace

MeshPtr make_mesh(const Soup& soup, double crease) {
  if (soup.indices.size() % 3 != 0)
    throw std::invalid_argument("the number of indices is not a multiple of three");
  if (!soup.triangle_look.empty() && soup.triangle_look.size() != soup.indices.size() / 3)
    throw std::invalid_argument("looks and triangles differ in number");
  for (uint32_t look : soup.triangle_look)
    if (look >= soup.looks.size()) throw std::invalid_argument("a triangle has a look that is not there");
  if (!soup.uvs.empty() && soup.uvs.size() != soup.positions.size())
    throw std::invalid_argument("texture coordinates and positions differ in number");
  if (!soup.normals.empty() && soup.normals.size() != soup.positions.size())
    throw std::invalid_argument("normals and positions differ in number");
  Welded w = weld(soup);
  const uint32_t corner_count = static_cast<uint32_t>(w.corners.size()), count = corner_count / 3;

  std::vector<Side> sides(corner_count);
  for (uint32_t c = 0; c < corner_count; ++c) {
    const uint32_t a = w.corners[c], b = w.corners[next_corner(c)];
    sides[c] = {std::min(a, b), std::max(a, b), c, a < b};
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.corner < b.corner;
  });

  // Corners around a point share a normal when smooth sides connect their triangles. A side is smooth when
  // exactly two triangles meet there, run along it in opposite directions, and bend by less than the crease
  // angle.
  const double cos_crease = std::cos(crease);
  Groups smooth(corner_count), pieces(count);
  std::vector<Rim> rims;
  for (size_t i = 0; i < sides.size();) {
    size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
    int balance = 0;  // of directions: a closed surface passes each line as often forth as back
    for (size_t k = i; k < end; ++k) {
      balance += sides[k].forward ? 1 : -1;
      pieces.join(sides[k].corner / 3, sides[i].corner / 3);
    }
    if (balance != 0) rims.push_back({sides[i].low, sides[i].high, balance, sides[i].corner / 3});
    if (end - i == 2 && balance == 0) {
      const uint32_t c = sides[i].corner, d = sides[i + 1].corner;
      if (w.normals[c / 3].dot(w.normals[d / 3]) > cos_crease) {
        smooth.join(c, next_corner(d));
        smooth.join(next_corner(c), d);
      }
    }
    i = end;
  }

  const std::vector<bool> open = find_open(w, pieces, rims);
  std::vector<double> volume(count, 0.0);
  for (uint32_t t = 0; t < count; ++t) {
    const Vector3d a = w.points[w.corners[3 * t]].cast<double>(),
                   b = w.points[w.corners[3 * t + 1]].cast<double>(),
                   c = w.points[w.corners[3 * t + 2]].cast<double>();
    volume[pieces.find(t)] += a.dot(b.cross(c));
  }

  // A closed piece that is inside out is turned.
  std::vector<bool> turned(count);
  for (uint32_t t = 0; t < count; ++t) {
    const uint32_t piece = pieces.find(t);
    turned[t] = !open[piece] && volume[piece] < 0;
    if (turned[t]) w.normals[t] = -w.normals[t];
  }
  const std::vector<bool> both_sides = find_two_sided(w, turned);

  std::vector<Vector3f> normals = given_normals(w, soup);
  if (normals.empty()) normals = made_normals(w, smooth);
  auto mesh = std::make_shared<Mesh>();
  const std::vector<uint32_t> vertex_of = share_vertices(w, soup, normals, *mesh);

  // Triangles in runs of one look and sidedness, in the order in which these first appear.
  struct Run {
    Surface surface;
    std::vector<uint32_t> triangles;
  };
  std::vector<Run> runs;
  std::map<std::pair<uint32_t, bool>, size_t> run_of;
  for (uint32_t t = 0; t < count; ++t) {
    const uint32_t look = soup.triangle_look.empty() ? 0 : soup.triangle_look[w.source[t]];
    const bool two_sided = both_sides[t];
    const auto [it, fresh] = run_of.try_emplace({look, two_sided}, runs.size());
    if (fresh) {
      runs.push_back({soup.triangle_look.empty() ? Surface{} : soup.looks[look], {}});
      runs.back().surface.two_sided = two_sided;
      if (mesh->uvs.empty()) runs.back().surface.texture = nullptr;
    }
    runs[it->second].triangles.push_back(t);
  }
  for (Run& run : runs) {
    run.surface.first = static_cast<uint32_t>(mesh->indices.size());
    run.surface.count = static_cast<uint32_t>(run.triangles.size() * 3);
    for (uint32_t t : run.triangles) {
      mesh->indices.push_back(vertex_of[3 * t]);
      mesh->indices.push_back(vertex_of[3 * t + (turned[t] ? 2 : 1)]);
      mesh->indices.push_back(vertex_of[3 * t + (turned[t] ? 1 : 2)]);
    }
    mesh->surfaces.push_back(run.surface);
  }
  return mesh;
}

}  // namespace lab::render
