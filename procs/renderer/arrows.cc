// RunScene's arrows, and the legend with their scale and that of the trace's colours.
#include <fmt/format.h>
#include <rbd/algorithm/center_of_mass.h>
#include <rbd/algorithm/kinematics.h>

#include <algorithm>
#include <cmath>

#include "procs/renderer/parts.h"
#include "procs/renderer/run_scene.h"
#include "render/markers.h"

namespace lab::renderer {
namespace {

constexpr double kLongest = 0.16;  // of the picture's width: the longest arrow of the run
const Eigen::Vector4f kVelocity(.10f, .60f, .62f, 1), kForce(.93f, .45f, .10f, 1);

/// The largest of 1, 2, 5 times a power of ten that is not above `x`.
double round_down(double x) {
  const double ten = std::pow(10, std::floor(std::log10(x)));
  return (x >= 5 * ten ? 5 : x >= 2 * ten ? 2 : 1) * ten;
}

void draw_box(render::Image& image, int x, int y, int width, int height, const Eigen::Vector4f& rgba) {
  for (int row = std::max(y, 0); row < std::min(y + height, image.height); ++row)
    for (int column = std::max(x, 0); column < std::min(x + width, image.width); ++column)
      for (int c = 0; c < 3; ++c) image.at(column, row)[c] = static_cast<uint8_t>(std::lround(255 * rgba[c]));
}

}  // namespace

bool RunScene::shows(const char* arrows) const {
  return std::find(extras_.arrows.begin(), extras_.arrows.end(), arrows) != extras_.arrows.end();
}

/// The traced frame, or one for each joint that moves.
std::vector<rbd::FrameIndex> RunScene::moving_frames() const {
  if (!settings_.trace.empty()) return {traced_};
  std::vector<rbd::FrameIndex> frames;
  for (int joint = 1; joint < model_.njoints; ++joint)
    frames.push_back(model_.frameId(model_.names[static_cast<size_t>(joint)]));
  return frames;
}

void RunScene::set_scales() {
  double newtons = 0;
  for (const Push& push : extras_.pushes) newtons = std::max(newtons, push.force.norm());
  const auto scale = [&](double largest, const char* what, const char* unit) {
    if (!(largest > 1e-9)) return Scale{};
    const double length = round_down(kLongest * placement_.picture_width());
    const double one = length / round_down(largest);
    return Scale{one, fmt::format("{}: {:g} {} = {:g} m", what, round_down(largest), unit, length)};
  };
  velocity_ = scale(max_speed_, "velocity", "m/s");
  force_ = scale(newtons, "force", "N");
}

/// For the snapshot that set_pose() has been called with.
void RunScene::add_arrows(const Snapshot& snapshot, render::Scene& scene) {
  if (extras_.arrows.empty()) return;
  const double width = placement_.picture_width(), radius = 0.0025 * width;
  for (render::Body& body : scene.bodies)  // arrows sit inside the links and have to show through them
    if (!body.annotation && body.group == 0) {
      body.opacity = .55f;
      body.group = 1;
    }
  const bool velocities = snapshot.v.size() > 0 && shows("velocity") && velocity_.metres > 0;
  for (rbd::FrameIndex frame : moving_frames()) {
    const rbd::SE3& pose = data_.oMf[frame];
    if (shows("frames")) scene.bodies.push_back(render::make_axes(isometry(pose), 0.05 * width));
    if (velocities)
      scene.bodies.push_back(render::make_arrow(
          pose.translation(),
          velocity_.metres * rbd::getFrameVelocity(model_, data_, frame, rbd::LOCAL_WORLD_ALIGNED).linear(),
          radius, kVelocity));
  }
  if (shows("force"))
    for (const Push& push : extras_.pushes) {
      if (snapshot.time < push.begin || snapshot.time >= push.end || !model_.existFrame(push.frame)) continue;
      const Eigen::Vector3d vector = force_.metres * push.force;  // it ends where it acts
      scene.bodies.push_back(render::make_arrow(data_.oMf[model_.frameId(push.frame)].translation() - vector,
                                                vector, 1.4 * radius, kForce));
    }
  if (shows("com")) {
    const Eigen::Vector3d com = snapshot.v.size() > 0
                                    ? rbd::centerOfMass(model_, data_, snapshot.q, snapshot.v)
                                    : rbd::centerOfMass(model_, data_, snapshot.q);
    scene.bodies.push_back(render::make_com(com, 0.014 * width));
    if (velocities)
      scene.bodies.push_back(render::make_arrow(com, velocity_.metres * data_.vcom[0], radius, kVelocity));
  }
}

void RunScene::draw_legend(render::Image& image) const {
  const int scale = std::max(1, std::min(image.width, image.height) / 320);
  const int line = 11 * scale, left = 6 * scale;
  int y = image.height - line;
  const uint8_t ink[3] = {50, 54, 60};
  const auto write = [&](int x, const std::string& text) {
    render::draw_text(image, x, y, text, scale, ink);
  };
  if (!settings_.trace.empty() && extras_.trace_by != "time") {
    const bool error = extras_.trace_by == "error";
    const double largest = error ? 1000 * max_value_ : max_value_;
    const int width = 60 * scale;
    write(left, "0");
    const int bar = left + 9 * scale;
    for (int x = 0; x < width; ++x)
      draw_box(image, bar + x, y, 1, 7 * scale, render::ramp_value((x + .5) / width));
    write(bar + width + 3 * scale, fmt::format("{:.3g} {}: {} of {}", largest, error ? "mm" : "m/s",
                                               extras_.trace_by, settings_.trace));
    y -= line;
  }
  for (const auto& [name, each, colour] :
       {std::tuple("force", &force_, kForce), std::tuple("velocity", &velocity_, kVelocity)}) {
    if (!shows(name) || each->text.empty()) continue;
    draw_box(image, left, y + 3 * scale, 7 * scale, 2 * scale, colour);
    write(left + 10 * scale, each->text);
    y -= line;
  }
}

}  // namespace lab::renderer
