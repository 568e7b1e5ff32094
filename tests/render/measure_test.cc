// Depth and ids against geometry by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "render/markers.h"
#include "render/mesh/primitives.h"
#include "tests/render/sample.h"

namespace lab::render {
namespace {

using Eigen::Vector3d;

constexpr int kWidth = 160, kHeight = 120;
const Eigen::Vector4f kGrey(.5f, .5f, .5f, 1);

Body with_id(Body body, uint16_t id) {
  for (Part& part : body.parts) part.id = id;
  return body;
}

// The ray through a pixel's centre, from the textbook: where it starts, and a direction with a length of one
// along the line of sight, so that the parameter of a point on it is its depth.
struct Ray {
  Vector3d start, along;
};

Ray ray(const Camera& c, int x, int y) {
  const Vector3d forward = (c.target - c.eye).normalized();
  const Vector3d right = forward.cross(c.up).normalized(), top = right.cross(forward);
  const double high = c.height > 0 ? c.height : 2 * std::tan(c.fov / 2);  // at a depth of one
  const double u = (x + .5 - kWidth / 2.0) * high / kHeight, v = (kHeight / 2.0 - y - .5) * high / kHeight;
  if (c.height > 0) return {c.eye + u * right + v * top, forward};
  return {c.eye, forward + u * right + v * top};
}

// Depth at which a ray enters a ball; infinity if it passes by. `miss`: by how much, in radii.
double enters(const Ray& r, const Vector3d& centre, double radius, double& miss) {
  const Vector3d to = centre - r.start;
  const double a = r.along.squaredNorm(), b = r.along.dot(to) / a;
  const double off = (to - b * r.along).norm();
  miss = off / radius - 1;
  return off < radius ? b - std::sqrt((radius * radius - off * off) / a) : INFINITY;
}

Camera camera(bool orthographic) {
  Camera c;
  c.eye = {1.6, -1.9, 1.2};
  c.target = {.1, .1, .4};
  c.fov = .8;
  if (orthographic) c.height = 1.7;
  return c;
}

// Balls and a floor, pixel by pixel. A ball of 256 segments lies inside the true one by at most
// r (1 - cos(2 pi / 256 / sqrt 2)) = 1.5e-4 r, in the middle of a cell. Pixels within 2 % of the rim are left
// out: there the line of sight meets the surface at a cosine of at least 0.199, so the depth is off by 7.6e-4 r.
TEST(Measure, DepthAndIdsOfBallsAndFloor) {
  for (bool orthographic : {false, true}) {
    for (Quality quality : {Quality::kDraft, Quality::kFine}) {
      struct Ball {
        Vector3d at;
        double radius;
        uint16_t id;
      };
      const Ball balls[] = {{{0, 0, .5}, .3, 7}, {{.5, -.2, .25}, .2, 65535}, {{-.4, .6, .15}, .15, 1}};
      Scene scene;
      for (const Ball& b : balls)
        scene.bodies.push_back(with_id(sample_body("ball", make_sphere(b.radius, 256), b.at, kGrey), b.id));
      const Camera c = camera(orthographic);
      const Measurement m = Renderer(kWidth, kHeight, quality).measure(scene, c);
      ASSERT_EQ(m.depth.size(), static_cast<size_t>(kWidth) * kHeight);
      int on_ball = 0, on_floor = 0, on_sky = 0;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Ray r = ray(c, x, y);
          double depth = r.along.z() < 0 ? -r.start.z() / r.along.z() : INFINITY;
          if (depth > 14) continue;  // the floor's end is not far
          uint16_t id = 0;
          bool rim = false;
          for (const Ball& b : balls) {
            double miss;
            const double d = enters(r, b.at, b.radius, miss);
            rim |= std::abs(miss) < .02;
            if (d < depth) {
              depth = d;
              id = b.id;
            }
          }
          if (rim) continue;
          ASSERT_EQ(m.id[m.at(x, y)], id) << x << " " << y;
          ASSERT_NEAR(m.depth[m.at(x, y)], depth, 7.6e-4 * .3 + 1e-5 * depth) << x << " " << y;
          (id ? on_ball : on_floor) += 1;
        }
      }
      EXPECT_GT(on_ball, 1000);
      EXPECT_GT(on_floor, 4000);
      scene.ground.visible = false;
      const Measurement without = Renderer(kWidth, kHeight, quality).measure(scene, c);
      for (float d : without.depth) on_sky += std::isinf(d);
      EXPECT_GT(on_sky, 5000);
    }
  }
}

// The picture of an orthographic camera shows what is behind its eye too, here a ball and the lower part of the floor; it has no
// depth, and hides nothing. The ray's own depth as above; 1e-4 m about the eye's plane are left out.
TEST(Measure, WhatIsBehindAnOrthographicEyeHasNoDepth) {
  Camera c;
  c.eye = {1, 0, .4};
  c.target = {0, 0, 0};
  c.height = 3;
  Scene scene;
  scene.bodies.push_back(with_id(sample_body("ahead", make_sphere(.3, 256), {0, 0, .3}, kGrey), 7));
  scene.bodies.push_back(with_id(sample_body("behind", make_sphere(.4, 256), {2, 0, 1}, kGrey), 8));
  const Measurement m = Renderer(kWidth, kHeight).measure(scene, c);
  int ahead = 0, behind = 0, covered = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Ray r = ray(c, x, y);
      const double floor = -r.start.z() / r.along.z();
      double miss, passes;
      const double ball = enters(r, {0, 0, .3}, .3, miss), other = enters(r, {2, 0, 1}, .4, passes);
      if (floor > 5 || std::abs(floor) < 1e-4 || std::abs(miss) < .02 || std::abs(passes) < .02) continue;
      const double depth = std::min(ball, floor > 0 ? floor : INFINITY);
      ASSERT_EQ(m.id[m.at(x, y)], std::isfinite(ball) && ball == depth ? 7 : 0) << x << " " << y;
      if (std::isfinite(depth))
        ASSERT_NEAR(m.depth[m.at(x, y)], depth, 7.6e-4 * .3 + 1e-5 * (1 + depth)) << x << " " << y;
      else
        ASSERT_EQ(m.depth[m.at(x, y)], INFINITY) << x << " " << y;
      ahead += std::isfinite(ball);
      behind += floor < 0;
      covered += std::isfinite(ball) && std::isfinite(other);
    }
  }
  EXPECT_GT(ahead, 300);
  EXPECT_GT(behind, 1000);
  EXPECT_GT(covered, 50);
}

// The silhouette's area: pixels of the id against a fine count of rays that meet the ball.
TEST(Measure, SilhouetteOfABall) {
  Scene scene;
  scene.ground.visible = false;
  scene.bodies.push_back(with_id(sample_body("ball", make_sphere(.3, 256), {0, 0, .5}, kGrey), 3));
  const Camera c = camera(false);
  const Measurement m = Renderer(kWidth, kHeight).measure(scene, c);
  int seen = 0, expected = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double miss;
      seen += m.id[m.at(x, y)] == 3;
      expected += std::isfinite(enters(ray(c, x, y), {0, 0, .5}, .3, miss));
    }
  }
  // A polygon of 256 corners lacks 1e-4 of the disk's area: less than one pixel of about 900.
  EXPECT_NEAR(seen, expected, 4);
  EXPECT_GT(expected, 800);
}

TEST(Measure, OriginsProjectOntoTheirOwnIds) {
  Scene scene;
  std::vector<Vector3d> places;
  for (int i = 0; i < 12; ++i) {
    const double a = 2 * M_PI * i / 12;
    places.push_back({.6 * std::cos(a), .6 * std::sin(a), .1 + .07 * i});
    scene.bodies.push_back(with_id(sample_body("box", make_box({.08, .1, .06}), places.back(), kGrey),
                                   static_cast<uint16_t>(100 + i)));
    scene.bodies.back().pose.linear() =
        Eigen::AngleAxisd(a, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  }
  for (const std::string& view : view_names()) {
    View v = view_from_name(view);
    for (bool orthographic : {false, true}) {
      v.orthographic = orthographic;
      const Camera c = auto_frame(bounds(scene), v, double(kWidth) / kHeight);
      const Measurement m = Renderer(kWidth, kHeight).measure(scene, c);
      int met = 0;
      for (int i = 0; i < 12; ++i) {
        const Vector3d p = c.pixel(places[i], kWidth, kHeight);
        const size_t at = m.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
        // Either itself, or what stands before it and so is nearer than it.
        if (m.id[at] == 100 + i) {
          ++met;
          EXPECT_NEAR(m.depth[at], p.z(), .09);
        } else {
          EXPECT_LT(m.depth[at], p.z());
        }
      }
      EXPECT_GE(met, 8) << view;
    }
  }
}

TEST(Measure, AnnotationsAreNotMeasuredAndGlassIs) {
  Scene scene;
  scene.bodies.push_back(with_id(sample_body("box", make_box({.3, .3, .3}), {0, 0, .5}, kGrey), 9));
  const Camera c = camera(false);
  Renderer renderer(kWidth, kHeight, Quality::kDraft);
  const Measurement plain = renderer.measure(scene, c);
  const Image picture = renderer.draw(scene, c);
  scene.bodies.push_back(make_bead({.8, -.9, .8}, .2, {1, 0, 0, 1}));
  EXPECT_EQ(renderer.measure(scene, c).depth, plain.depth);
  EXPECT_EQ(renderer.measure(scene, c).id, plain.id);
  EXPECT_NE(renderer.draw(scene, c).rgb, picture.rgb) << "but it is in the picture";
  scene.bodies.pop_back();
  scene.bodies[0].opacity = .3f;
  EXPECT_EQ(renderer.measure(scene, c).id, plain.id);
}

TEST(Measure, Quantized) {
  EXPECT_EQ(quantized({1.2344f, 0.f, INFINITY, 65.535f, 65.6f, -1.f, NAN}),
            (std::vector<uint16_t>{1234, 0, 0, 65535, 0, 0, 0}));
  EXPECT_EQ(quantized({1.f}, 0.0001), std::vector<uint16_t>{10000});
  EXPECT_THROW(quantized({1.f}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace lab::render
