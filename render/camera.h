// A pinhole camera: it stands at `eye`, looks at `target`, and `up` points up in the picture.
// Pixel (0, 0) is the top left corner of the top left pixel; the centre of that pixel is (0.5, 0.5).
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "render/mesh.h"

namespace lab::render {

struct Camera {
  Eigen::Vector3d eye{2, -2, 1.5}, target{0, 0, 0.4}, up{0, 0, 1};
  double fov = 0.7;  // vertical field of view, radians

  // World to camera axes: x right, y up, z towards the viewer (the camera looks along its own -z).
  // Throws std::invalid_argument if the fields define no view (eye on target, up along the view, NaN, fov not
  // in 0..pi).
  Eigen::Isometry3d view() const;
  // Camera axes to OpenGL clip coordinates for a picture of width / height = aspect; 0 < near < far in
  // metres.
  Eigen::Matrix4d projection(double aspect, double near, double far) const;
  // Pixel of a world point in a width x height picture; z = distance along the view direction (<= 0: behind).
  Eigen::Vector3d pixel(const Eigen::Vector3d& point, int width, int height) const;
};

// The names auto_frame knows: iso (from the front right, above), front (from +x), side (from -y, x to the
// right), top.
const std::vector<std::string>& view_names();

// A camera that sees the whole box in a picture of the given aspect, with some air around it. To keep one
// camera for a whole run, extend one box over all its poses. An empty box counts as one metre around the
// origin. Throws std::invalid_argument for an unknown view, and names the known ones.
Camera auto_frame(const Bounds& box, const std::string& view = "iso", double aspect = 4.0 / 3);

}  // namespace lab::render
