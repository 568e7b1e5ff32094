#include "render/shaders.h"

namespace lab::render::shaders {

const char* const kBodyVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 vertex_colour;
uniform mat4 u_clip_from_part;
uniform mat4 u_world_from_part;
uniform mat3 u_normal_from_part;
out vec3 v_world;
out vec3 v_normal;
#ifdef TEXTURE
out vec2 v_uv;
#endif
#ifdef COLOURS
out vec4 v_colour;
#endif
void main() {
  v_world = (u_world_from_part * vec4(position, 1.0)).xyz;
  v_normal = u_normal_from_part * normal;
#ifdef TEXTURE
  v_uv = uv;
#endif
#ifdef COLOURS
  v_colour = vertex_colour;
#endif
  gl_Position = u_clip_from_part * vec4(position, 1.0);
}
)";

const char* const kBodyFragment = R"(
uniform vec4 u_colour;  // linear rgb, alpha
uniform vec4 u_eye;     // its place and 1, or the direction towards it and 0
uniform vec3 u_sun, u_fill;
uniform float u_sun_strength;
uniform vec3 u_gloss;  // of the highlight: a = roughness^4, a - 1, strength
in vec3 v_world;
in vec3 v_normal;
out vec4 colour;
#if defined(TEXTURE) || defined(COLOURS)
uniform vec4 u_tint;  // linear rgb, how much of it
#endif
#ifdef TEXTURE
uniform sampler2D u_texture;
in vec2 v_uv;
#endif
#ifdef COLOURS
in vec4 v_colour;
#endif

#ifdef SHADOW
uniform mat4 u_shadow_from_world;
uniform sampler2DShadow u_shadow_map;
uniform float u_shadow_radius;  // of the blur, in texture units
uniform float u_shadow_lift;    // the same in metres, and a texel: along the normal, or a surface would shade itself
// Four comparisons on a cross that each of a pixel's 2x2 samples turns and widens differently: their average, taken
// later, has seen sixteen places.
float sun_seen(vec3 world) {
  vec3 p = (u_shadow_from_world * vec4(world, 1.0)).xyz;
  bool right = mod(gl_FragCoord.x, 2.0) > 1.0, upper = mod(gl_FragCoord.y, 2.0) > 1.0;
  vec2 turn = right ? (upper ? vec2(0.383, 0.924) : vec2(0.924, 0.383)) : (upper ? vec2(0.707, 0.707) : vec2(1.0, 0.0));
  vec2 a = u_shadow_radius * turn, b = vec2(-a.y, a.x);
  float inner = right == upper ? 0.35 : 0.6;
  float sum = texture(u_shadow_map, vec3(p.xy + a, p.z));
  sum += texture(u_shadow_map, vec3(p.xy - a * inner, p.z));
  sum += texture(u_shadow_map, vec3(p.xy + b * inner, p.z));
  sum += texture(u_shadow_map, vec3(p.xy - b, p.z));
  return 0.25 * sum;
}
#endif

void main() {
  vec4 base = u_colour;
#ifdef TEXTURE
  vec4 texel = texture(u_texture, v_uv);
  base *= vec4(texel.rgb * texel.rgb, texel.a);
#endif
#ifdef COLOURS
  base *= v_colour;
#endif
#if defined(TEXTURE) || defined(COLOURS)
  base.rgb = mix(base.rgb, u_tint.rgb, u_tint.a);
#endif
  vec3 n = normalize(v_normal);
  if (!gl_FrontFacing) n = -n;
  vec3 to_eye = normalize(u_eye.xyz - u_eye.w * v_world);
  float towards_sun = clamp(dot(n, u_sun), 0.0, 1.0);
  float sun = towards_sun * u_sun_strength;
#ifdef SHADOW
  // A plane seen under an angle a from its normal clears a blur of radius r if lifted by r sin a.
  if (towards_sun > 0.0)
    sun *= sun_seen(v_world + u_shadow_lift * (0.25 + sqrt(1.0 - towards_sun * towards_sun)) * n);
#endif
  float facing = clamp(dot(n, to_eye), 0.0, 1.0);
  float fill = clamp(dot(n, u_fill), 0.0, 1.0);
  // The highlight of microfacets (GGX with the usual short stand-ins for visibility and Fresnel).
  vec3 halfway = normalize(u_sun + to_eye);
  float nh = clamp(dot(n, halfway), 0.0, 1.0), lh = clamp(dot(u_sun, halfway), 0.316, 1.0);
  float d = nh * nh * u_gloss.y + 1.0;
  float glint = u_gloss.z * u_gloss.x / (d * d * lh * lh);
  // The sky above and its light sent back by the floor; what glances off mirrors it.
  vec3 above = vec3(0.235, 0.262, 0.300), below = vec3(0.064, 0.061, 0.058);
  vec3 sky = mix(below, above, 0.5 + 0.5 * n.z);
  float rim = (1.0 - facing) * (1.0 - facing);
  float mirrored = clamp(2.0 * facing * n.z - to_eye.z, -1.0, 1.0);
  vec3 glance = mix(below, above, clamp(0.5 + mirrored, 0.0, 1.0)) * (0.05 + 0.45 * rim * rim * (1.0 - u_gloss.x));
  vec3 light = sky + fill * vec3(0.062, 0.064, 0.070) + sun * vec3(0.80, 0.775, 0.73);
  vec3 lit = base.rgb * light + (sun * glint) * vec3(1.0, 0.97, 0.92) + glance;
  lit *= 1.0 - 0.16 * min(lit, 2.0);  // a shoulder: white surfaces in the sun keep their form
  colour = vec4(sqrt(min(lit, 1.0)), 1.0) * base.a;
}
)";

const char* const kDepthVertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 u_clip_from_part;
void main() { gl_Position = u_clip_from_part * vec4(position, 1.0); }
)";

const char* const kDepthFragment = "void main() {}\n";

const char* const kMeasureVertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 u_clip_from_part;
uniform vec4 u_depth_from_part;
out float v_depth;
void main() {
  v_depth = dot(u_depth_from_part, vec4(position, 1.0));
  gl_Position = u_clip_from_part * vec4(position, 1.0);
}
)";

const char* const kMeasureFragment = R"(
uniform float u_id;
in float v_depth;
out vec2 measured;
void main() {
  if (v_depth <= 0.0) discard;  // an orthographic picture reaches behind the eye
  measured = vec2(v_depth, u_id);
}
)";

const char* const kFloorVertex = R"(
uniform mat4 u_clip_from_world;
uniform vec4 u_rectangle;  // lower x, y, upper x, y
uniform float u_height;
out vec2 v_floor;
void main() {
  v_floor = mix(u_rectangle.xy, u_rectangle.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1));
  gl_Position = u_clip_from_world * vec4(v_floor, u_height, 1.0);
}
)";

#define LAB_FADE_GLSL                                                                   \
  "uniform vec3 u_disk;\n" /* centre x, y and radius of the floor */                    \
  "float fade(vec2 place) {\n"                                                          \
  "  float left = 1.0 - smoothstep(0.06, 1.0, length(place - u_disk.xy) / u_disk.z);\n" \
  "  return left * left;\n"                                                             \
  "}\n"

const char* const kFloorFragment = LAB_FADE_GLSL R"(
uniform float u_spacing;  // metres between main lines; fine ones stand five times as close
in vec2 v_floor;
out vec4 colour;

// How much of this pixel lines at whole numbers cover, `width` pixels wide, fading where they crowd.
vec2 lines(vec2 place, vec2 per_pixel, float width) {
  vec2 off = abs(fract(place - 0.5) - 0.5) / per_pixel;
  vec2 cover = clamp(0.5 * width + 0.5 - off, 0.0, 1.0);
  return cover * (1.0 - smoothstep(0.05, 0.40, per_pixel));
}

void main() {
  vec2 place = v_floor / u_spacing;
  vec2 d = fwidth(place);
  vec2 fine = lines(place * 5.0, d * 5.0, 1.0), coarse = lines(place, d, 1.0);
  vec3 c = vec3(0.607, 0.622, 0.640);
  c = mix(c, vec3(0.43, 0.445, 0.465), 0.55 * max(fine.x, fine.y));
  c = mix(c, vec3(0.155, 0.165, 0.18), 0.75 * max(coarse.x, coarse.y));
  // The world's axes: +x red, +y green.
  vec2 off = abs(place) / d;
  vec2 axis = clamp(vec2(1.1) - off.yx, 0.0, 1.0) * step(vec2(0.0), place);
  c = mix(c, vec3(0.62, 0.045, 0.03), 0.9 * axis.x);
  c = mix(c, vec3(0.035, 0.32, 0.05), 0.9 * axis.y);
  colour = vec4(sqrt(c), fade(v_floor));
}
)";

const char* const kFloorMeasureFragment = R"(
uniform vec4 u_depth_from_world;
uniform vec3 u_disk;
uniform float u_height;
in vec2 v_floor;
out vec2 measured;
void main() {
  float depth = dot(u_depth_from_world, vec4(v_floor, u_height, 1.0));
  if (depth <= 0.0 || length(v_floor - u_disk.xy) > u_disk.z) discard;
  measured = vec2(depth, 0.0);
}
)";

const char* const kFloorShadowFragment = LAB_FADE_GLSL R"(
uniform mat4 u_shadow_from_world;
uniform sampler2DShadow u_shadow_map;
uniform sampler2D u_shadow_depth;  // the same map, read as numbers
uniform vec3 u_penumbra;           // least and largest radius of the blur, growth per difference of depth
uniform vec2 u_places[PLACES];     // on a disk of radius 1
uniform float u_height, u_sun_strength;
in vec2 v_floor;
out vec4 colour;

void main() {
  vec3 p = (u_shadow_from_world * vec4(v_floor, u_height, 1.0)).xyz;
  // The higher what casts the shadow, the softer its edge: the sun is no point.
  float blockers = 0.0, depth = 0.0;
  for (int i = -1; i < PLACES; i += 2) {  // the middle first: a thin thing may lie there alone
    vec2 off = i < 0 ? vec2(0.0) : u_penumbra.y * u_places[i];
    float z = texture(u_shadow_depth, p.xy + off).r;
    float blocks = step(z, p.z - 0.0005);
    blockers += blocks;
    depth += blocks * z;
  }
  if (blockers == 0.0) discard;
  float radius = clamp((p.z - depth / blockers) * u_penumbra.z, u_penumbra.x, u_penumbra.y);
  float sum = 0.0;
  for (int i = 0; i < PLACES; ++i) sum += texture(u_shadow_map, vec3(p.xy + radius * u_places[i], p.z));
  vec3 dark = mix(vec3(0.23, 0.24, 0.26), vec3(1.0), mix(1.0, sum / float(PLACES), min(u_sun_strength, 1.0)));
  colour = vec4(mix(vec3(1.0), sqrt(dark), fade(v_floor)), 1.0);  // multiplies what is there
}
)";

const char* const kSkyVertex = R"(
uniform mat4 u_world_from_clip;  // without translation
out vec3 v_sight;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;  // one triangle over the whole picture
  v_sight = (u_world_from_clip * vec4(corner, 1.0, 1.0)).xyz;
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

const char* const kSkyFragment = R"(
in vec3 v_sight;
out vec4 colour;
void main() {
  float up = normalize(v_sight).z;
  vec3 horizon = vec3(0.648, 0.686, 0.752), zenith = vec3(0.36, 0.47, 0.66), below = vec3(0.607, 0.622, 0.640);
  vec3 c = up > 0.0 ? mix(horizon, zenith, smoothstep(0.0, 0.9, up)) : mix(horizon, below, smoothstep(0.0, 0.6, -up));
  colour = vec4(sqrt(c), 1.0);
}
)";

const char* const kAverageVertex = R"(
out vec2 v_place;
void main() {
  v_place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  gl_Position = vec4(v_place * 2.0 - 1.0, 0.0, 1.0);
}
)";

const char* const kAverageFragment = R"(
uniform sampler2D u_samples;  // twice as wide and high: a bilinear look between four samples is their average
in vec2 v_place;
out vec4 colour;
void main() { colour = texture(u_samples, v_place); }
)";

}  // namespace lab::render::shaders
