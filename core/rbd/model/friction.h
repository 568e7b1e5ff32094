// Damping and dry friction of a joint: efforts, slopes, and the speed below which dry friction is smoothed. The
// algorithms count them as Model::terms says; these functions are for programs that need the numbers themselves.
#pragma once

#include <cmath>

namespace rbd {

// Dry friction is friction * tanh(v / kSlipSpeed), rad/s or m/s: a slower joint creeps instead of sticking.
inline constexpr double kSlipSpeed = 0.01;

// Effort against a motion with v: N m or N.
inline double frictionEffort(double damping, double friction, double v) {
  return damping * v + friction * std::tanh(v / kSlipSpeed);
}

// Its derivative in v.
inline double frictionSlope(double damping, double friction, double v) {
  const double t = std::tanh(v / kSlipSpeed);
  return damping + friction / kSlipSpeed * (1 - t * t);
}

}  // namespace rbd
