// Draws scenes of a run with OpenGL.
#pragma once
#include "procs/renderer/run_scene.h"
#include "render/png.h"
#include "render/renderer.h"

namespace lab::renderer {

/// A picture and what is written into its file: step, time, camera.
struct Picture {
  render::Image image;
  render::PngTexts texts;
};

/// Not thread-safe.
class Painter {
 public:
  /// Throws std::runtime_error if there is no OpenGL, std::invalid_argument for an impossible size.
  explicit Painter(const RunScene&);

  Picture draw(const Shot&);
  /// Depth and link ids of the same view, of the robot only.
  render::Measurement measure(const Shot&);
  const std::string& gl_info() const { return renderer_.gl_info(); }

 private:
  const RunScene& run_;
  render::Renderer renderer_;
};

/// The texts of a picture; also for depth and id images. view: the camera's name.
render::PngTexts texts_of(const Shot&, const std::string& view);

}  // namespace lab::renderer
