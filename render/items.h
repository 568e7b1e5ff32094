// A scene as a flat list of surfaces to draw, in drawing order.
#pragma once

#include <vector>

#include "render/mesh_store.h"
#include "render/view_frame.h"

namespace lab::render {

// One surface of one part.
struct Item {
  const Buffers* mesh;
  size_t surface;
  unsigned texture;  // 0: none
  Eigen::Affine3d world_from_part;
  Eigen::Vector4f viewer;  // the eye in the part's axes, as may_face takes it
  Eigen::Vector4f rgba, tint;
  float roughness;
  uint16_t id;
  bool mirrored, two_sided, annotation;
};

struct Caster {
  const Buffers* mesh;
  Eigen::Affine3d world_from_part;
  bool mirrored, two_sided;
};

// Translucent items that are one piece of glass.
using Glass = std::vector<const Item*>;

struct Items {
  std::vector<Item> all;
  std::vector<const Item*> solid;  // near ones first: they hide what comes later, before it is shaded
  std::vector<Glass> glass;        // far ones first
  std::vector<Caster> casters;
  Bounds box;  // around everything visible
};

// Throws std::invalid_argument for a pose, scale or colour that is not finite, naming the body.
Items collect(const Scene& scene, const ViewFrame& view, MeshStore& meshes);

}  // namespace lab::render
