// The coefficients of exponentials of rotation vectors w, |w| = t, well conditioned down to t = 0.
#pragma once

namespace rbd::inner {

// Below this angle the first Taylor terms are exact to double precision: t^4 / 120 < eps / 4.
constexpr double kTiny = 1e-4;

// sin(t/2) / t
inline double halfSineOverAngle(double t, double half_sine) {
  return t < kTiny ? 0.5 - t * t / 48 : half_sine / t;
}

// (t - sin t) / t^3, which loses digits below about 0.1: its series there.
inline double secondTerm(double t, double sine) {
  const double t2 = t * t;
  return t < 0.1 ? (1 - t2 / 20 * (1 - t2 / 42 * (1 - t2 / 72 * (1 - t2 / 110)))) / 6 : (t - sine) / (t * t2);
}

}  // namespace rbd::inner
