#include "render/renderer.h"

#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "render/context.h"
#include "render/passes.h"

namespace lab::render {
namespace {

constexpr int kMaxSide = 4096;
constexpr int64_t kMaxPixels = 4096 * 2304;

std::string gl_string(unsigned name) {
  const unsigned char* text = glGetString(name);
  return text ? reinterpret_cast<const char*>(text) : "?";
}

unsigned depth_texture(int width, int height) {
  return make_texture(width, height, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT);
}

unsigned colour_texture(int width, int height) {
  return make_texture(width, height, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
}

// Copies pixels (x, y, width, height) between frame buffers of one size.
void copy(unsigned from, unsigned to, const Eigen::Array4i& area, unsigned what) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  const int x = area[0], y = area[1], right = x + area[2], upper = y + area[3];
  glBlitFramebuffer(x, y, right, upper, x, y, right, upper, what, GL_NEAREST);
}

}  // namespace

Quality quality_from_name(const std::string& name) {
  if (name == "draft") return Quality::kDraft;
  if (name == "live") return Quality::kLive;
  if (name == "fine") return Quality::kFine;
  throw std::invalid_argument("renderer: unknown quality '" + name + "' (known: draft, live, fine)");
}

// A frame is built in two layers. The background (sky, floor, shadow on the floor) has soft edges by its own
// arithmetic and is drawn once per pixel; without its shadow it is kept as long as the camera stands still.
// Bodies are drawn with 2x2 samples on a transparent layer of their own, whose average is laid over the
// background. (In draft quality they go straight onto it.)
struct Renderer::Impl {
  // All that the picture of sky and floor depends on.
  struct BackgroundKey {
    Eigen::Matrix4d clip_from_world, ray_from_clip;
    Eigen::Vector4d floor;
    double spacing;
    bool operator==(const BackgroundKey&) const = default;
  };

  int width, height;
  int samples;  // along one side of a pixel
  bool shadow;
  std::unique_ptr<Context> context;
  std::string info;
  MeshStore meshes;
  std::unique_ptr<Passes> passes;
  unsigned picture = 0, background = 0, layer = 0, layer_colour = 0, shadow_target = 0, shadow_map = 0;
  unsigned saved_depth = 0, measured = 0;  // made when first needed
  std::optional<BackgroundKey> drawn_background;
  std::vector<uint8_t> rgba;
  std::vector<float> pairs;

  Impl(int w, int h, Quality quality);
  void draw(const Scene& scene, const Camera& camera, Image& out);
  void draw_background(const Scene& scene, const ViewFrame& view);
  void draw_bodies(const Scene& scene, const ViewFrame& view, const Items& items);
  void read(Image& out);
  Measurement measure(const Scene& scene, const Camera& camera);
};

Renderer::Impl::Impl(int w, int h, Quality quality)
    : width(w), height(h), samples(quality == Quality::kDraft ? 1 : 2), shadow(quality == Quality::kFine) {
  if (w < 1 || h < 1 || w > kMaxSide || h > kMaxSide || static_cast<int64_t>(w) * h > kMaxPixels)
    throw std::invalid_argument("renderer: a picture of " + std::to_string(w) + " x " + std::to_string(h) +
                                " pixels is not possible (1 to " + std::to_string(kMaxSide) +
                                " a side, at most " + std::to_string(kMaxPixels) + " in all)");
  context = Context::create();
  context->make_current();
  info = context->name() + ", " + gl_string(GL_RENDERER) + ", " + gl_string(GL_VERSION);
  passes = std::make_unique<Passes>(shadow);
  background = make_framebuffer(colour_texture(w, h), 0);
  const unsigned colour = colour_texture(w, h);
  if (samples == 1) {
    picture = layer = make_framebuffer(colour, depth_texture(w, h));
  } else {
    picture = make_framebuffer(colour, 0);
    layer_colour = colour_texture(2 * w, 2 * h);
    layer = make_framebuffer(layer_colour, depth_texture(2 * w, 2 * h));
  }
  if (shadow) {
    shadow_map = depth_texture(kShadowSide, kShadowSide);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    shadow_target = make_framebuffer(0, shadow_map);
  }
  check_gl("setting up the renderer");
}

void Renderer::Impl::draw(const Scene& scene, const Camera& camera, Image& out) {
  context->make_current();
  meshes.forget_dead();
  ViewFrame view = make_view_frame(scene, camera, bounds(scene), width, height);
  const Items items = collect(scene, view, meshes);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  if (shadow) {
    view.shadow = fit_shadow(scene, view.sun);
    glBindFramebuffer(GL_FRAMEBUFFER, shadow_target);
    passes->shadow_map(view, items);
  }
  draw_background(scene, view);
  draw_bodies(scene, view, items);
  read(out);
  check_gl("drawing");
}

void Renderer::Impl::draw_background(const Scene& scene, const ViewFrame& view) {
  glViewport(0, 0, width, height);
  BackgroundKey key{view.clip_from_world, view.ray_from_clip, Eigen::Vector4d::Zero(), 0};
  if (view.floor_visible) {
    key.floor << view.floor_centre, view.floor_radius, scene.ground.height;
    key.spacing = scene.ground.spacing;
  }
  if (drawn_background != key) {
    glBindFramebuffer(GL_FRAMEBUFFER, background);
    passes->background(view, scene.ground);
    drawn_background = key;
  }
  copy(background, picture, {0, 0, width, height}, GL_COLOR_BUFFER_BIT);
  if (!shadow) return;
  glBindFramebuffer(GL_FRAMEBUFFER, picture);
  passes->floor_shadow(view, scene, shadow_map);
}

void Renderer::Impl::draw_bodies(const Scene& scene, const ViewFrame& view, const Items& items) {
  const Eigen::Array4i area = covered_pixels(view, items.box, width, height), fine = area * samples;
  if (items.all.empty() || area[2] == 0 || area[3] == 0) return;
  glEnable(GL_SCISSOR_TEST);  // nothing happens outside
  glScissor(fine[0], fine[1], fine[2], fine[3]);
  glBindFramebuffer(GL_FRAMEBUFFER, layer);
  glViewport(0, 0, width * samples, height * samples);
  glClearColor(0, 0, 0, 0);
  glClear(GL_DEPTH_BUFFER_BIT | (samples > 1 ? GL_COLOR_BUFFER_BIT : 0));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  if (items.box.min().z() < scene.ground.height) passes->floor_depth(view, scene.ground);
  passes->solid(view, scene.light, items, shadow_map);

  // Pieces of glass do not hide one another: each starts from the depths of what is solid.
  if (items.glass.size() > 1) {
    if (!saved_depth) saved_depth = make_framebuffer(0, depth_texture(width * samples, height * samples));
    copy(layer, saved_depth, fine, GL_DEPTH_BUFFER_BIT);
  }
  for (size_t i = 0; i < items.glass.size(); ++i) {
    if (i > 0) copy(saved_depth, layer, fine, GL_DEPTH_BUFFER_BIT);
    glBindFramebuffer(GL_FRAMEBUFFER, layer);
    passes->glass(view, scene.light, items.glass[i], shadow_map);
  }
  if (samples > 1) {
    glBindFramebuffer(GL_FRAMEBUFFER, picture);
    glViewport(0, 0, width, height);
    glScissor(area[0], area[1], area[2], area[3]);
    passes->average(layer_colour);
  }
  glDisable(GL_SCISSOR_TEST);
}

// The picture into memory, top row first.
void Renderer::Impl::read(Image& out) {
  glBindFramebuffer(GL_FRAMEBUFFER, picture);
  rgba.resize(static_cast<size_t>(width) * height * 4);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  out.width = width;
  out.height = height;
  out.rgb.resize(static_cast<size_t>(width) * height * 3);
  for (int y = 0; y < height; ++y) {
    const uint8_t* from = rgba.data() + static_cast<size_t>(height - 1 - y) * width * 4;
    uint8_t* to = out.at(0, y);
    for (int x = 0; x < width; ++x, from += 4, to += 3) {
      to[0] = from[0];
      to[1] = from[1];
      to[2] = from[2];
    }
  }
}

Measurement Renderer::Impl::measure(const Scene& scene, const Camera& camera) {
  context->make_current();
  meshes.forget_dead();
  const ViewFrame view = make_view_frame(scene, camera, bounds(scene), width, height);
  const Items items = collect(scene, view, meshes);
  if (!measured)
    measured = make_framebuffer(make_texture(width, height, GL_RG32F, GL_RG, GL_FLOAT),
                                depth_texture(width, height));
  glBindFramebuffer(GL_FRAMEBUFFER, measured);
  glViewport(0, 0, width, height);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  const float nothing[4] = {std::numeric_limits<float>::infinity(), 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, nothing);
  glClear(GL_DEPTH_BUFFER_BIT);
  passes->measure(view, scene.ground, items);

  Measurement out;
  out.width = width;
  out.height = height;
  const size_t row = static_cast<size_t>(width);
  pairs.resize(row * height * 2);
  glReadPixels(0, 0, width, height, GL_RG, GL_FLOAT, pairs.data());
  out.depth.reserve(row * height);
  out.id.reserve(row * height);
  for (int y = height - 1; y >= 0; --y) {  // OpenGL's rows run upwards
    const float* from = pairs.data() + 2 * row * static_cast<size_t>(y);
    for (int x = 0; x < width; ++x, from += 2) {
      out.depth.push_back(from[0]);
      out.id.push_back(static_cast<uint16_t>(from[1]));
    }
  }
  check_gl("measuring");
  return out;
}

Renderer::Renderer(int width, int height, Quality quality)
    : impl_(std::make_unique<Impl>(width, height, quality)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::draw(const Scene& scene, const Camera& camera, Image& out) { impl_->draw(scene, camera, out); }

Image Renderer::draw(const Scene& scene, const Camera& camera) {
  Image out;
  draw(scene, camera, out);
  return out;
}

Measurement Renderer::measure(const Scene& scene, const Camera& camera) {
  return impl_->measure(scene, camera);
}

const std::string& Renderer::gl_info() const { return impl_->info; }

}  // namespace lab::render
