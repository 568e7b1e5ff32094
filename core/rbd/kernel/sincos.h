// Sine and cosine of many angles at once.
//
// Branch-free for |x| <= 25000 rad, libm beyond. Error at most 2^-52 absolute (tests measure it against long
// double). Method: k = round(x 2/pi); r = x - k pi/2 with pi/2 in three parts (the first two of 33 bits: k
// times them is exact), kept as r + tail; Taylor series on |r| <= pi/4, whose first omitted terms are below
// 5e-17; quadrant by k.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "rbd/kernel/vec3.h"

namespace rbd::inner {

using Mask4 = std::int64_t __attribute__((vector_size(32)));

inline Lanes4 chooseLanes(Mask4 mask, Lanes4 yes, Lanes4 no) { return mask ? yes : no; }

// Four angles; valid only for |x| <= 25000.
inline void sincos4(Lanes4 x, Lanes4& sine, Lanes4& cosine) {
  constexpr double kTwoOverPi = 0.63661977236758134308;
  constexpr double kPi1 = 1.57079632673412561417e+00;  // first 33 bits of pi/2
  constexpr double kPi2 = 6.07710050630396597660e-11;  // next 33 bits
  constexpr double kPi3 = 2.02226624879595063154e-21;  // the rest
  constexpr double kRound = 6755399441055744.0;        // 1.5 * 2^52: adding it rounds to an integer

  const Lanes4 shifted = x * kTwoOverPi + kRound;
  const Lanes4 k = shifted - kRound;
  const Mask4 quadrant = reinterpret_cast<Mask4>(shifted);
  const Lanes4 a = x - k * kPi1;
  const Lanes4 b = k * kPi2;
  const Lanes4 r = a - b;
  const Lanes4 tail = ((a - r) - b) - k * kPi3;

  const Lanes4 z = r * r;
  Lanes4 s = z * (1.0 / 1307674368000.0) * -1.0 + 1.0 / 6227020800.0;
  s = s * z - 1.0 / 39916800.0;
  s = s * z + 1.0 / 362880.0;
  s = s * z - 1.0 / 5040.0;
  s = s * z + 1.0 / 120.0;
  s = s * z - 1.0 / 6.0;
  Lanes4 c = z * (1.0 / 20922789888000.0) - 1.0 / 87178291200.0;
  c = c * z + 1.0 / 479001600.0;
  c = c * z - 1.0 / 3628800.0;
  c = c * z + 1.0 / 40320.0;
  c = c * z - 1.0 / 720.0;
  c = c * z + 1.0 / 24.0;
  // sin(r + t) = sin r + t cos r, cos(r + t) = cos r - t sin r; the large first terms are added last, and
  // 1 - z/2 is split so that its rounding error is not lost
  const Lanes4 sin_r = r + (r * z * s + tail * (1.0 - 0.5 * z));
  const Lanes4 half = 0.5 * z, one = 1.0 - half;
  const Lanes4 cos_r = one + (((1.0 - one) - half) + (z * z * c - r * tail));

  const Mask4 odd = (quadrant & 1) != 0;
  const Lanes4 s1 = chooseLanes(odd, cos_r, sin_r), c1 = chooseLanes(odd, sin_r, cos_r);
  sine = chooseLanes((quadrant & 2) != 0, -s1, s1);
  cosine = chooseLanes(((quadrant + 1) & 2) != 0, -c1, c1);
}

// s[i], c[i] of x[i], i < n. The outputs have room for n rounded up to 4.
template <class Scalar>
inline void sincosAll(int n, const Scalar* x, Scalar* s, Scalar* c) {
  for (int i = 0; i < n; ++i) {
    s[i] = std::sin(x[i]);
    c[i] = std::cos(x[i]);
  }
}

template <>
inline void sincosAll<double>(int n, const double* x, double* s, double* c) {
  constexpr double kLimit = 25000;
  Lanes4 largest{};
  const auto four = [&](Lanes4 angle, int i) {
    Lanes4 sine, cosine;
    sincos4(angle, sine, cosine);
    storeLanes(s + i, sine);
    storeLanes(c + i, cosine);
    const Lanes4 size = chooseLanes(angle < 0.0, -angle, angle);
    largest = chooseLanes(size > largest, size, largest);
  };
  int i = 0;
  for (; i + 4 <= n; i += 4) four(loadLanes(x + i), i);
  // the tail is gathered in a register: a wide load over narrow stores would stall
  if (i < n) four(Lanes4{x[i], i + 1 < n ? x[i + 1] : 0, i + 2 < n ? x[i + 2] : 0, 0}, i);
  const double most = std::max(std::max(largest[0], largest[1]), std::max(largest[2], largest[3]));
  if (most > kLimit) {
    for (i = 0; i < n; ++i) {
      s[i] = std::sin(x[i]);
      c[i] = std::cos(x[i]);
    }
  }
}

}  // namespace rbd::inner
