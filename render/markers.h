// Things that are not there but worth seeing: bodies to put into a scene beside the robots. All are
// annotations: they are left out of depth and id images.
#pragma once

#include <vector>

#include "render/scene.h"

namespace lab::render {

// A tube through the points, its colour running from point to point (sRGB; one colour for each point, or one
// for all). Repeated points are skipped; fewer than two different ones give a body with nothing to draw. A
// radius of 0.004 times the picture's width in metres looks well. Throws std::invalid_argument for a
// non-finite point, a radius that is not positive, a wrong number of colours.
Body make_trace(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector4f>& colours,
                double radius);

// A ball: a bead on a trace, a target.
Body make_bead(const Eigen::Vector3d& at, double radius, const Eigen::Vector4f& rgba);

// An arrow from `tail` along `vector` (metres), `radius` its shaft's; a short one is all head. A zero vector
// gives a body with nothing to draw.
Body make_arrow(const Eigen::Vector3d& tail, const Eigen::Vector3d& vector, double radius,
                const Eigen::Vector4f& rgba);

// Three arrows along a frame's axes: x red, y green, z blue.
Body make_axes(const Eigen::Isometry3d& frame, double length);

// The sign of a centre of mass: a ball of black and white eighths.
Body make_com(const Eigen::Vector3d& at, double radius);

// A colour on the way from blue through violet to red, for t in 0..1 (clamped): time, first to last.
Eigen::Vector4f ramp_time(double t);
// A colour on the way from dark violet through teal to yellow (clamped; every step looks alike to the eye):
// speeds and errors.
Eigen::Vector4f ramp_value(double t);

}  // namespace lab::render
