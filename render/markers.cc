#include "render/markers.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "render/mesh/primitives.h"

namespace lab::render {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector4f;

void need(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

bool positive(double x) { return x > 0 && std::isfinite(x); }

Body annotation(const char* name) {
  Body body;
  body.name = name;
  body.annotation = true;
  return body;
}

// The shortest rotation that takes the z axis to the direction of `z`. (Eigen's FromTwoVectors does the same; its singular
// value decomposition takes as long to compile as the rest of this file.)
Matrix3d turn_z_to(const Vector3d& z) {
  const Vector3d to = z.normalized();
  if (to.z() < -1 + 1e-12) return Vector3d(1, -1, -1).asDiagonal();  // half a turn about x
  const double s = std::sqrt((1 + to.z()) * 2);                      // 2 cos(angle / 2)
  const Vector3d axis = Vector3d::UnitZ().cross(to) / s;
  return Eigen::Quaterniond(s / 2, axis.x(), axis.y(), axis.z()).toRotationMatrix();
}

// The frame at `origin` whose z axis has the direction of `z`; x and y are arbitrary.
Isometry3d along(const Vector3d& origin, const Vector3d& z) {
  Isometry3d frame = Isometry3d::Identity();
  frame.linear() = turn_z_to(z);
  frame.translation() = origin;
  return frame;
}

// Meshes that all markers of all scenes share: uploaded once, sized by Part::scale.
MeshPtr unit_cylinder() {
  static const MeshPtr mesh = make_cylinder(1, 1, 20);
  return mesh;
}
MeshPtr unit_ball() {
  static const MeshPtr mesh = make_sphere(1, 28);
  return mesh;
}
MeshPtr unit_cone() {
  static const MeshPtr mesh = make_cone(1, 1, 28);
  return mesh;
}

// A ball of black and white eighths: each eighth a part of its own would draw the same ball eight times, so
// the colours sit on the vertices, which are doubled along the three great circles.
MeshPtr com_ball() {
  static const MeshPtr mesh = [] {
    auto ball = std::make_shared<Mesh>();
    const int n = 12;  // steps along each edge of an eighth
    for (int octant = 0; octant < 8; ++octant) {
      const Vector3d sign(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
      const bool black = sign.prod() < 0, turn = black;
      const Vector4f colour = black ? Vector4f(.06f, .06f, .07f, 1) : Vector4f(.96f, .96f, .96f, 1);
      const auto vertex = [&](int i, int j) {  // barycentric steps, pushed out to the sphere
        const Vector3d p = Vector3d(i, j, n - i - j).normalized().cwiseProduct(sign);
        ball->positions.push_back(p.cast<float>());
        ball->normals.push_back(p.cast<float>());
        ball->colours.push_back(colour);
        return static_cast<uint32_t>(ball->positions.size() - 1);
      };
      std::vector<std::vector<uint32_t>> at(n + 1);
      for (int i = 0; i <= n; ++i)
        for (int j = 0; i + j <= n; ++j) at[i].push_back(vertex(i, j));
      const auto triangle = [&](uint32_t a, uint32_t b, uint32_t c) {
        if (turn) std::swap(b, c);  // mirrored an odd number of times
        ball->indices.insert(ball->indices.end(), {a, b, c});
      };
      for (int i = 0; i < n; ++i) {
        for (int j = 0; i + j < n; ++j) {
          triangle(at[i][j], at[i + 1][j], at[i][j + 1]);
          if (i + j < n - 1) triangle(at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]);
        }
      }
    }
    ball->bounds = Bounds(Vector3d::Constant(-1), Vector3d::Constant(1));
    Surface all;
    all.count = static_cast<uint32_t>(ball->indices.size());
    all.rgba.setOnes();
    all.coloured = true;
    ball->surfaces.push_back(all);
    return ball;
  }();
  return mesh;
}

void add_arrow(Body& body, const Vector3d& tail, const Vector3d& vector, double radius,
               const Vector4f& rgba) {
  const double length = vector.norm();
  if (length == 0) return;
  const double head = std::min(6 * radius, length), wide = 2.4 * radius * head / (6 * radius);
  const Vector3d z = vector / length;
  Part part;
  part.rgba = rgba;
  if (length > head) {
    part.mesh = unit_cylinder();
    part.pose = along(tail + z * (length - head) / 2, z);
    part.scale = {radius, radius, length - head};
    body.parts.push_back(part);
  }
  part.mesh = unit_cone();
  part.pose = along(tail + z * (length - head), z);
  part.scale = {wide, wide, head};
  body.parts.push_back(part);
}

Vector4f mix(const std::vector<Vector4f>& stops, double t) {
  const double last = static_cast<double>(stops.size() - 1);
  const double place = t > 0 ? std::min(t, 1.0) * last : 0;  // NaN goes to the first
  const size_t i = std::min(static_cast<size_t>(place), stops.size() - 2);
  const float part = static_cast<float>(place - static_cast<double>(i));
  return stops[i] + part * (stops[i + 1] - stops[i]);
}

}  // namespace

Body make_bead(const Vector3d& at, double radius, const Vector4f& rgba) {
  need(positive(radius) && at.allFinite(), "bead: place and radius must be finite, the radius positive");
  Body body = annotation("bead");
  body.pose.translation() = at;
  Part& ball = body.parts.emplace_back();
  ball.mesh = unit_ball();
  ball.scale.setConstant(radius);
  ball.rgba = rgba;
  return body;
}

Body make_arrow(const Vector3d& tail, const Vector3d& vector, double radius, const Vector4f& rgba) {
  need(positive(radius) && tail.allFinite() && vector.allFinite(),
       "arrow: tail, vector and radius must be finite, the radius positive");
  Body body = annotation("arrow");
  add_arrow(body, tail, vector, radius, rgba);
  return body;
}

Body make_axes(const Isometry3d& frame, double length) {
  need(positive(length), "axes: the length must be positive and finite");
  Body body = annotation("axes");
  body.pose = frame;
  const Vector4f colours[3] = {{.86f, .18f, .15f, 1}, {.20f, .66f, .25f, 1}, {.18f, .38f, .90f, 1}};
  for (int axis = 0; axis < 3; ++axis)
    add_arrow(body, Vector3d::Zero(), length * Vector3d::Unit(axis), 0.03 * length, colours[axis]);
  return body;
}

Body make_com(const Vector3d& at, double radius) {
  Body body = make_bead(at, radius, Vector4f::Ones());
  body.name = "com";
  body.parts[0].mesh = com_ball();
  return body;
}

Vector4f ramp_time(double t) {
  static const std::vector<Vector4f> stops{
      {.13f, .45f, .93f, 1}, {.33f, .34f, .80f, 1}, {.55f, .33f, .58f, 1}, {.90f, .32f, .24f, 1}};
  return mix(stops, t);
}

// Stops close to the familiar perceptual scale from violet to yellow.
Vector4f ramp_value(double t) {
  static const std::vector<Vector4f> stops{{.27f, .02f, .35f, 1},
                                           {.23f, .32f, .55f, 1},
                                           {.13f, .57f, .55f, 1},
                                           {.37f, .79f, .38f, 1},
                                           {.99f, .91f, .15f, 1}};
  return mix(stops, t);
}

}  // namespace lab::render
