// Small pictures kept in tests/golden: a change of looks must be meant. After a meant one, look at the new
// pictures and keep them with LAB_WRITE_GOLDEN=1 in the environment.
#include <gtest/gtest.h>

#include <cstdlib>

#include "render/markers.h"
#include "render/png.h"
#include "render/trace.h"
#include "tests/render/sample.h"
#include "tests/support/paths.h"

namespace lab::render {
namespace {

// Pixels with a channel that differs by more than 3 levels: other CPUs round the odd value differently.
int differing_pixels(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) return 1 << 30;
  int n = 0;
  for (size_t i = 0; i < a.rgb.size(); i += 3) {
    bool differs = false;
    for (int c = 0; c < 3; ++c) differs |= std::abs(a.rgb[i + c] - b.rgb[i + c]) > 3;
    n += differs;
  }
  return n;
}

constexpr int kCap = 160 * 120 / 200;  // half a per cent: samples on edges

void expect_golden(const Image& image, const std::string& name) {
  const std::string path = lab::source_path("tests/golden/render_") + name + ".png";
  if (std::getenv("LAB_WRITE_GOLDEN")) write_png(path, image);
  EXPECT_LE(differing_pixels(image, read_png(path).image), kCap) << name;
}

// Two earlier poses of the sample's arm, as ghosts, and the way of its tip.
Scene scene_with_a_past() {
  Scene scene = sample_scene();
  std::vector<Body> arm(scene.bodies.begin() + 2, scene.bodies.begin() + 4);
  std::vector<Eigen::Vector3d> way;
  std::vector<Eigen::Vector4f> speeds;
  for (int i = 0; i <= 20; ++i) {
    const double turn = -0.1 * i;
    way.push_back(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(.48, 0, .67));
    speeds.push_back(ramp_value(i / 20.0));
    if (i != 10 && i != 20) continue;
    std::vector<Body> then = arm;
    for (Body& body : then) body.pose = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * body.pose;
    for (Body& body : ghost(then, i, ramp_time(1 - i / 20.0), .5f)) scene.bodies.push_back(body);
  }
  scene.bodies.push_back(make_trace(way, speeds, .012));
  return scene;
}

TEST(Golden, PicturesLookAsTheyDid) {
  expect_golden(draw_sample(Quality::kDraft), "draft");
  expect_golden(draw_sample(Quality::kFine), "fine");
  const Scene past = scene_with_a_past();
  Renderer renderer(160, 120, Quality::kFine);
  expect_golden(renderer.draw(past, auto_frame(bounds(past), "iso", 160.0 / 120)), "ghosts_and_trace");
}

TEST(Golden, TheComparisonNoticesSmallChanges) {
  const Image image = draw_sample(Quality::kFine);
  Scene scene = sample_scene();
  const Camera camera = auto_frame(bounds(scene), "iso", 160.0 / 120);
  Renderer renderer(160, 120, Quality::kFine);
  EXPECT_EQ(differing_pixels(image, renderer.draw(scene, camera)), 0);
  Scene moved = scene;
  moved.bodies[2].pose.translation().y() += .01;  // one of five bodies by 1 cm
  EXPECT_GT(differing_pixels(image, renderer.draw(moved, camera)), kCap);
  Scene dimmed = scene;
  dimmed.light.strength = .9f;
  EXPECT_GT(differing_pixels(image, renderer.draw(dimmed, camera)), kCap);
  EXPECT_GT(differing_pixels(image, draw_sample(Quality::kLive)), kCap);  // the shadow is gone
}

}  // namespace
}  // namespace lab::render
