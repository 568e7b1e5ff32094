#include "procs/renderer/painter.h"

#include <fmt/format.h>

namespace lab::renderer {
namespace {

std::string describe(const std::string& view, const render::Camera& c) {
  const auto point = [](const Eigen::Vector3d& p) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", p.x(), p.y(), p.z());
  };
  const std::string lens =
      c.orthographic() ? fmt::format("height {:.6g} m", c.height) : fmt::format("fov {:.6g} rad", c.fov);
  return fmt::format("{}; eye {} target {} up {} m; {}", view, point(c.eye), point(c.target), point(c.up),
                     lens);
}

}  // namespace

render::PngTexts texts_of(const Shot& shot, const std::string& view) {
  render::PngTexts texts;
  if (shot.step) texts = {{"step", std::to_string(*shot.step)}, {"time", fmt::format("{:.6f} s", shot.time)}};
  texts.emplace_back("camera", describe(view, shot.camera));
  return texts;
}

Painter::Painter(const RunScene& run)
    : run_(run),
      renderer_(static_cast<int>(run.settings().size[0]), static_cast<int>(run.settings().size[1]),
                render::quality_from_name(run.settings().quality)) {}

Picture Painter::draw(const Shot& shot) {
  Picture picture{renderer_.draw(shot.scene, shot.camera), texts_of(shot, run_.settings().camera)};
  run_.draw_legend(picture.image);
  return picture;
}

render::Measurement Painter::measure(const Shot& shot) {
  render::Scene scene;
  scene.bodies = shot.robot;
  return renderer_.measure(scene, shot.camera);
}

}  // namespace lab::renderer
