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

}  // namespace lab::render
