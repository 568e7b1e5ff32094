// A camera, pinhole or orthographic: it stands at `eye`, looks at `target`, and `up` points up in the
// picture. Pixel (0, 0) is the top left corner of the top left pixel; the centre of that pixel is (0.5, 0.5).
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "render/mesh/mesh.h"

namespace lab::render {

struct Camera {
  Eigen::Vector3d eye{2, -2, 1.5}, target{0, 0, 0.4}, up{0, 0, 1};
  double fov = 0.7;   // vertical field of view, radians
  double height = 0;  // above 0: orthographic, with a picture this many metres high; fov is then ignored

  bool orthographic() const { return height > 0; }
  // World to camera axes: x right, y up, z towards the viewer (the camera looks along its own -z).
  // Throws std::invalid_argument if the fields define no view (eye on target, up along the view, NaN, fov not
  // in 0..pi, height below 0).
  Eigen::Isometry3d view() const;
  // Camera axes to OpenGL clip coordinates for a picture of width / height = aspect; 0 < near < far in
  // metres.
  Eigen::Matrix4d projection(double aspect, double near, double far) const;
  // Pixel of a world point in a width x rows picture; z = distance along the view direction (<= 0: behind).
  Eigen::Vector3d pixel(const Eigen::Vector3d& point, int width, int rows) const;
};

// A viewing direction, independent of a scene: what experiments and command lines name.
struct View {
  double azimuth = -0.70;     // of the eye seen from the scene, radians about z: 0 = from +x, pi/2 = from +y
  double elevation = 0.40;    // of the eye above the horizon, radians; pi/2 = from above, with +y up
  double distance = 1;        // in units of the distance from which everything just fits
  double orbit = 0;           // radians a second by which the azimuth grows
  bool orthographic = false;  // no perspective
};

// The named views: iso (from the front right, above), front (from +x), side (from -y, x to the right), top.
// Throws std::invalid_argument for an unknown name, and names the known ones.
const std::vector<std::string>& view_names();
View view_from_name(const std::string& name);

// A camera that sees the whole box in a picture of the given aspect, with a margin; an orbiting view
// sees it at every angle. To keep one camera for a whole run, extend one box over all its poses. An empty box
// counts as one metre around the origin. Throws std::invalid_argument for a box, view or aspect that is not
// finite.
Camera auto_frame(const Bounds& box, const View& view, double aspect = 4.0 / 3);
Camera auto_frame(const Bounds& box, const std::string& view = "iso", double aspect = 4.0 / 3);

// The camera rotated about the vertical through its target: an orbit is turned(framed, view.orbit * seconds).
Camera turned(const Camera& camera, double radians);
// The camera moved by a rigid motion in the world: with a translation alone it follows a frame
// without rotating; with (frame now) * (frame then).inverse() it is mounted on it.
Camera moved(const Camera& camera, const Eigen::Isometry3d& motion);

}  // namespace lab::render
