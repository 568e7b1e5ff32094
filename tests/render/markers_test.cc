#include "render/markers.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/trace.h"
#include "tests/render/sample.h"

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4f;

const Vector4f kRed(.9f, .05f, .05f, 1), kBlue(.05f, .05f, .9f, 1);
bool red(const uint8_t* p) { return p[0] > 60 && p[0] > 2 * p[1] && p[0] > 2 * p[2]; }
bool blue(const uint8_t* p) { return p[2] > 60 && p[2] > 2 * p[0] && p[2] > 2 * p[1]; }

double volume(const Mesh& m) {
  double v = 0;
  for (size_t i = 0; i < m.indices.size(); i += 3) {
    const auto p = [&](size_t k) { return Vector3d(m.positions[m.indices[i + k]].cast<double>()); };
    v += p(0).dot(p(1).cross(p(2))) / 6;
  }
  return v;
}

TEST(Markers, TraceIsATubeAlongItsPoints) {
  std::vector<Vector3d> points;
  double length = 0;
  for (int i = 0; i <= 400; ++i) {  // a helix
    const double a = .02 * i;
    const Vector3d p(std::cos(a), std::sin(a), .1 * a);
    if (i > 0) length += (p - points.back()).norm();
    points.insert(points.end(), i % 7 == 0 ? 3 : 1, p);  // standing still now and then
  }
  const double r = .02;
  const Body body = make_trace(points, {kRed}, r);
  ASSERT_EQ(body.parts.size(), 1u);
  EXPECT_TRUE(body.annotation);
  const Mesh& mesh = *body.parts[0].mesh;
  for (const auto& p : mesh.positions) {  // no point farther from the path than the radius
    double least = 1e9;
    for (const Vector3d& q : points) least = std::min(least, (p.cast<double>() - q).norm());
    ASSERT_LT(least, r * 1.001);
  }
  // Ten sides: 10/2 sin(2 pi/10) r^2 across; the round ends add less than a ball's volume.
  const double across = 5 * std::sin(2 * M_PI / 10) * r * r;
  EXPECT_NEAR(volume(mesh), across * length, 5 * r * r * r + .01 * across * length);
  for (const auto& n : mesh.normals) ASSERT_NEAR(n.norm(), 1, 1e-5);
}

// A trace in pieces has the triangles of one in a single mesh.
TEST(Markers, ATraceInPiecesIsTheSameTube) {
  std::vector<Vector3d> points;
  for (int i = 0; i <= 400; ++i) points.emplace_back(std::cos(.02 * i), std::sin(.02 * i), .002 * i);
  const double r = .02;
  Trace growing(r);
  for (const Vector3d& p : points) growing.add(p, kRed);
  const Body pieces = growing.body(), whole = make_trace(points, {kRed}, r);
  EXPECT_GT(pieces.parts.size(), 5u);
  const auto triangles = [](const Body& body) {
    std::vector<std::array<float, 9>> all;
    for (const Part& part : body.parts)
      for (size_t i = 0; i < part.mesh->indices.size(); i += 3) {
        std::array<float, 9> t;
        for (size_t k = 0; k < 9; ++k) t[k] = part.mesh->positions[part.mesh->indices[i + k / 3]][k % 3];
        all.push_back(t);
      }
    return all;
  };
  EXPECT_EQ(triangles(pieces), triangles(whole));
}

TEST(Markers, TraceColoursRunAlongIt) {
  Scene scene;
  scene.ground.visible = false;
  scene.bodies.push_back(make_trace({{0, -.5, 0}, {0, .5, 0}}, {kRed, kBlue}, .05));
  Camera camera;
  camera.eye = {2, 0, 0};
  camera.target = {0, 0, 0};
  const Image image = Renderer(200, 100).draw(scene, camera);
  const auto at = [&](double y) {
    const Vector3d p = camera.pixel({.05, y, 0}, 200, 100);
    return image.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
  };
  EXPECT_TRUE(red(at(-.45)));
  EXPECT_TRUE(blue(at(.45)));
  EXPECT_FALSE(red(at(0)) || blue(at(0))) << "half way it is neither";
}

TEST(Markers, NothingToDrawAndNonsense) {
  EXPECT_TRUE(make_trace({}, {kRed}, .1).parts.empty());
  EXPECT_TRUE(make_trace({{1, 2, 3}, {1, 2, 3}}, {kRed}, .1).parts.empty());
  EXPECT_TRUE(make_arrow({0, 0, 0}, {0, 0, 0}, .1, kRed).parts.empty());
  EXPECT_FALSE(make_trace({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, {kRed}, .1).parts.empty()) << "there and back";
  EXPECT_THROW(make_trace({{0, 0, 0}, {NAN, 0, 0}}, {kRed}, .1), std::invalid_argument);
  EXPECT_THROW(make_trace({{0, 0, 0}, {1, 0, 0}}, {kRed}, 0), std::invalid_argument);
  EXPECT_THROW(make_trace({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {kRed, kBlue}, .1), std::invalid_argument);
  EXPECT_THROW(make_arrow({0, 0, 0}, {0, INFINITY, 0}, .1, kRed), std::invalid_argument);
  EXPECT_THROW(make_axes(Eigen::Isometry3d::Identity(), -1), std::invalid_argument);
  EXPECT_THROW(make_com({0, 0, 0}, 0), std::invalid_argument);
}

TEST(Markers, ArrowsReachFromTailToTip) {
  for (const Vector3d& v : {Vector3d(.4, -.2, .6), Vector3d(0, 0, -1), Vector3d(.001, 0, 0)}) {
    const Vector3d tail(.3, .1, -.2);
    const Body body = make_arrow(tail, v, .01, kRed);
    double low = 1e9, high = -1e9;
    for (const Part& part : body.parts) {
      for (const auto& p : part.mesh->positions) {
        const Vector3d w = body.pose * (part.pose * part.scale.cwiseProduct(p.cast<double>()));
        const double along = (w - tail).dot(v.normalized());
        low = std::min(low, along);
        high = std::max(high, along);
        EXPECT_LT(((w - tail) - along * v.normalized()).norm(), .0241);
      }
    }
    EXPECT_NEAR(low, 0, 1e-6);
    EXPECT_NEAR(high, v.norm(), 1e-6);
  }
}

TEST(Markers, ComIsABallOfEighths) {
  const Mesh& ball = *make_com({0, 0, 0}, 1).parts[0].mesh;
  // 8 x 144 triangles inscribed in the ball: a few per cent are missing.
  EXPECT_NEAR(volume(ball), 4. / 3 * M_PI, .05);
  EXPECT_LT(volume(ball), 4. / 3 * M_PI);
  for (size_t i = 0; i < ball.positions.size(); ++i) {
    const float side = ball.positions[i].prod();
    if (std::abs(side) > 1e-3f) {
      EXPECT_EQ(ball.colours[i][0] < .5f, side < 0);
    }
  }
}

TEST(Markers, RampsRunAndClamp) {
  EXPECT_EQ(ramp_time(-1), ramp_time(0));
  EXPECT_EQ(ramp_time(2), ramp_time(1));
  EXPECT_EQ(ramp_value(NAN), ramp_value(0));
  EXPECT_GT(ramp_time(0)[2], ramp_time(0)[0]);  // blue first
  EXPECT_GT(ramp_time(1)[0], ramp_time(1)[2]);  // red last
  const auto grey = [](const Vector4f& c) { return .3f * c[0] + .59f * c[1] + .11f * c[2]; };
  for (double t = 0; t < 1; t += .05) EXPECT_LT(grey(ramp_value(t)), grey(ramp_value(t + .05)));
}

}  // namespace
}  // namespace lab::render
