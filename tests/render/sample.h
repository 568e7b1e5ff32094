// A scene with every primitive, a colour each, glass, a mirrored part and a shadow: for determinism and
// golden pictures.
#pragma once

#include "render/mesh/primitives.h"
#include "render/renderer.h"

namespace lab::render {

inline Body sample_body(const char* name, MeshPtr mesh, const Eigen::Vector3d& at,
                        const Eigen::Vector4f& rgba) {
  Body body;
  body.name = name;
  body.pose.translation() = at;
  Part part;
  part.mesh = std::move(mesh);
  part.rgba = rgba;
  body.parts.push_back(part);
  return body;
}

inline Scene sample_scene() {
  Scene scene;
  scene.bodies.push_back(sample_body("box", make_box({.4, .3, .2}), {0, 0, .1}, {.8f, .3f, .2f, 1}));
  scene.bodies.push_back(sample_body("post", make_cylinder(.06, .5), {0, 0, .45}, {.85f, .85f, .86f, 1}));
  scene.bodies.push_back(sample_body("ball", make_sphere(.12), {0, 0, .75}, {.2f, .45f, .8f, 1}));
  scene.bodies.push_back(sample_body("arm", make_capsule(.05, .4), {.25, 0, .75}, {.2f, .2f, .22f, 1}));
  scene.bodies.back().pose.linear() = Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  scene.bodies.back().parts[0].scale = {1, -1, 1};
  scene.bodies.push_back(sample_body("glass", make_box({.2, .2, .2}), {.35, -.3, .1}, {.3f, .9f, .5f, .5f}));
  return scene;
}

inline uint64_t hash_of(const Image& image) {  // FNV-1a
  uint64_t h = 1469598103934665603ull;
  for (uint8_t byte : image.rgb) h = (h ^ byte) * 1099511628211ull;
  return h;
}

inline Image draw_sample(Quality quality, int width = 160, int height = 120) {
  const Scene scene = sample_scene();
  Renderer renderer(width, height, quality);
  return renderer.draw(scene, auto_frame(bounds(scene), "iso", static_cast<double>(width) / height));
}

}  // namespace lab::render
