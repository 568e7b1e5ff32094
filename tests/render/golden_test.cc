// Small pictures kept in tests/golden: a change of looks must be meant. After a meant one, look at the new
// pictures and keep them with LAB_WRITE_GOLDEN=1 in the environment.
#include <gtest/gtest.h>

#include <cstdlib>

#include "render/png.h"
#include "tests/render/sample.h"

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

TEST(Golden, PicturesLookAsTheyDid) {
  for (const auto& [quality, name] :
       {std::pair(Quality::kDraft, "draft"), std::pair(Quality::kFine, "fine")}) {
    const std::string path = std::string(LAB_GOLDEN "/render_") + name + ".png";
    const Image image = draw_sample(quality);
    if (std::getenv("LAB_WRITE_GOLDEN")) write_png(path, image);
    EXPECT_LE(differing_pixels(image, read_png(path).image), kCap) << name;
  }
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
