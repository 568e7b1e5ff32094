#include "render/shadow.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"

namespace lab::render {

using Eigen::Vector3d;

ShadowView fit_shadow(const Scene& scene, const Vector3d& sun) {
  Bounds box;
  for (const Body& body : scene.bodies)
    if (body.visible && body.casts_shadow) box.extend(bounds(body));
  Camera axes;  // looks down the rays; only its axes are used
  axes.eye = sun;
  axes.target.setZero();
  axes.up = std::abs(sun.z()) > 0.9 ? Vector3d::UnitX() : Vector3d::UnitZ();
  const Eigen::Isometry3d sun_from_world = axes.view();

  ShadowView view;
  Bounds seen;  // in the sun's axes: the casters, and the floor below them so that its depth fits too
  // Rays closer than this to level would stretch the map without end: then the floor gets no shadow.
  const bool falls = scene.ground.visible && sun.z() > 0.1;
  for (int i = 0; i < 8 && !box.isEmpty(); ++i) {
    const Vector3d corner = box.corner(static_cast<Bounds::CornerType>(i));
    seen.extend(sun_from_world * corner);
    const double height = std::max(corner.z() - scene.ground.height, 0.0);
    if (!falls || box.max().z() <= scene.ground.height) continue;
    const Vector3d shade = corner - sun * (height / sun.z());
    seen.extend(sun_from_world * shade);
    view.on_floor.extend(shade.head<2>());
  }
  if (seen.isEmpty()) seen = Bounds(Vector3d::Constant(-1), Vector3d::Constant(1));
  const Vector3d centre = seen.center();
  view.side = 1.06 * std::max({seen.sizes().x(), seen.sizes().y(), 1e-3});
  const double depth = view.depth = 1.1 * std::max(seen.sizes().z(), 1e-3);
  Eigen::Matrix4d fit = Eigen::Matrix4d::Identity();
  fit(0, 0) = fit(1, 1) = 2 / view.side;
  fit(2, 2) = -2 / depth;  // clip space looks along +z
  fit.topRightCorner<3, 1>() = -fit.topLeftCorner<3, 3>() * centre;
  view.clip_from_world = fit * sun_from_world.matrix();
  if (!view.on_floor.isEmpty()) {  // room for the blur
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.02 * view.side / sun.z());
    view.on_floor = Eigen::AlignedBox2d(view.on_floor.min() - margin, view.on_floor.max() + margin);
  }
  return view;
}

}  // namespace lab::render
