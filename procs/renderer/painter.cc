#include "procs/renderer/painter.h"

#include <fmt/format.h>

namespace lab::renderer {
namespace {

std::string words(const std::string& view, const render::Camera& c) {
  const auto point = [](const Eigen::Vector3d& p) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", p.x(), p.y(), p.z());
  };
  const std::string lens =
      c.orthographic() ? fmt::format("height {:.6g} m", c.height) : fmt::format("fov {:.6g} rad", c.fov);
  return fmt::format("{}; eye {} target {} up {} m; {}", view, point(c.eye), point(c.target), point(c.up),
                     lens);
}

}  // namespace

render::PngTexts texts_of(const Moment& moment, const std::string& view, const render::Camera& camera) {
  return {{"step", std::to_string(moment.step)},
          {"time", fmt::format("{:.6f} s", moment.time)},
          {"camera", words(view, camera)}};
}

Painter::Painter(Stage& stage)
    : stage_(stage),
      renderer_(static_cast<int>(stage.settings().size[0]), static_cast<int>(stage.settings().size[1]),
                render::quality_from_name(stage.settings().quality)) {}

Picture Painter::draw(const render::Scene& scene, const render::Camera& camera, const Moment* moment) {
  Picture picture{renderer_.draw(scene, camera), {}};
  stage_.draw_legend(picture.image);
  if (moment)
    picture.texts = texts_of(*moment, stage_.settings().camera, camera);
  else
    picture.texts = {{"camera", words(stage_.settings().camera, camera)}};
  return picture;
}

Picture Painter::draw(const Moment& moment) {
  const render::Camera camera = stage_.camera(moment);
  return draw(stage_.scene(moment), camera, &moment);
}

Picture Painter::draw_ghosts(int64_t n) { return draw(stage_.ghosts(n), stage_.ghost_camera(), nullptr); }

render::Measurement Painter::measure(const Moment& moment) {
  const render::Camera camera = stage_.camera(moment);
  return renderer_.measure(stage_.robot_alone(moment), camera);
}

}  // namespace lab::renderer
