#include "render/renderer.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "render/context.h"
#include "render/gl.h"
#include "render/shaders.h"
#include "render/shadow.h"

namespace lab::render {
namespace {

using Eigen::Affine3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4f;

constexpr int kMaxSide = 4096;
constexpr int64_t kMaxPixels = 4096 * 2304;
constexpr int kShadowSide = 1024;
constexpr float kShadowBlur = 0.0045f;  // radius, as part of the shadow map's side

// One surface of one part, ready to draw.
struct Item {
  const Buffers* buffers;
  const Surface* surface;
  Affine3d world_from_part;
  Vector4f rgba;
  double distance;  // of its part's centre from the eye
  bool mirrored, casts_shadow;
};

// What all draw calls of a frame share.
struct Sight {
  Vector3d eye, sun;
  Matrix4d clip_from_world, sight_from_clip;  // the second without translation: directions
  bool floor_seen = false;
  Eigen::Vector2d floor_centre;
  double floor_radius = 0;
  ShadowView shadow;

  Eigen::AlignedBox2d floor() const {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(floor_radius);
    return {floor_centre - half, floor_centre + half};
  }
  Matrix4d shadow_from_world() const {  // texture coordinates and depth, 0..1
    Matrix4d m = Matrix4d::Identity();
    m.topLeftCorner<3, 3>() *= 0.5;
    m.topRightCorner<3, 1>().setConstant(0.5);
    return m * shadow.clip_from_world;
  }
};

Eigen::Matrix4f to_float(const Matrix4d& m) { return m.cast<float>(); }

std::string gl_string(unsigned name) {
  const unsigned char* text = glGetString(name);
  return text ? reinterpret_cast<const char*>(text) : "?";
}

void draw_surface(const Item& item) {
  glBindVertexArray(item.buffers->array);
  glFrontFace(item.mirrored ? GL_CW : GL_CCW);
  item.surface->two_sided ? glDisable(GL_CULL_FACE) : glEnable(GL_CULL_FACE);
  glDrawElements(GL_TRIANGLES, static_cast<int>(item.surface->count), GL_UNSIGNED_INT,
                 reinterpret_cast<void*>(static_cast<uintptr_t>(item.surface->first) * sizeof(uint32_t)));
}

}  // namespace

Quality quality_from_name(const std::string& name) {
  if (name == "draft") return Quality::kDraft;
  if (name == "live") return Quality::kLive;
  if (name == "fine") return Quality::kFine;
  throw std::invalid_argument("renderer: unknown quality '" + name + "' (known: draft, live, fine)");
}

// A frame is built in two layers. The background (sky, floor, shadow on the floor) has soft edges by its own
// arithmetic and is drawn once per pixel. Bodies are drawn with 2x2 samples on a transparent layer of their
// own, whose average is laid over the background. (In draft quality they go straight onto it.)
struct Renderer::Impl {
  int width, height;
  int samples;  // along one side of a pixel
  bool shadow;
  std::unique_ptr<Context> context;
  std::string info;
  MeshStore meshes;
  std::unique_ptr<Program> body, depth_only, sky, floor, floor_depth, floor_shadow, average;
  unsigned picture = 0, layer = 0, layer_colour = 0, shadow_target = 0, shadow_map = 0;
  unsigned no_array = 0;  // core profile wants one bound even when no vertex is read
  std::vector<uint8_t> rgba;

  Impl(int w, int h, Quality quality);
  std::vector<Item> collect(const Scene& scene, const Vector3d& eye);
  Sight look(const Scene& scene, const Camera& camera) const;
  void draw_shadow_map(const std::vector<Item>& items, const Sight& sight);
  void draw_background(const Scene& scene, const Sight& sight);
  void draw_bodies(const Scene& scene, const Sight& sight, const std::vector<Item>& items);
  void begin_items(const Scene& scene, const Sight& sight);
  void draw_item(const Item& item, const Sight& sight);
  void draw_floor(const Program& program, const Scene& scene, const Sight& sight,
                  const Eigen::AlignedBox2d& area);
  void draw(const Scene& scene, const Camera& camera, Image& out);
  void read(Image& out);
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

  const auto program = [](const char* name, const char* vertex, const char* fragment,
                          const char* defines = "") {
    return std::make_unique<Program>(name, defines, vertex, fragment);
  };
  body = program("body", shaders::kBodyVertex, shaders::kBodyFragment, shadow ? "#define SHADOW\n" : "");
  depth_only = program("depth", shaders::kDepthVertex, shaders::kDepthFragment);
  sky = program("sky", shaders::kSkyVertex, shaders::kSkyFragment);
  floor = program("floor", shaders::kFloorVertex, shaders::kFloorFragment);
  floor_depth = program("floor depth", shaders::kFloorVertex, shaders::kDepthFragment);

  const auto depth = [](int dw, int dh) {
    return make_texture(dw, dh, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT);
  };
  const unsigned colour = make_texture(w, h, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
  if (samples == 1) {
    picture = layer = make_framebuffer(colour, depth(w, h));
  } else {
    average = program("average", shaders::kAverageVertex, shaders::kAverageFragment);
    picture = make_framebuffer(colour, 0);
    layer_colour = make_texture(2 * w, 2 * h, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
    layer = make_framebuffer(layer_colour, depth(2 * w, 2 * h));
  }
  if (shadow) {
    floor_shadow = program("floor shadow", shaders::kFloorVertex, shaders::kFloorShadowFragment);
    shadow_map = depth(kShadowSide, kShadowSide);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    shadow_target = make_framebuffer(0, shadow_map);
  }
  glGenVertexArrays(1, &no_array);
  check_gl("setting up the renderer");
}

std::vector<Item> Renderer::Impl::collect(const Scene& scene, const Vector3d& eye) {
  std::vector<Item> items;
  for (const Body& body : scene.bodies) {
    if (!body.visible) continue;
    for (const Part& part : body.parts) {
      if (!part.mesh || part.mesh->indices.empty()) continue;
      if (!body.pose.matrix().allFinite() || !part.pose.matrix().allFinite() || !part.scale.allFinite() ||
          !part.rgba.allFinite())
        throw std::invalid_argument("renderer: body '" + body.name +
                                    "': a pose, scale or colour is not finite");
      if (part.scale.prod() == 0)
        throw std::invalid_argument("renderer: body '" + body.name +
                                    "': a scale of 0 leaves nothing to draw");
      const Affine3d world_from_part = Affine3d(body.pose * part.pose) * Eigen::Scaling(part.scale);
      const double distance = (world_from_part * part.mesh->bounds.center() - eye).norm();
      const bool mirrored = part.scale.prod() < 0;
      const Buffers& mesh = meshes.get(part.mesh);
      for (const Surface& surface : part.mesh->surfaces) {
        const Vector4f& rgba = surface.coloured && !part.repaint ? surface.rgba : part.rgba;
        items.push_back({&mesh, &surface, world_from_part, rgba.cwiseMax(0.f).cwiseMin(1.f), distance,
                         mirrored, body.casts_shadow});
      }
    }
  }
  return items;
}

Sight Renderer::Impl::look(const Scene& scene, const Camera& camera) const {
  Sight s;
  s.eye = camera.eye;
  const double reach = (camera.eye - camera.target).norm(), above = camera.eye.z() - scene.ground.height;
  s.floor_seen = scene.ground.visible && above > 0;
  s.floor_centre = camera.target.head<2>();
  s.floor_radius = 7 * std::max(reach, above);
  // Depth range: from close to the eye to behind both the bodies and the end of the floor.
  double far = reach + 2 * s.floor_radius;
  const Bounds box = bounds(scene);
  if (!box.isEmpty()) far = std::max(far, (box.center() - camera.eye).norm() + box.diagonal().norm());
  const Matrix4d projection = camera.projection(static_cast<double>(width) / height, 0.01 * reach, far);
  Matrix4d view = camera.view().matrix();
  s.clip_from_world = projection * view;
  view.topRightCorner<3, 1>().setZero();
  s.sight_from_clip = (projection * view).inverse();

  s.sun = scene.light.towards.normalized();
  if (!s.sun.allFinite() || s.sun.norm() < 0.5 || !(scene.light.strength >= 0 && scene.light.strength <= 100))
    throw std::invalid_argument("renderer: the light needs a direction and a strength of 0 to 100");
  if (!std::isfinite(scene.ground.height) || !(scene.ground.spacing > 0) ||
      !std::isfinite(scene.ground.spacing))
    throw std::invalid_argument("renderer: the floor needs a finite height and a positive grid spacing");
  if (shadow) s.shadow = fit_shadow(scene, s.sun);
  return s;
}

// All casters as the sun sees them.
void Renderer::Impl::draw_shadow_map(const std::vector<Item>& items, const Sight& sight) {
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_target);
  glViewport(0, 0, kShadowSide, kShadowSide);
  glClear(GL_DEPTH_BUFFER_BIT);
  glDepthFunc(GL_LESS);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 4.0f);
  depth_only->use();
  for (const Item& item : items) {
    if (!item.casts_shadow) continue;
    depth_only->set("u_clip_from_part",
                    to_float(sight.shadow.clip_from_world * item.world_from_part.matrix()));
    draw_surface(item);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Renderer::Impl::draw_floor(const Program& program, const Scene& scene, const Sight& sight,
                                const Eigen::AlignedBox2d& area) {
  program.use();
  program.set("u_clip_from_world", to_float(sight.clip_from_world));
  program.set("u_height", static_cast<float>(scene.ground.height));
  const Eigen::Vector4d rectangle(area.min().x(), area.min().y(), area.max().x(), area.max().y());
  program.set("u_rectangle", Vector4f(rectangle.cast<float>()));
  glBindVertexArray(no_array);
  glDisable(GL_CULL_FACE);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

void Renderer::Impl::draw_background(const Scene& scene, const Sight& sight) {
  glBindFramebuffer(GL_FRAMEBUFFER, picture);
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(no_array);
  glDisable(GL_CULL_FACE);
  sky->use();
  sky->set("u_world_from_clip", to_float(sight.sight_from_clip));
  glDrawArrays(GL_TRIANGLES, 0, 3);
  if (!sight.floor_seen) return;

  const Eigen::Vector3f disk(static_cast<float>(sight.floor_centre.x()),
                             static_cast<float>(sight.floor_centre.y()),
                             static_cast<float>(sight.floor_radius));
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
  floor->use();
  floor->set("u_disk", disk);
  floor->set("u_spacing", static_cast<float>(scene.ground.spacing));
  draw_floor(*floor, scene, sight, sight.floor());
  if (shadow && !sight.shadow.on_floor.isEmpty()) {
    glBlendFunc(GL_DST_COLOR, GL_ZERO);
    floor_shadow->use();
    floor_shadow->set("u_disk", disk);
    floor_shadow->set("u_sun_strength", scene.light.strength);
    floor_shadow->set("u_shadow_from_world", to_float(sight.shadow_from_world()));
    floor_shadow->set("u_shadow_radius", kShadowBlur);
    draw_floor(*floor_shadow, scene, sight, sight.shadow.on_floor);
  }
  glDisable(GL_BLEND);
}

void Renderer::Impl::draw_bodies(const Scene& scene, const Sight& sight, const std::vector<Item>& items) {
  glBindFramebuffer(GL_FRAMEBUFFER, layer);
  glViewport(0, 0, width * samples, height * samples);
  glClearColor(0, 0, 0, 0);
  glClear(GL_DEPTH_BUFFER_BIT | (samples > 1 ? GL_COLOR_BUFFER_BIT : 0));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  if (sight.floor_seen) {  // hides what is under it
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_floor(*floor_depth, scene, sight, sight.floor());
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  begin_items(scene, sight);
  for (const Item& item : items)
    if (item.rgba[3] >= 1) draw_item(item, sight);

  // Glassy surfaces from far to near; each first as depth alone, so that its own inside does not show
  // through. (Sorted by pointer: libstdc++'s stable_sort ignores that an Item is over-aligned.)
  std::vector<const Item*> glassy;
  for (const Item& item : items)
    if (item.rgba[3] > 0 && item.rgba[3] < 1) glassy.push_back(&item);
  std::stable_sort(glassy.begin(), glassy.end(),
                   [](const Item* a, const Item* b) { return a->distance > b->distance; });
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  for (const Item* item : glassy) {
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_item(*item, sight);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    draw_item(*item, sight);
  }
  if (samples > 1) {
    glBindFramebuffer(GL_FRAMEBUFFER, picture);
    glViewport(0, 0, width, height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glBindVertexArray(no_array);
    glBindTexture(GL_TEXTURE_2D, layer_colour);
    average->use();
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  glDisable(GL_BLEND);
}

void Renderer::Impl::begin_items(const Scene& scene, const Sight& sight) {
  body->use();
  body->set("u_eye", Eigen::Vector3f(sight.eye.cast<float>()));
  body->set("u_sun", Eigen::Vector3f(sight.sun.cast<float>()));
  body->set("u_sun_strength", scene.light.strength);
  if (!shadow) return;
  body->set("u_shadow_from_world", to_float(sight.shadow_from_world()));
  body->set("u_shadow_radius", kShadowBlur);
  body->set("u_shadow_lift", static_cast<float>((kShadowBlur + 1.5 / kShadowSide) * sight.shadow.side));
}

void Renderer::Impl::draw_item(const Item& item, const Sight& sight) {
  const Vector4f& c = item.rgba;
  body->set("u_clip_from_part", to_float(sight.clip_from_world * item.world_from_part.matrix()));
  body->set("u_world_from_part", to_float(item.world_from_part.matrix()));
  const Eigen::Matrix3d normals = item.world_from_part.linear().inverse().transpose();
  body->set("u_normal_from_part", Eigen::Matrix3f(normals.cast<float>()));
  body->set("u_colour", Vector4f(c[0] * c[0], c[1] * c[1], c[2] * c[2], c[3]));
  draw_surface(item);
}

void Renderer::Impl::draw(const Scene& scene, const Camera& camera, Image& out) {
  context->make_current();
  meshes.forget_dead();
  const Sight sight = look(scene, camera);
  const std::vector<Item> items = collect(scene, camera.eye);
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  if (shadow) {
    draw_shadow_map(items, sight);
    glBindTexture(GL_TEXTURE_2D, shadow_map);
  }
  draw_background(scene, sight);
  draw_bodies(scene, sight, items);
  read(out);
  check_gl("drawing");
}

// The picture into memory, top row first.
void Renderer::Impl::read(Image& out) {
  glBindFramebuffer(GL_FRAMEBUFFER, picture);
  rgba.resize(static_cast<size_t>(width) * height * 4);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  out.width = width, out.height = height;
  out.rgb.resize(static_cast<size_t>(width) * height * 3);
  for (int y = 0; y < height; ++y) {
    const uint8_t* from = rgba.data() + static_cast<size_t>(height - 1 - y) * width * 4;
    uint8_t* to = out.at(0, y);
    for (int x = 0; x < width; ++x, from += 4, to += 3) to[0] = from[0], to[1] = from[1], to[2] = from[2];
  }
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

const std::string& Renderer::gl_info() const { return impl_->info; }

}  // namespace lab::render
