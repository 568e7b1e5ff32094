#include "rbd/kernel/sincos.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/core/algorithm/random_tree.h"

namespace rbd::inner {
namespace {

// Largest error against long double libm.
double worstError(const std::vector<double>& x) {
  std::vector<double> s(x.size() + 3), c(x.size() + 3);
  sincosAll(static_cast<int>(x.size()), x.data(), s.data(), c.data());
  long double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    worst = std::max(worst, std::abs(s[i] - std::sin(static_cast<long double>(x[i]))));
    worst = std::max(worst, std::abs(c[i] - std::cos(static_cast<long double>(x[i]))));
  }
  return static_cast<double>(worst);
}

TEST(Sincos, WithinTwoToTheMinus52) {
  rbd::testing::Random random(1);
  for (const double size : {1e-9, 1e-3, 0.8, 3.2, 100.0, 25000.0}) {
    std::vector<double> x(40000);
    for (double& y : x) y = random.in(-size, size);
    EXPECT_LE(worstError(x), 2.3e-16) << size;
  }
}

TEST(Sincos, HardPlaces) {
  std::vector<double> x = {0.0, -0.0, 5e-324, 1e-300};
  for (int k = -20000; k <= 15900; k += 7) {
    // next to the zeros and the seams of the quadrants, where the reduction loses most
    for (const double near : {0.0, 1e-12, -1e-12}) x.push_back(k * 0.78539816339744831 + near);
  }
  EXPECT_LE(worstError(x), 2.3e-16);
}

TEST(Sincos, LibmBeyondTheRange) {
  EXPECT_LE(worstError({1.0, 25001.0, -3e7}), 2.3e-16);
  EXPECT_LE(worstError({1e22, -4e15, 0.1, 0.2, 0.3}), 2.3e-16);
}

TEST(Sincos, EveryTailLength) {
  rbd::testing::Random random(2);
  for (std::size_t n = 0; n < 10; ++n) {
    std::vector<double> x(n);
    for (double& y : x) y = random.in(-4, 4);
    EXPECT_LE(worstError(x), 2.3e-16) << n;
  }
}

TEST(Sincos, SmallAnglesKeepTheirDigits) {
  double x = 1e-160, s[4], c[4];
  sincosAll(1, &x, s, c);
  EXPECT_EQ(s[0], 1e-160);
  EXPECT_EQ(c[0], 1.0);
}

}  // namespace
}  // namespace rbd::inner
