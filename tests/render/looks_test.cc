// What ghosts, tints, textures and colours of vertices look like, and what many frames cost.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

#include "render/markers.h"
#include "render/mesh/primitives.h"
#include "render/trace.h"
#include "tests/render/sample.h"

namespace lab::render {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4f;

constexpr int kWidth = 160, kHeight = 120;
const Vector4f kRed(.9f, .05f, .05f, 1), kBlue(.05f, .05f, .9f, 1), kWhite(.9f, .9f, .9f, 1);
bool red(const uint8_t* p) { return p[0] > 60 && p[0] > 2 * p[1] && p[0] > 2 * p[2]; }
bool green(const uint8_t* p) { return p[1] > 60 && p[1] > 2 * p[0] && p[1] > 2 * p[2]; }
bool blue(const uint8_t* p) { return p[2] > 60 && p[2] > 2 * p[0] && p[2] > 2 * p[1]; }

Scene bare() {
  Scene scene;
  scene.ground.visible = false;
  return scene;
}

Camera from_x() {
  Camera camera;
  camera.eye = {3, 0, 0};
  camera.target = {0, 0, 0};
  return camera;
}

Image draw(const Scene& scene, Quality quality = Quality::kDraft) {
  return Renderer(kWidth, kHeight, quality).draw(scene, from_x());
}

int differing(const Image& a, const Image& b, int by = 3) {
  int n = 0;
  for (size_t i = 0; i < a.rgb.size(); ++i) n += std::abs(a.rgb[i] - b.rgb[i]) > by;
  return n;
}

// A ball in a larger ball, a plate through both: a ghost of them is the ghost of their outside.
TEST(Looks, AGhostShowsNothingOfItsInside) {
  for (Quality quality : {Quality::kDraft, Quality::kFine}) {
    std::vector<Body> hollow{sample_body("outside", make_sphere(.5), {0, 0, 0}, kWhite)};
    Scene outside = bare(), both = bare();
    outside.bodies = ghost(hollow, 1, {0, 0, 1, .5f}, .4f);
    hollow.push_back(sample_body("inside", make_sphere(.3), {0, 0, 0}, kRed));
    hollow.push_back(sample_body("plate", make_box({.1, .6, .1}), {.1, 0, 0}, kRed));
    both.bodies = ghost(hollow, 1, {0, 0, 1, .5f}, .4f);
    EXPECT_EQ(draw(both, quality).rgb, draw(outside, quality).rgb);
    for (Body& body : both.bodies) body.group = 0;  // three pieces of glass, one within another
    EXPECT_GT(differing(draw(both, quality), draw(outside, quality)), 500);
  }
}

// Opacity by hand: along one line of sight, ghosts k = 1..n in front of a background b give
// c_n + (1 - a)(c_n-1 + ...), with a their opacity. Draft mixes the final values, rounded n times.
TEST(Looks, GhostsLieOverOneAnother) {
  const auto at_centre = [](const Scene& scene) {
    const Image image = draw(scene);
    return std::vector<double>(image.at(80, 60), image.at(80, 60) + 3);
  };
  Scene empty = bare();
  const auto background = at_centre(empty);
  std::vector<double> expected = background;
  Scene all = bare();
  const Vector4f tints[] = {{.9f, .2f, .1f, 1}, {.1f, .8f, .2f, 1}, {.2f, .2f, .9f, 1}};
  const float opacity = .4f;
  for (int k = 0; k < 3; ++k) {  // from far to near; put into the scene the other way round
    const std::vector<Body> plate{sample_body("plate", make_box({.1, 1, 1}), {-.5 + .5 * k, 0, 0}, kWhite)};
    Scene solid = bare();
    solid.bodies = ghost(plate, k + 1, tints[k], 1);
    const auto colour = at_centre(solid);
    for (int c = 0; c < 3; ++c) expected[c] = opacity * colour[c] + (1 - opacity) * expected[c];
    const auto ghosts = ghost(plate, k + 1, tints[k], opacity);
    all.bodies.insert(all.bodies.begin(), ghosts.begin(), ghosts.end());
  }
  const auto seen = at_centre(all);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 3);
}

TEST(Looks, AGhostWhereTheSolidRobotStandsIsNotSeen) {
  const std::vector<Body> robot{sample_body("ball", make_sphere(.5), {0, 0, 0}, kWhite)};
  Scene alone = bare(), both = bare();
  alone.bodies = both.bodies = robot;
  for (const Body& body : ghost(robot, 1, kRed, .5f)) both.bodies.push_back(body);
  EXPECT_LT(differing(draw(both), draw(alone)), 3 * 2 * 100);  // at most a line of pixels along its rim
}

TEST(Looks, TintIsLaidOverColours) {
  Scene scene = bare();
  scene.bodies = {sample_body("ball", make_sphere(.5), {0, 0, 0}, kRed)};
  const Image plain = draw(scene);
  scene.bodies[0].tint = {.05f, .05f, .9f, 0};
  EXPECT_EQ(draw(scene).rgb, plain.rgb) << "none of it";
  scene.bodies[0].tint[3] = 1;
  const Image tinted = draw(scene);
  scene.bodies[0].tint = {1, 1, 1, 0};
  scene.bodies[0].parts[0].rgba = kBlue;
  EXPECT_EQ(tinted.rgb, draw(scene).rgb) << "all of it";
}

// A square that faces the eye, 1 m wide, with a texture: which quarter has which colour?
MeshPtr square(std::shared_ptr<const Texture> texture) {
  auto mesh = std::make_shared<Mesh>();
  for (const auto& [y, z] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
    mesh->positions.push_back(Eigen::Vector3f(0, .5f * y, .5f * z));
    mesh->normals.push_back(Eigen::Vector3f(1, 0, 0));
    mesh->uvs.push_back(Eigen::Vector2f(.5f + .5f * y, .5f + .5f * z));  // u to the right (+y), v up
  }
  mesh->bounds = Bounds(Vector3d(0, -.5, -.5), Vector3d(0, .5, .5));
  mesh->indices = {0, 1, 2, 0, 2, 3};
  Surface surface;
  surface.count = 6;
  surface.coloured = true;
  surface.rgba.setOnes();
  surface.texture = std::move(texture);
  mesh->surfaces = {surface};
  return mesh;
}

TEST(Looks, TexturesLieTheRightWayUp) {
  auto texture = std::make_shared<Texture>();
  texture->width = texture->height = 2;
  texture->rgba = {230, 10, 10,  255, 10,  230, 10,  255,
                   10,  10, 230, 255, 230, 230, 230, 255};  // from the top left
  Scene scene = bare();
  Body body = sample_body("square", square(texture), {0, 0, 0}, kRed);
  scene.bodies = {body};
  for (Quality quality : {Quality::kDraft, Quality::kFine}) {
    const Image image = draw(scene, quality);
    const auto at = [&](double y, double z) {
      const Vector3d p = from_x().pixel({0, y, z}, kWidth, kHeight);
      return image.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
    };
    EXPECT_TRUE(red(at(-.25, .25)));
    EXPECT_TRUE(green(at(.25, .25)));
    EXPECT_TRUE(blue(at(-.25, -.25)));
    EXPECT_NEAR(at(.25, -.25)[0], at(.25, -.25)[1], 20);
  }
  scene.bodies[0].parts[0].repaint = true;  // the part's colour replaces the texture too
  EXPECT_TRUE(red(draw(scene).at(kWidth / 2 + 15, kHeight / 2 + 15)));
  auto broken = std::make_shared<Texture>(*texture);
  broken->width = 3;
  scene.bodies = {sample_body("square", square(broken), {0, 0, 0}, kRed)};
  EXPECT_THROW(draw(scene), std::invalid_argument);
}

// The sun is on the eye's side. The back of a sheet without thickness must look as a front there does, and not as its own
// front, which is in the shade; whether its back is seen because it is turned or because it is mirrored.
TEST(Looks, ABackIsLitByItsNormalTurnedRound) {
  auto sheet = std::make_shared<Mesh>(*square(nullptr));
  sheet->surfaces[0].two_sided = true;
  Scene front = bare();
  front.bodies = {sample_body("sheet", sheet, {0, 0, 0}, kWhite)};
  front.light.towards = {1, .3, .3};
  Scene turned = front, mirrored = front, shade = front;
  turned.bodies[0].pose.linear() = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  mirrored.bodies[0].parts[0].scale = {-1, 1, 1};
  shade.light.towards = {-1, .3, .3};
  for (Quality quality : {Quality::kDraft, Quality::kFine}) {
    const Image seen = draw(front, quality);
    EXPECT_EQ(differing(draw(turned, quality), seen), 0);
    EXPECT_EQ(differing(draw(mirrored, quality), seen), 0);
    EXPECT_GT(differing(draw(shade, quality), seen, 40), 3 * 500) << "the sun's side does matter";
  }
}

// Lines of sight that are parallel see the same from everywhere along them, from between and behind the bodies too.
TEST(Looks, AnOrthographicPictureIsTheSameHoweverFarTheEye) {
  Scene scene = bare();
  scene.bodies = {sample_body("near", make_sphere(.3), {.5, .2, 0}, kRed),
                  sample_body("far", make_sphere(.4), {-.5, -.2, 0}, kBlue)};
  Camera camera = from_x();
  camera.height = 1.5;
  for (Quality quality : {Quality::kDraft, Quality::kFine}) {
    Renderer renderer(kWidth, kHeight, quality);
    const Image seen = renderer.draw(scene, camera);
    EXPECT_TRUE(red(seen.at(90, 60)));
    EXPECT_TRUE(blue(seen.at(60, 60)));
    for (const double along : {-2.5, -4.0, 5.0}) {
      const Eigen::Isometry3d motion(Eigen::Translation3d(along, 0, 0));
      EXPECT_EQ(differing(renderer.draw(scene, moved(camera, motion)), seen), 0) << along;
    }
  }
}

TEST(Looks, RoughnessWidensTheHighlight) {
  const auto bright = [](float roughness) {
    auto ball = std::make_shared<Mesh>(*make_sphere(.5, 96));
    ball->surfaces[0].roughness = roughness;
    Scene scene = bare();
    scene.bodies = {sample_body("ball", ball, {0, 0, 0}, {.1f, .1f, .1f, 1})};
    scene.light.towards = {1, .3, .3};
    const Image image = draw(scene);
    int most = 0, glinting = 0;
    for (size_t i = 0; i < image.rgb.size(); i += 3) {
      const Vector3d p(image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]);
      if (std::abs(p.x() - p.z()) < 60 && p.x() > 100) {
        ++glinting;
        most = std::max(most, static_cast<int>(p.x()));
      }
    }
    return std::pair(most, glinting);
  };
  // The sky behind is blueish and bright as well: count against a ball that does not glint.
  EXPECT_GT(bright(.25f).first, bright(.9f).first);
  EXPECT_GT(bright(.4f).second, bright(.2f).second);
}

// Nothing may pile up, whatever meshes come and go.
TEST(Looks, MemoryStaysFlatOverManyFrames) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer keeps what was freed for a while";
#endif
  const auto resident = [] {
    std::ifstream file("/proc/self/statm");
    long pages = 0, kept = 0;
    file >> pages >> kept;
    return static_cast<double>(kept) * 4096 / 1e6;
  };
  Renderer renderer(64, 48, Quality::kFine);
  Scene scene = sample_scene();
  Image image;
  const size_t robot = scene.bodies.size();
  const auto frame = [&](int i) {
    scene.bodies.resize(robot);
    scene.bodies[2].pose.translation().x() = .001 * i;
    std::vector<Vector3d> points;  // a trace that grows is a new mesh each time
    for (int k = 0; k < 20 + i % 50; ++k) points.push_back({.01 * k, .1, .5});
    scene.bodies.push_back(make_trace(points, {kRed}, .01));
    renderer.draw(scene, turned(auto_frame(bounds(scene)), .01 * i), image);
    if (i % 10 == 0) renderer.measure(scene, Camera());
  };
  for (int i = 0; i < 200; ++i) frame(i);
  const double before = resident();
  for (int i = 200; i < 10'000; ++i) frame(i);
  EXPECT_LT(resident() - before, 8) << "MB more after 10,000 frames";
}

}  // namespace
}  // namespace lab::render
