#include "render/trace.h"

#include <cmath>
#include <stdexcept>

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4f;

constexpr uint32_t kSides = 10;

void need(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

MeshPtr finished(Mesh mesh) {
  Surface all;
  all.count = static_cast<uint32_t>(mesh.indices.size());
  all.rgba.setOnes();
  all.coloured = all.two_sided = true;  // sharp bends may fold
  mesh.surfaces.push_back(all);
  return std::make_shared<Mesh>(std::move(mesh));
}

}  // namespace

Trace::Trace(double radius, size_t piece_rings) : radius_(radius), piece_rings_(piece_rings) {
  need(radius > 0 && std::isfinite(radius), "trace: the radius must be positive and finite");
}

void Trace::add_ring(const Vector3d& centre, const Vector3d& lean, double radius, const Vector4f& colour) {
  for (uint32_t i = 0; i < kSides; ++i) {
    const double a = 2 * M_PI * i / kSides;
    const Vector3d out = std::cos(a) * x_ + std::sin(a) * y_;
    const Vector3d p = centre + radius * out;
    open_.positions.push_back(p.cast<float>());
    open_.normals.push_back((out + lean).normalized().cast<float>());
    open_.colours.push_back(colour);
    open_.bounds.extend(p);
  }
  const uint32_t here = static_cast<uint32_t>(open_.positions.size()) - kSides;
  for (uint32_t i = 0; here > 0 && i < kSides; ++i) {
    const uint32_t j = (i + 1) % kSides, before = here - kSides;
    open_.indices.insert(open_.indices.end(),
                         {before + i, before + j, here + i, before + j, here + j, here + i});
  }
}

// Round ends: the same rings, shrinking to a point.
void Trace::add_cap(const Point& point, const Vector3d& outwards, bool start) {
  for (int k = 0; k < 4; ++k) {
    const double a = M_PI / 2 * (start ? 4 - k : k + 1) / 4;  // 0 at the rim, pi/2 at the tip
    const double r = k == (start ? 0 : 3) ? 1e-3 : std::cos(a);
    add_ring(point.at + radius_ * std::sin(a) * outwards, std::tan(std::min(a, 1.5)) * outwards, r * radius_,
             point.colour);
  }
}

// The ring of a point from which the tube goes on in direction `from` (0: it ends), in the plane that halves the bend.
void Trace::add_point_rings(const Point& point, const Vector3d& from) {
  const bool end = from.isZero(0);
  Vector3d ahead = into_ + from;
  if (ahead.norm() < 1e-3) ahead = first_ ? from : into_;  // it turns back on itself
  ahead.normalize();
  if (first_) x_ = ahead.unitOrthogonal();
  x_ = (x_ - x_.dot(ahead) * ahead);
  x_ = x_.norm() > 1e-6 ? Vector3d(x_.normalized()) : Vector3d(ahead.unitOrthogonal());
  y_ = ahead.cross(x_);
  if (first_) add_cap(point, -ahead, true);
  add_ring(point.at, Vector3d::Zero(), radius_, point.colour);
  if (end) add_cap(point, ahead, false);
}

// The next piece begins with the ring that the finished one ends with.
void Trace::start_next_piece() {
  Mesh next;
  for (size_t i = open_.positions.size() - kSides; i < open_.positions.size(); ++i) {
    next.positions.push_back(open_.positions[i]);
    next.normals.push_back(open_.normals[i]);
    next.colours.push_back(open_.colours[i]);
    next.bounds.extend(open_.positions[i].cast<double>());
  }
  pieces_.push_back(finished(std::move(open_)));
  open_ = std::move(next);
}

void Trace::add(const Vector3d& point, const Vector4f& colour) {
  need(point.allFinite(), "trace: a point is not finite");
  if (!last_) {
    last_ = {point, colour};
    return;
  }
  if (!((point - last_->at).norm() > 0.05 * radius_)) return;
  const Vector3d from = (point - last_->at).normalized();
  add_point_rings(*last_, from);
  if (piece_rings_ > 0 && open_.positions.size() > piece_rings_ * kSides) start_next_piece();
  last_ = {point, colour};
  into_ = from;
  first_ = false;
}

Body Trace::body() const {
  Body body;
  body.name = "trace";
  body.annotation = true;
  if (!last_ || first_) return body;
  Trace ended = *this;
  ended.add_point_rings(*last_, Vector3d::Zero());
  ended.pieces_.push_back(finished(std::move(ended.open_)));
  for (const MeshPtr& piece : ended.pieces_) body.parts.emplace_back().mesh = piece;
  return body;
}

Body make_trace(const std::vector<Vector3d>& points, const std::vector<Vector4f>& colours, double radius) {
  need(colours.size() == points.size() || colours.size() == 1,
       "trace: one colour for each point, or one for all");
  Trace trace(radius, 0);
  for (size_t i = 0; i < points.size(); ++i)
    trace.add(points[i], colours.size() == 1 ? colours[0] : colours[i]);
  return trace.body();
}

}  // namespace lab::render
