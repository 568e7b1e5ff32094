// The renderer's GLSL. Light is added up in linear space; colours come in squared (a cheap stand-in for sRGB
// decoding, done once per surface on the CPU) and leave through a square root. A body's shaders come in
// variants: SHADOW with a shadow map, TEXTURE and COLOURS for meshes that bring these.
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
// The floor: grid lines of constant width on screen that fade where they would crowd, and into the sky far
// away.
extern const char* const kFloorVertex;
extern const char* const kFloorFragment;
extern const char* const kFloorMeasureFragment;
// The shadow on it, softer the farther it falls: a factor.
extern const char* const kFloorShadowFragment;
// A gradient over the elevation of the line of sight.
extern const char* const kSkyVertex;
extern const char* const kSkyFragment;
// Four samples into one pixel.
extern const char* const kAverageVertex;
extern const char* const kAverageFragment;

}  // namespace lab::render::shaders
