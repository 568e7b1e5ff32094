// What is drawn: bodies with world poses, each made of parts; one sun, one floor, one sky. Plain values:
// build once, set Body::pose for each frame. Metres, world z up. Colours are sRGB in 0..1 with straight
// alpha.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "render/mesh/mesh.h"

namespace lab::render {

struct Part {
  MeshPtr mesh;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // part in its body
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();         // applied to the mesh first; may mirror
  Eigen::Vector4f rgba =
      Eigen::Vector4f(.75f, .76f, .78f, 1);  // of surfaces that have no colour of their own
  bool repaint = false;                      // rgba also replaces the mesh's own colours
  uint16_t id = 0;  // its pixels in the id image; 0 = as the background and the floor
};

struct Body {
  std::string name;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // body in the world: set for every frame
  std::vector<Part> parts;
  bool visible = true;
  bool casts_shadow = true;
  bool annotation = false;  // explains the scene to a viewer (trace, arrow): not in depth and id images
  Eigen::Vector4f tint{1, 1, 1, 0};  // rgb laid over the body's colours; alpha = how much of it
  float opacity = 1;                 // of the body as a whole
  // Translucent bodies of one group other than 0 are one piece of glass: a ghost robot shows neither its inside
  // nor the overlaps of its links. A body of group 0 is a piece of its own.
  int group = 0;
};

struct Light {
  Eigen::Vector3d towards{0.25, -0.75, 1.35};  // from the scene to the sun; any length
  float strength = 1.0f;                       // of the sun; 0 leaves only the sky's light
};

struct Ground {
  bool visible = true;
  double height = 0;   // world z of the floor
  double spacing = 1;  // metres between main grid lines, with five fine cells between them
};

struct Scene {
  std::vector<Body> bodies;
  Light light;
  Ground ground;
};

// The bodies as one translucent, tinted robot without a shadow: `group` must differ from ghost to ghost.
std::vector<Body> ghost(std::vector<Body> bodies, int group, const Eigen::Vector4f& tint, float opacity);

// World box around all visible bodies (boxes of boxes: never too small, sometimes too large). Empty if there
// are none.
Bounds bounds(const Scene& scene);
Bounds bounds(const Body& body);  // whether visible or not

}  // namespace lab::render
