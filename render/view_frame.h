// What all draw calls of a frame share: where the eye, the sun, the floor and the shadow map are. Plain
// geometry, no OpenGL.
#pragma once

#include "render/camera.h"
#include "render/shadow.h"

namespace lab::render {

struct ViewFrame {
  Eigen::Vector4d eye;  // homogeneous: position and 1; orthographic: the direction towards it and 0
  Eigen::Vector3d sun;  // unit vector towards it
  Eigen::Matrix4d clip_from_world;
  Eigen::Matrix4d ray_from_clip;     // directions of lines of sight, for the sky
  Eigen::Vector4d depth_from_world;  // row: metres along the view direction
  bool floor_visible = false;
  Eigen::Vector2d floor_centre{0, 0};
  double floor_radius = 0;
  ShadowView shadow;

  Eigen::AlignedBox2d floor() const;
  Eigen::Matrix4d shadow_from_world() const;  // texture coordinates and depth, 0..1
};

// Checks camera, light and ground: throws std::invalid_argument that names what is wrong. `all`: the box
// around all bodies, so that the far plane cuts none.
ViewFrame make_view_frame(const Scene& scene, const Camera& camera, const Bounds& all, int width, int height);

// The pixels (x, y, width, height; from the lower left corner) that a box may cover, somewhat more than
// needed, within a picture.
Eigen::Array4i covered_pixels(const ViewFrame& view, const Bounds& box, int width, int height);

}  // namespace lab::render
