#include "render/scene.h"

namespace lab::render {

Bounds bounds(const Body& body) {
  Bounds all;
  for (const Part& part : body.parts) {
    if (!part.mesh || part.mesh->bounds.isEmpty()) continue;
    const Eigen::Isometry3d pose = body.pose * part.pose;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner = part.mesh->bounds.corner(static_cast<Bounds::CornerType>(i));
      all.extend(pose * part.scale.cwiseProduct(corner));
    }
  }
  return all;
}

Bounds bounds(const Scene& scene) {
  Bounds all;
  for (const Body& body : scene.bodies)
    if (body.visible) all.extend(bounds(body));
  return all;
}

std::vector<Body> ghost(std::vector<Body> bodies, int group, const Eigen::Vector4f& tint, float opacity) {
  for (Body& body : bodies) {
    body.tint = tint;
    body.opacity = opacity;
    body.group = group;
    body.casts_shadow = false;
  }
  return bodies;
}

}  // namespace lab::render
