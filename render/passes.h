// The draw calls, each into whatever frame buffer is bound: OpenGL state in, pixels out. The
// Renderer decides their order.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "render/gl.h"
#include "render/items.h"

namespace lab::render {

constexpr int kShadowSide = 1024;  // pixels of the shadow map

class Passes {
 public:
  explicit Passes(bool shadow);

  // Sky and floor, once per pixel: their shaders smooth their own edges.
  void background(const ViewFrame& view, const Ground& ground);
  // The depth map seen from the sun, and the shadow that it gives on the floor.
  void shadow_map(const ViewFrame& view, const Items& items);
  void floor_shadow(const ViewFrame& view, const Scene& scene, unsigned shadow_map);
  // The floor as depth alone: it hides what is under it.
  void floor_depth(const ViewFrame& view, const Ground& ground);
  void solid(const ViewFrame& view, const Light& light, const Items& items, unsigned shadow_map);
  // One piece of glass, first as depth alone, so that its inside does not show through. Call after solid().
  void glass(const ViewFrame& view, const Light& light, const Glass& piece, unsigned shadow_map);
  // 2x2 samples into each pixel, over what is there.
  void average(unsigned samples);
  // Depth and ids of everything but annotations, into two floats.
  void measure(const ViewFrame& view, const Ground& ground, const Items& items);

 private:
  const Program& body(const Item& item, const ViewFrame& view, const Light& light, unsigned shadow_map);
  void draw_items(const ViewFrame& view, const Light& light, const std::vector<const Item*>& items,
                  unsigned shadow_map);
  void draw_floor(const Program& program, const ViewFrame& view, const Ground& ground,
                  const Eigen::AlignedBox2d& area);
  void triangle_over_all();
  const Program& lazily(std::unique_ptr<Program>& program, const char* name, const char* vertex,
                        const char* fragment, const char* defines = "");

  bool shadow_;
  std::unique_ptr<Program> bodies_[4];  // by textured + 2 * coloured
  std::unique_ptr<Program> sky_, floor_, floor_depth_, floor_shadow_, depth_, average_, measure_,
      floor_measure_;
  unsigned no_array_ = 0;      // the core profile requires a bound one even when no vertex is read
  unsigned samplers_[2] = {};  // for the shadow map: read as numbers; compared without smoothing
};

}  // namespace lab::render
