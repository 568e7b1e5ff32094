// The renderer's GLSL. Light is added up in linear space; colours come in squared (a cheap stand-in for sRGB
// decoding, done once per surface on the CPU) and leave through a square root. SHADOW is defined when there
// is a shadow map.
#pragma once

namespace lab::render::shaders {

// Solid surfaces: one sun, a sky that is brighter above than below, a soft highlight. Colour times alpha,
// alpha.
extern const char* const kBodyVertex;
extern const char* const kBodyFragment;
// Depth only.
extern const char* const kDepthVertex;
extern const char* const kDepthFragment;
// The floor: grid lines of constant width on screen that fade where they would crowd, and into the sky far
// away.
extern const char* const kFloorVertex;
extern const char* const kFloorFragment;
// The shadow on it: a factor.
extern const char* const kFloorShadowFragment;
// A gradient over the elevation of the line of sight.
extern const char* const kSkyVertex;
extern const char* const kSkyFragment;
// Four samples into one pixel.
extern const char* const kAverageVertex;
extern const char* const kAverageFragment;

}  // namespace lab::render::shaders
