#include "render/items.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

namespace lab::render {
namespace {

using Eigen::Affine3d;
using Eigen::Vector4f;

void check(const Body& body, const Part& part) {
  const auto need = [&](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument("renderer: body '" + body.name + "': " + what);
  };
  need(body.pose.matrix().allFinite() && part.pose.matrix().allFinite() && part.scale.allFinite() &&
           part.rgba.allFinite() && body.tint.allFinite() && std::isfinite(body.opacity),
       "a pose, scale or colour is not finite");
  need(part.scale.prod() != 0, "a scale of 0 leaves nothing to draw");
}

Vector4f clamped(const Vector4f& rgba) { return rgba.cwiseMax(0.f).cwiseMin(1.f); }

}  // namespace

Items collect(const Scene& scene, const ViewFrame& view, MeshStore& meshes) {
  Items items;
  struct Order {
    double distance;
    int group;
  };
  std::vector<Order> order;  // one for each item
  for (const Body& body : scene.bodies) {
    if (!body.visible) continue;
    // Glass without a group is a piece of its own, numbered downwards from -1.
    const int piece = body.group != 0 ? body.group : -1 - static_cast<int>(&body - scene.bodies.data());
    for (const Part& part : body.parts) {
      if (!part.mesh || part.mesh->indices.empty()) continue;
      check(body, part);
      const Affine3d world_from_part = Affine3d(body.pose * part.pose) * Eigen::Scaling(part.scale);
      const Vector4f viewer = (world_from_part.inverse().matrix() * view.eye).cast<float>();
      const double distance =
          view.depth_from_world.dot((world_from_part * part.mesh->bounds.center()).homogeneous());
      const Buffers& mesh = meshes.get(part.mesh);
      bool open = false;
      for (size_t s = 0; s < part.mesh->surfaces.size(); ++s) {
        const Surface& surface = part.mesh->surfaces[s];
        open |= surface.two_sided;
        const bool own = surface.coloured && !part.repaint;
        Vector4f rgba = clamped(own ? surface.rgba : part.rgba);
        rgba[3] *= std::clamp(body.opacity, 0.f, 1.f);
        if (rgba[3] <= 0) continue;
        const bool textured = surface.texture && mesh.has_uvs && !part.repaint;
        items.all.push_back({&mesh, s, textured ? meshes.get(surface.texture) : 0, world_from_part, viewer,
                             rgba, clamped(body.tint), std::clamp(surface.roughness, 0.05f, 1.f), part.id,
                             part.scale.prod() < 0, surface.two_sided, body.annotation});
        order.push_back({distance, piece});
      }
      if (body.casts_shadow) items.casters.push_back({&mesh, world_from_part, part.scale.prod() < 0, open});
    }
    items.box.extend(bounds(body));
  }

  std::vector<size_t> by_distance(items.all.size());
  for (size_t i = 0; i < by_distance.size(); ++i) by_distance[i] = i;
  std::stable_sort(by_distance.begin(), by_distance.end(),
                   [&](size_t a, size_t b) { return order[a].distance < order[b].distance; });
  struct Piece {
    Glass glass;
    double sum = 0;
  };
  std::map<int, Piece> pieces;
  for (size_t i : by_distance) {
    const Item& item = items.all[i];
    if (item.rgba[3] >= 1) {
      items.solid.push_back(&item);
      continue;
    }
    Piece& piece = pieces[order[i].group];
    piece.glass.push_back(&item);
    piece.sum += order[i].distance;
  }
  std::vector<Piece*> glass;
  for (auto& [group, piece] : pieces) glass.push_back(&piece);
  const auto mean = [](const Piece* p) { return p->sum / static_cast<double>(p->glass.size()); };
  std::stable_sort(glass.begin(), glass.end(),
                   [&](const Piece* a, const Piece* b) { return mean(a) > mean(b); });
  for (Piece* piece : glass) items.glass.push_back(std::move(piece->glass));
  return items;
}

}  // namespace lab::render
