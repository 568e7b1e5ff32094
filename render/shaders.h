// The renderer's GLSL. Lighting is computed in linear space; input colours are squared (a cheap approximation of sRGB
// decoding, once per surface on the CPU), and the output is the square root. A body's shaders have variants:
// SHADOW with a shadow map, TEXTURE and COLOURS for meshes that have them.
#pragma once

namespace lab::render::shaders {

// Surfaces: a sun with a highlight, a weak fill light, a sky that is brighter above than below and mirrored
// at glancing angles. Colour times alpha, alpha.
extern const char* const kBodyVertex;
extern const char* const kBodyFragment;
// Depth only.
extern const char* const kDepthVertex;
extern const char* const kDepthFragment;
// Metres along the view direction and an id.
extern const char* const kMeasureVertex;
extern const char* const kMeasureFragment;
// The floor: grid lines of constant width on screen that fade where they get too dense, and into the sky far
// away.
extern const char* const kFloorVertex;
extern const char* const kFloorFragment;
extern const char* const kFloorMeasureFragment;
// The shadow on the floor as a factor, softer with distance from the caster.
extern const char* const kFloorShadowFragment;
// A gradient over the elevation of the line of sight.
extern const char* const kSkyVertex;
extern const char* const kSkyFragment;
// Four samples into one pixel.
extern const char* const kAverageVertex;
extern const char* const kAverageFragment;

}  // namespace lab::render::shaders
