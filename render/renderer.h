// Draws scenes off screen with OpenGL 3.3 core. Deterministic: same scene, same machine, same bytes, whatever
// the number of threads. Meshes are uploaded once and kept as long as the mesh is. Not for two threads at
// the same time; any number of Renderers may live beside each other.
#pragma once

#include <memory>
#include <string>

#include "render/camera.h"
#include "render/image.h"
#include "render/scene.h"

namespace lab::render {

enum class Quality {
  kDraft,  // plain: one sample a pixel, no shadow
  kLive,   // anti-aliased (2x2 samples a pixel), no shadow
  kFine,   // anti-aliased, soft shadow
};

// "draft", "live" or "fine"; throws std::invalid_argument that names them otherwise.
Quality quality_from_name(const std::string& name);

class Renderer {
 public:
  // Throws std::invalid_argument for a picture below 1 or above 4096 pixels a side or 9.4 million in all, and
  // std::runtime_error with GL's message if there is no context.
  Renderer(int width, int height, Quality quality = Quality::kLive);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  // Throws std::invalid_argument for a non-finite pose or camera (naming the body), std::runtime_error if GL
  // fails.
  Image draw(const Scene& scene, const Camera& camera);
  void draw(const Scene& scene, const Camera& camera, Image& out);  // keeps out's memory

  // Depth and ids of the same view. Annotations are left out, translucent bodies count as solid.
  Measurement measure(const Scene& scene, const Camera& camera);

  // The OpenGL in use, for manifests: "OSMesa, llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6".
  const std::string& gl_info() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lab::render
