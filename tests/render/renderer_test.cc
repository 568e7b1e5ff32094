#include "render/renderer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <thread>

#include "render/mesh/primitives.h"
#include "tests/render/sample.h"
#include "tests/support/paths.h"

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4f;

constexpr int kWidth = 240, kHeight = 180;
const Vector4f kRed(.9f, .05f, .05f, 1), kBlue(.05f, .05f, .9f, 1), kWhite(.9f, .9f, .9f, 1);

bool red(const uint8_t* p) { return p[0] > 60 && p[0] > 2 * p[1] && p[0] > 2 * p[2]; }
bool blue(const uint8_t* p) { return p[2] > 60 && p[2] > 2 * p[0] && p[2] > 2 * p[1]; }

Scene bare() {  // no floor: its red axis is not to be taken for a body
  Scene scene;
  scene.ground.visible = false;
  return scene;
}

Image draw(const Scene& scene, const Camera& camera, Quality quality = Quality::kLive) {
  return Renderer(kWidth, kHeight, quality).draw(scene, camera);
}

// Mean position of the pixels that `is` accepts (pixel centres at .5), and their number.
std::array<double, 3> centroid(const Image& image, bool (*is)(const uint8_t*)) {
  double x = 0, y = 0, n = 0;
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column)
      if (is(image.at(column, row))) {
        x += column + .5;
        y += row + .5;
        n += 1;
      }
  return {x / n, y / n, n};
}

// The pinhole camera once more, from the textbook and without the library: angles of the ray in a frame made
// of the line of sight. Returns the pixel of a world point.
Eigen::Vector2d textbook_pixel(const Camera& c, const Vector3d& point) {
  const Vector3d forward = (c.target - c.eye).normalized();
  const Vector3d right = forward.cross(c.up).normalized();
  const Vector3d top = right.cross(forward);
  const Vector3d d = point - c.eye;
  const double focal = kHeight / 2.0 / std::tan(c.fov / 2);  // in pixels
  return {kWidth / 2.0 + focal * d.dot(right) / d.dot(forward),
          kHeight / 2.0 - focal * d.dot(top) / d.dot(forward)};
}

TEST(Renderer, SmallBallsLandOnTheirPixels) {
  Camera camera;
  camera.eye = {1.7, -2.1, 1.3};
  camera.target = {.1, .2, .4};
  camera.fov = 0.75;
  for (Quality quality : {Quality::kDraft, Quality::kLive, Quality::kFine}) {
    Renderer renderer(kWidth, kHeight, quality);
    for (const Vector3d& at :
         {Vector3d(0, 0, 0), Vector3d(.5, .3, .2), Vector3d(-.6, .5, .9), Vector3d(.4, -.5, 1.0)}) {
      Scene scene = bare();
      scene.bodies.push_back(sample_body("ball", make_sphere(.035), at, kRed));
      const auto [x, y, n] = centroid(renderer.draw(scene, camera), red);
      const Eigen::Vector2d expected = textbook_pixel(camera, at);
      // The ball is about 3 pixels in radius: rounding of its rim moves the centre by well under half a
      // pixel.
      EXPECT_GT(n, 12);
      EXPECT_NEAR(x, expected.x(), 0.4);
      EXPECT_NEAR(y, expected.y(), 0.4);
    }
  }
}

TEST(Renderer, PosesScalesAndNestingApply) {
  // A unit box, scaled, placed in its body, placed in the world: all eight corners of its silhouette.
  Scene scene = bare();
  Body body = sample_body("box", make_box({1, 1, 1}), {.2, .1, .5}, kRed);
  body.pose.linear() = Eigen::AngleAxisd(.6, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  body.parts[0].scale = {.3, .5, .7};
  body.parts[0].pose.translation() = Vector3d(.1, -.2, .05);
  body.parts[0].pose.linear() = Eigen::AngleAxisd(-.4, Vector3d::UnitX()).toRotationMatrix();
  scene.bodies.push_back(body);
  Camera camera;
  camera.eye = {2, -1.5, 1.4};
  camera.target = {.2, 0, .5};
  const Image image = draw(scene, camera);
  Eigen::AlignedBox2d expected, seen;
  for (int i = 0; i < 8; ++i) {
    Vector3d corner(i & 1 ? .5 : -.5, i & 2 ? .5 : -.5, i & 4 ? .5 : -.5);
    corner = corner.cwiseProduct(Vector3d(.3, .5, .7));
    corner = body.parts[0].pose.linear() * corner + body.parts[0].pose.translation();
    expected.extend(textbook_pixel(camera, body.pose.linear() * corner + body.pose.translation()));
  }
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (red(image.at(x, y))) {
        seen.extend(Eigen::Vector2d(x, y));
        seen.extend(Eigen::Vector2d(x + 1, y + 1));
      }
  EXPECT_LT((seen.min() - expected.min()).cwiseAbs().maxCoeff(),
            1.5);  // a tip thinner than half a pixel is not "red"
  EXPECT_LT((seen.max() - expected.max()).cwiseAbs().maxCoeff(), 1.5);
}

TEST(Renderer, TheNearerOneHidesTheOther) {
  for (double side : {1.0, -1.0}) {
    for (bool red_first : {true, false}) {  // never the order of drawing
      Scene scene = bare();
      const Body r = sample_body("red", make_box({.1, .4, .4}), {.3, 0, 0}, kRed);
      const Body b = sample_body("blue", make_box({.1, .4, .4}), {-.3, 0, 0}, kBlue);
      scene.bodies = red_first ? std::vector<Body>{r, b} : std::vector<Body>{b, r};
      Camera camera;
      camera.eye = {2 * side, 0, 0};
      camera.target = {0, 0, 0};
      const Image image = draw(scene, camera);
      EXPECT_EQ(red(image.at(kWidth / 2, kHeight / 2)), side > 0);
      EXPECT_EQ(blue(image.at(kWidth / 2, kHeight / 2)), side < 0);
    }
  }
}

TEST(Renderer, CrossingBodiesAreResolvedPerPixel) {
  Scene scene = bare();  // two thin plates crossing in the middle like an X seen from above
  for (double angle : {.7, -.7}) {
    scene.bodies.push_back(sample_body("plate", make_box({1, .01, .5}), {0, 0, 0}, angle > 0 ? kRed : kBlue));
    scene.bodies.back().pose.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
  }
  Camera camera;
  camera.eye = {0, -2, 0};
  camera.target = {0, 0, 0};
  const Image image = draw(scene, camera);
  // At angle +0.7 the plate's left half comes towards the eye (at -y), its right half goes away.
  EXPECT_TRUE(red(image.at(kWidth / 2 - 20, kHeight / 2)));
  EXPECT_TRUE(blue(image.at(kWidth / 2 + 20, kHeight / 2)));
}

TEST(Renderer, FloorHidesWhatIsBelowIt) {
  Scene scene;
  scene.bodies.push_back(sample_body("ball", make_sphere(.2), {0, 0, -.5}, kBlue));
  Camera camera;
  camera.eye = {0, -2, 2};
  camera.target = {0, 0, 0};
  for (Quality quality : {Quality::kDraft, Quality::kLive}) {
    scene.ground.visible = true;
    EXPECT_EQ(centroid(draw(scene, camera, quality), blue)[2], 0);
    scene.ground.visible = false;
    EXPECT_GT(centroid(draw(scene, camera, quality), blue)[2], 100);
  }
}

// A mirrored part must look as a mesh whose own points are mirrored (and not inside out).
TEST(Renderer, MirroringScale) {
  const MeshPtr cone = [] {
    Soup soup;  // an irregular tetrahedron
    soup.positions = {{-.2f, -.1f, -.3f}, {.4f, -.1f, -.3f}, {0, .5f, -.2f}, {.1f, .1f, .5f}};
    soup.indices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    return make_mesh(soup);
  }();
  Soup soup;
  soup.positions = cone->positions;
  soup.indices = cone->indices;
  for (auto& p : soup.positions) p.x() = -p.x();
  Scene one = bare(), other = bare();
  one.bodies.push_back(sample_body("scaled", cone, {0, 0, .4}, kWhite));
  one.bodies[0].parts[0].scale = {-1, 1, 1};
  other.bodies.push_back(sample_body("made", make_mesh(soup), {0, 0, .4}, kWhite));
  const Camera camera = auto_frame(bounds(other));
  const Image a = draw(one, camera, Quality::kFine), b = draw(other, camera, Quality::kFine);
  int differing = 0;
  for (size_t i = 0; i < a.rgb.size(); ++i) differing += std::abs(a.rgb[i] - b.rgb[i]) > 3;
  EXPECT_LT(differing, 30);  // of 129600; some samples on edges fall to the other side
  one.bodies[0].parts[0].scale = {1, 1, 1};
  const Image c = draw(one, camera, Quality::kFine);
  differing = 0;
  for (size_t i = 0; i < a.rgb.size(); ++i) differing += std::abs(c.rgb[i] - b.rgb[i]) > 3;
  EXPECT_GT(differing, 3000);  // the test can fail
}

TEST(Renderer, ShadowFallsWhereTheSunSaysSo) {
  Scene scene;
  const Vector3d at(0, 0, .8);
  scene.bodies.push_back(sample_body("ball", make_sphere(.15), at, kWhite));
  Camera camera;
  camera.eye = {0, -2.5, 2.5};
  camera.target = {0, 0, .2};
  for (const Vector3d& sun : {Vector3d(0.5, -.3, 1), Vector3d(-1, .5, 1.2)}) {
    scene.light.towards = 3 * sun;
    scene.bodies[0].casts_shadow = true;
    const Image with = draw(scene, camera, Quality::kFine);
    scene.bodies[0].casts_shadow = false;
    const Image without = draw(scene, camera, Quality::kFine);
    // By hand: the ray through the ball's centre meets z = 0 here.
    const Eigen::Vector2d spot = textbook_pixel(camera, at - sun * (at.z() / sun.z()));
    const int x = static_cast<int>(spot.x()), y = static_cast<int>(spot.y());
    EXPECT_LT(with.at(x, y)[1], 0.75 * without.at(x, y)[1]);
    const Eigen::Vector2d free = textbook_pixel(camera, at - sun * (at.z() / sun.z()) + Vector3d(.45, 0, 0));
    const int fx = static_cast<int>(free.x()), fy = static_cast<int>(free.y());
    EXPECT_EQ(with.at(fx, fy)[1], without.at(fx, fy)[1]);
  }
}

TEST(Renderer, NoSurfaceShadesItself) {
  // A ball alone and without a floor, under the sun: its lit half must look the same with and without a
  // shadow map.
  Scene scene = bare();
  scene.bodies.push_back(sample_body("ball", make_sphere(.5, 96), {0, 0, 0}, kWhite));
  scene.light.towards = {0, -1, .6};
  Camera camera;
  camera.eye = {0, -2, 1.2};
  camera.target = {0, 0, 0};
  const Image fine = draw(scene, camera, Quality::kFine), live = draw(scene, camera, Quality::kLive);
  int differing = 0;
  for (size_t i = 0; i < fine.rgb.size(); ++i) differing += std::abs(fine.rgb[i] - live.rgb[i]) > 3;
  EXPECT_LT(differing, 200);  // the ball covers about 10000 pixels, 30000 values
}

TEST(Renderer, GlassShowsWhatIsBehind) {
  Scene scene = bare();
  scene.bodies.push_back(sample_body("glass", make_box({.1, .5, .5}), {.5, 0, 0}, {.05f, .05f, .9f, .5f}));
  scene.bodies.push_back(sample_body("red", make_box({.1, .5, .5}), {-.5, 0, 0}, kRed));
  Camera camera;
  camera.eye = {3, 0, 0};
  camera.target = {0, 0, 0};
  for (Quality quality : {Quality::kDraft, Quality::kFine}) {
    const Image both = draw(scene, camera, quality);
    scene.bodies[0].visible = false;
    const Image behind = draw(scene, camera, quality);
    scene.bodies[0].visible = true;
    scene.bodies[0].parts[0].rgba[3] = 1;
    const Image front = draw(scene, camera, quality);
    scene.bodies[0].parts[0].rgba[3] = .5f;
    const uint8_t *m = both.at(kWidth / 2, kHeight / 2), *b = behind.at(kWidth / 2, kHeight / 2),
                  *f = front.at(kWidth / 2, kHeight / 2);
    // In fine, the glass' shadow falls on what is behind it as well.
    const double tolerance = quality == Quality::kDraft ? 2.0 : 256.0;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(m[c], (b[c] + f[c]) / 2.0, tolerance);
    EXPECT_GT(m[2], b[2] + 20);
    EXPECT_GT(m[0], f[0] + 10);
  }
}

TEST(Renderer, MaterialsKeepTheirColourUnlessRepainted) {
  Soup soup;
  const MeshPtr box = make_box({.5, .5, .5});
  soup.positions = box->positions;
  soup.indices = box->indices;
  soup.looks.resize(1);
  soup.looks[0].coloured = true;
  soup.looks[0].rgba = kBlue;
  soup.triangle_look.assign(12, 0);
  Scene scene = bare();
  scene.bodies.push_back(sample_body("box", make_mesh(soup), {0, 0, 0}, kRed));
  Camera camera;
  camera.eye = {2, 0, .5};
  camera.target = {0, 0, 0};
  EXPECT_TRUE(blue(draw(scene, camera).at(kWidth / 2, kHeight / 2)));
  scene.bodies[0].parts[0].repaint = true;
  EXPECT_TRUE(red(draw(scene, camera).at(kWidth / 2, kHeight / 2)));
}

TEST(Renderer, SameSceneSameBytes) {
  const Image first = draw_sample(Quality::kFine);
  EXPECT_EQ(first.rgb, draw_sample(Quality::kFine).rgb) << "two renderers";
  const Scene scene = sample_scene();
  const Camera camera = auto_frame(bounds(scene), "iso", 4.0 / 3);
  Renderer renderer(160, 120, Quality::kFine), other(64, 64, Quality::kDraft);
  Scene elsewhere = scene;
  elsewhere.bodies[2].pose.translation().x() += .1;
  renderer.draw(elsewhere, camera);
  other.draw(elsewhere, camera);  // its context is current now
  EXPECT_EQ(renderer.draw(scene, camera).rgb, first.rgb) << "after another frame and another context";
  Image in_thread;
  std::thread([&] { Renderer(160, 120, Quality::kFine).draw(scene, camera, in_thread); }).join();
  EXPECT_EQ(in_thread.rgb, first.rgb) << "another thread";
  EXPECT_NE(renderer.draw(elsewhere, camera).rgb, first.rgb);
}

TEST(Renderer, SameBytesForAnyNumberOfThreads) {
  char expected[32];
  std::snprintf(expected, sizeof expected, "%016lx",
                static_cast<unsigned long>(hash_of(draw_sample(Quality::kFine))));
  for (const char* threads : {"0", "1", "2", "4"}) {
    const std::string command =
        std::string("LP_NUM_THREADS=") + threads + " '" + lab::build_path("bin/render_hash") + "'";
    FILE* pipe = popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    char line[64] = "";
    EXPECT_NE(std::fgets(line, sizeof line, pipe), nullptr);
    EXPECT_EQ(pclose(pipe), 0);
    EXPECT_EQ(std::string(line).substr(0, 16), expected) << threads << " threads";
  }
}

TEST(Renderer, MeshesMayComeAndGo) {
  // A new mesh often gets the address of the one just freed: it must not get its triangles too.
  Renderer renderer(80, 60, Quality::kDraft);
  Camera camera;
  for (int i = 0; i < 12; ++i) {
    Scene scene = bare();
    scene.bodies.push_back(sample_body("box", make_box({.1 + .1 * i, .4, .4}), {0, 0, 0}, kRed));
    EXPECT_EQ(renderer.draw(scene, camera).rgb, Renderer(80, 60, Quality::kDraft).draw(scene, camera).rgb)
        << i;
  }
}

TEST(Renderer, OddSizesAndEmptyScenes) {
  for (const auto& [w, h] : {std::pair(1, 1), std::pair(7, 300), std::pair(333, 5)}) {
    const Image image = Renderer(w, h, Quality::kFine).draw(Scene(), Camera());
    EXPECT_EQ(image.width, w);
    EXPECT_EQ(image.height, h);
    EXPECT_EQ(image.rgb.size(), static_cast<size_t>(w) * h * 3);
  }
}

std::string error_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(Renderer, NonsenseIsRefusedInOneLine) {
  for (const auto& [w, h] :
       {std::pair(0, 10), std::pair(10, -1), std::pair(10000, 10000), std::pair(4096, 4096)})
    EXPECT_NE(error_of([&] { Renderer(w, h, Quality::kDraft); }).find("pixels is not possible"),
              std::string::npos);
  EXPECT_NE(error_of([] { quality_from_name("best"); }).find("draft, live, fine"), std::string::npos);
  EXPECT_EQ(quality_from_name("fine"), Quality::kFine);

  Renderer renderer(16, 16, Quality::kDraft);
  Scene scene = sample_scene();
  scene.bodies[1].pose.translation().x() = NAN;
  EXPECT_NE(error_of([&] { renderer.draw(scene, Camera()); }).find("'post'"), std::string::npos);
  scene = sample_scene();
  scene.bodies[2].parts[0].scale.y() = 0;
  EXPECT_NE(error_of([&] { renderer.draw(scene, Camera()); }).find("'ball'"), std::string::npos);
  scene = sample_scene();
  scene.light.towards.setZero();
  EXPECT_NE(error_of([&] { renderer.draw(scene, Camera()); }).find("light"), std::string::npos);
  scene = sample_scene();
  scene.ground.spacing = 0;
  EXPECT_NE(error_of([&] { renderer.draw(scene, Camera()); }).find("floor"), std::string::npos);
  Camera camera;
  camera.target = camera.eye;
  EXPECT_NE(error_of([&] { renderer.draw(sample_scene(), camera); }).find("camera"), std::string::npos);
  EXPECT_NO_THROW(renderer.draw(sample_scene(), Camera())) << "still usable afterwards";
}

TEST(Renderer, SaysWhoDraws) {
  const std::string info = Renderer(8, 8, Quality::kDraft).gl_info();
  EXPECT_TRUE(info.starts_with("OSMesa, ") || info.starts_with("EGL, ")) << info;
  EXPECT_NE(info.find("Core Profile"), std::string::npos) << info;
}

}  // namespace
}  // namespace lab::render
