#include "render/passes.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "render/shaders.h"

namespace lab::render {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr float kShadowBlur = 0.0045f;  // radius on bodies, as part of the shadow map's side
constexpr int kPlaces = 32;             // looked at around a point of the floor
constexpr double kSunSize = 0.045;      // tangent of the sun's apparent radius, wider than nature's

Eigen::Matrix4f to_float(const Matrix4d& m) { return m.cast<float>(); }
Vector4f linear(const Vector4f& c) { return {c[0] * c[0], c[1] * c[1], c[2] * c[2], c[3]}; }

void bind(unsigned unit, unsigned texture) {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_2D, texture);
  glActiveTexture(GL_TEXTURE0);
}

void set_sides(bool mirrored, bool two_sided) {
  glFrontFace(mirrored ? GL_CW : GL_CCW);
  two_sided ? glDisable(GL_CULL_FACE) : glEnable(GL_CULL_FACE);
}

// Software OpenGL fills the triangles of one batch while the next is put together, but only once it is told
// to.
class Batches {
 public:
  void add(size_t triangles) {
    waiting_ += triangles;
    if (waiting_ < 8'000) return;
    glFlush();
    waiting_ = 0;
  }

 private:
  size_t waiting_ = 0;
};

Matrix4d clip_from_part(const ViewFrame& view, const Item& item) {
  return view.clip_from_world * item.world_from_part.matrix();
}

// A weak light from the other side than the sun: shaded sides keep their form.
Vector3d fill_light(const Vector3d& sun) { return Vector3d(-sun.x(), -sun.y(), 0.25).normalized(); }

Vector3f disk(const ViewFrame& view) {
  return {static_cast<float>(view.floor_centre.x()), static_cast<float>(view.floor_centre.y()),
          static_cast<float>(view.floor_radius)};
}

// Places on a disk that cover it evenly and without a pattern.
std::vector<Eigen::Vector2f> sunflower() {
  std::vector<Eigen::Vector2f> places;
  for (int i = 0; i < kPlaces; ++i) {
    const double r = std::sqrt((i + 0.5) / kPlaces), turn = 2.399963 * i;  // the golden angle
    places.push_back(Eigen::Vector2d(r * std::cos(turn), r * std::sin(turn)).cast<float>());
  }
  return places;
}

}  // namespace

// Texture units: 0 the shadow map compared (or the samples to average), 1 a surface's texture, 2 the shadow
// map read as numbers.
Passes::Passes(bool shadow) : shadow_(shadow) {
  glGenVertexArrays(1, &no_array_);
  if (!shadow) return;
  glGenSamplers(2, samplers_);
  for (unsigned sampler : samplers_) {
    glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  glSamplerParameteri(samplers_[1], GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glSamplerParameteri(samplers_[1], GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glBindSampler(2, samplers_[0]);
  glBindSampler(3, samplers_[1]);
}

const Program& Passes::lazily(std::unique_ptr<Program>& program, const char* name, const char* vertex,
                              const char* fragment, const char* defines) {
  if (!program) program = std::make_unique<Program>(name, defines, vertex, fragment);
  program->use();
  return *program;
}

void Passes::triangle_over_all() {
  glBindVertexArray(no_array_);
  glDisable(GL_CULL_FACE);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Passes::draw_floor(const Program& program, const ViewFrame& view, const Ground& ground,
                        const Eigen::AlignedBox2d& area) {
  program.set("u_clip_from_world", to_float(view.clip_from_world));
  program.set("u_height", static_cast<float>(ground.height));
  const Eigen::Vector4d rectangle(area.min().x(), area.min().y(), area.max().x(), area.max().y());
  program.set("u_rectangle", Vector4f(rectangle.cast<float>()));
  glBindVertexArray(no_array_);
  glDisable(GL_CULL_FACE);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

void Passes::background(const ViewFrame& view, const Ground& ground) {
  glDisable(GL_DEPTH_TEST);
  lazily(sky_, "sky", shaders::kSkyVertex, shaders::kSkyFragment)
      .set("u_world_from_clip", to_float(view.ray_from_clip));
  triangle_over_all();
  if (!view.floor_visible) return;
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
  const Program& floor = lazily(floor_, "floor", shaders::kFloorVertex, shaders::kFloorFragment);
  floor.set("u_disk", disk(view));
  floor.set("u_spacing", static_cast<float>(ground.spacing));
  draw_floor(floor, view, ground, view.floor());
  glDisable(GL_BLEND);
}

void Passes::shadow_map(const ViewFrame& view, const Items& items) {
  glViewport(0, 0, kShadowSide, kShadowSide);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 4.0f);
  const Program& depth = lazily(depth_, "depth", shaders::kDepthVertex, shaders::kDepthFragment);
  Batches batches;
  for (const Caster& caster : items.casters) {
    depth.set("u_clip_from_part", to_float(view.shadow.clip_from_world * caster.world_from_part.matrix()));
    set_sides(caster.mirrored, caster.two_sided);
    batches.add(draw_coarse(*caster.mesh));
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Passes::floor_shadow(const ViewFrame& view, const Scene& scene, unsigned shadow_map) {
  if (!view.floor_visible || view.shadow.on_floor.isEmpty()) return;
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_DST_COLOR, GL_ZERO);
  bind(0, shadow_map);
  bind(2, shadow_map);
  const Program& p =
      lazily(floor_shadow_, "floor shadow", shaders::kFloorVertex, shaders::kFloorShadowFragment,
             ("#define PLACES " + std::to_string(kPlaces) + "\n").c_str());
  p.set("u_shadow_depth", 2);
  p.set("u_places", sunflower());
  p.set("u_disk", disk(view));
  p.set("u_sun_strength", scene.light.strength);
  p.set("u_shadow_from_world", to_float(view.shadow_from_world()));
  p.set("u_penumbra", Vector3f(1.2f / kShadowSide, 0.016f,
                               static_cast<float>(kSunSize * view.shadow.depth / view.shadow.side)));
  draw_floor(p, view, scene.ground, view.shadow.on_floor);
  glDisable(GL_BLEND);
}

void Passes::floor_depth(const ViewFrame& view, const Ground& ground) {
  if (!view.floor_visible) return;
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_floor(lazily(floor_depth_, "floor depth", shaders::kFloorVertex, shaders::kDepthFragment), view,
             ground, view.floor());
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

// The program for an item, with all that is the same for the whole frame.
const Program& Passes::body(const Item& item, const ViewFrame& view, const Light& light,
                            unsigned shadow_map) {
  const bool textured = item.texture != 0, coloured = item.mesh->has_colours;
  std::string defines = shadow_ ? "#define SHADOW\n" : "";
  if (textured) defines += "#define TEXTURE\n";
  if (coloured) defines += "#define COLOURS\n";
  const Program& p = lazily(bodies_[textured + 2 * coloured], "body", shaders::kBodyVertex,
                            shaders::kBodyFragment, defines.c_str());
  p.set("u_eye", Vector4f(view.eye.cast<float>()));
  p.set("u_sun", Vector3f(view.sun.cast<float>()));
  p.set("u_fill", Vector3f(fill_light(view.sun).cast<float>()));
  p.set("u_sun_strength", light.strength);
  if (textured) p.set("u_texture", 1);
  if (!shadow_) return p;
  bind(3, shadow_map);
  p.set("u_shadow_map", 3);
  p.set("u_shadow_from_world", to_float(view.shadow_from_world()));
  p.set("u_shadow_radius", kShadowBlur);
  p.set("u_shadow_lift", static_cast<float>((kShadowBlur + 1.5 / kShadowSide) * view.shadow.side));
  return p;
}

void Passes::draw_items(const ViewFrame& view, const Light& light, const std::vector<const Item*>& items,
                        unsigned shadow_map) {
  Batches batches;
  for (int kind = 0; kind < 4; ++kind) {  // one program after the other
    const Program* p = nullptr;
    for (const Item* item : items) {
      if ((item->texture != 0) + 2 * item->mesh->has_colours != kind) continue;
      if (!p) p = &body(*item, view, light, shadow_map);
      if (item->texture) bind(1, item->texture);
      Vector4f colour = linear(item->rgba);
      const Vector4f tint = linear(item->tint);
      if (kind > 0)
        p->set("u_tint", tint);
      else
        colour.head<3>() += tint[3] * (tint.head<3>() - colour.head<3>());
      const float rough = item->roughness * item->roughness, a = rough * rough;
      p->set("u_colour", colour);
      p->set("u_gloss", Vector3f(a, a - 1, 0.04f / (4 * item->roughness + 2)));
      p->set("u_clip_from_part", to_float(clip_from_part(view, *item)));
      p->set("u_world_from_part", to_float(item->world_from_part.matrix()));
      const Eigen::Matrix3d normals = item->world_from_part.linear().inverse().transpose();
      p->set("u_normal_from_part", Eigen::Matrix3f(normals.cast<float>()));
      set_sides(item->mirrored, item->two_sided);
      batches.add(draw_surface(*item->mesh, item->surface, item->viewer));
    }
  }
}

void Passes::solid(const ViewFrame& view, const Light& light, const Items& items, unsigned shadow_map) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  draw_items(view, light, items.solid, shadow_map);
}

void Passes::glass(const ViewFrame& view, const Light& light, const Glass& piece, unsigned shadow_map) {
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  // Where a ghost stands in the solid robot (its base, as a rule) the robot must win, not flicker.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(2.f, 200.f);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_items(view, light, piece, shadow_map);  // the same programs: exactly the same depths
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthFunc(GL_EQUAL);
  glDepthMask(GL_FALSE);
  draw_items(view, light, piece, shadow_map);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_BLEND);
}

void Passes::average(unsigned samples) {
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  bind(0, samples);
  lazily(average_, "average", shaders::kAverageVertex, shaders::kAverageFragment);
  triangle_over_all();
  glDisable(GL_BLEND);
}

void Passes::measure(const ViewFrame& view, const Ground& ground, const Items& items) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  if (view.floor_visible) {
    const Program& floor =
        lazily(floor_measure_, "floor measure", shaders::kFloorVertex, shaders::kFloorMeasureFragment);
    floor.set("u_depth_from_world", Vector4f(view.depth_from_world.cast<float>()));
    floor.set("u_disk", disk(view));
    draw_floor(floor, view, ground, view.floor());
  }
  const Program& p = lazily(measure_, "measure", shaders::kMeasureVertex, shaders::kMeasureFragment);
  for (const Item& item : items.all) {
    if (item.annotation) continue;
    p.set("u_clip_from_part", to_float(clip_from_part(view, item)));
    const Eigen::Vector4d depth = item.world_from_part.matrix().transpose() * view.depth_from_world;
    p.set("u_depth_from_part", Vector4f(depth.cast<float>()));
    p.set("u_id", static_cast<float>(item.id));
    set_sides(item.mirrored, item.two_sided);
    draw_surface(*item.mesh, item.surface, item.viewer);
  }
}

}  // namespace lab::render
