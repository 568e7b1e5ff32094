// Arrows, axes, beads and colour scales: bodies that explain a scene, put into it beside the robots.
// All are annotations: they are left out of depth and id images. Traces: trace.h.
#pragma once

#include <vector>

#include "render/scene.h"

namespace lab::render {

// A ball: a bead on a trace, a target.
Body make_bead(const Eigen::Vector3d& at, double radius, const Eigen::Vector4f& rgba);

// An arrow from `tail` along `vector` (metres), with a shaft of `radius`; a short one has only a head. A zero vector
// gives a body with nothing to draw.
Body make_arrow(const Eigen::Vector3d& tail, const Eigen::Vector3d& vector, double radius,
                const Eigen::Vector4f& rgba);

// Three arrows along a frame's axes: x red, y green, z blue.
Body make_axes(const Eigen::Isometry3d& frame, double length);

// The symbol of a centre of mass: a ball of black and white eighths.
Body make_com(const Eigen::Vector3d& at, double radius);

// A colour on the way from blue through violet to red, for t in 0..1 (clamped): time, first to last.
Eigen::Vector4f ramp_time(double t);
// A colour on the way from dark violet through teal to yellow (clamped; perceptually uniform):
// speeds and errors.
Eigen::Vector4f ramp_value(double t);

}  // namespace lab::render
