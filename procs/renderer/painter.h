#pragma once
#include "procs/renderer/stage.h"
#include "render/png.h"
#include "render/renderer.h"

namespace lab::renderer {

/// A picture and what is written into its file: step, time, camera.
struct Picture {
  render::Image image;
  render::PngTexts texts;
};

/// Draws a stage with OpenGL. Not for two threads.
class Painter {
 public:
  /// Throws std::runtime_error if OpenGL cannot be had, std::invalid_argument for an impossible size.
  explicit Painter(Stage& stage);

  Picture draw(const Moment&);
  Picture draw_ghosts(int64_t n);
  /// Depth and links of the same view, nothing but the robot.
  render::Measurement measure(const Moment&);
  const std::string& gl_info() const { return renderer_.gl_info(); }

 private:
  Picture draw(const render::Scene&, const render::Camera&, const Moment*);

  Stage& stage_;
  render::Renderer renderer_;
};

/// The texts of a picture; also for depth and id images.
render::PngTexts texts_of(const Moment&, const std::string& view, const render::Camera&);

}  // namespace lab::renderer
