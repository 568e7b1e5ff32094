// Where the shadow map looks from and what it covers: plain geometry.
#pragma once

#include <Eigen/Core>

#include "render/scene.h"

namespace lab::render {

struct ShadowView {
  Eigen::Matrix4d clip_from_world;  // orthographic, along the sun's rays; all casters lie inside
  double side = 1;                  // metres that the (square) map is wide
  double depth = 1;                 // metres along the rays that it covers
  // The box on the floor in which all shadows fall: x and y only. Empty if there is none.
  Eigen::AlignedBox2d on_floor;
};

// sun: unit vector from the scene to the sun.
ShadowView fit_shadow(const Scene& scene, const Eigen::Vector3d& sun);

}  // namespace lab::render
