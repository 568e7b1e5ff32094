// Draws: what they depend on, and whether they have the distribution that was asked for.
#include "lab/sweep/draw.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace lab::sweep {
namespace {

using Kind = Distribution::Kind;
constexpr int kMany = 20'000;

std::vector<double> draw(const Distribution& d, int64_t seed, const std::string& key) {
  std::vector<double> values;
  for (int i = 0; i < kMany; ++i) values.push_back(std::stod(value_of(d, seed, i, key)));
  return values;
}

/// Kolmogorov's distance to a distribution function; 1.95 / sqrt(n) is exceeded once in 1000 times by chance, and the
/// seed is fixed.
double distance(std::vector<double> values, double (*cdf)(double)) {
  std::sort(values.begin(), values.end());
  double most = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const double p = cdf(values[i]), n = static_cast<double>(values.size());
    most = std::max({most, p - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - p});
  }
  return most;
}
const double kBound = 1.95 / std::sqrt(kMany);

TEST(Draw, UniformHasItsDistribution) {
  const Distribution d{Kind::Uniform, 0.5, 1.5, {}};
  for (int64_t seed : {0, 1, 2})
    EXPECT_LT(distance(draw(d, seed, "a"), [](double x) { return x - 0.5; }), kBound) << seed;
}

TEST(Draw, LogUniformHasItsDistribution) {
  const Distribution d{Kind::LogUniform, 0.01, 100, {}};
  EXPECT_LT(distance(draw(d, 1, "a"), [](double x) { return (std::log10(x) + 2) / 4; }), kBound);
}

TEST(Draw, NormalHasItsDistribution) {
  const Distribution d{Kind::Normal, 3, 2, {}};
  EXPECT_LT(
      distance(draw(d, 1, "a"), [](double x) { return 0.5 * std::erfc(-(x - 3) / (2 * std::sqrt(2.0))); }),
      kBound);
}

TEST(Draw, IntegersAndChoicesAreEquallyLikely) {
  std::map<std::string, int> integers, choices;
  for (int i = 0; i < kMany; ++i) {
    ++integers[value_of({Kind::Integer, -1, 3, {}}, 5, i, "a")];
    ++choices[value_of({Kind::Choice, 0, 0, {"x", "y"}}, 5, i, "a")];
  }
  ASSERT_EQ(integers.size(), 5u);
  ASSERT_EQ(choices.size(), 2u);
  EXPECT_TRUE(integers.count("-1") && integers.count("3"));
  // five standard deviations of a binomial count
  for (const auto& [value, n] : integers) EXPECT_NEAR(n, kMany / 5.0, 5 * std::sqrt(kMany * 0.16)) << value;
  for (const auto& [value, n] : choices) EXPECT_NEAR(n, kMany / 2.0, 5 * std::sqrt(kMany * 0.25)) << value;
}

TEST(Draw, KeysAndSeedsAreIndependent) {
  const Distribution d{Kind::Uniform, -1, 1, {}};
  const std::vector<double> a = draw(d, 1, "a"), b = draw(d, 1, "b"), other = draw(d, 2, "a");
  double ab = 0, seeds = 0, next = 0;
  for (size_t i = 0; i + 1 < a.size(); ++i)
    ab += a[i] * b[i], seeds += a[i] * other[i], next += a[i] * a[i + 1];
  // a product of two has variance 1/9: five standard deviations of the sum
  const double bound = 5 * std::sqrt(kMany / 9.0);
  EXPECT_LT(std::abs(ab), bound);
  EXPECT_LT(std::abs(seeds), bound);
  EXPECT_LT(std::abs(next), bound);
}

TEST(Draw, IsAPureFunction) {
  const Distribution d{Kind::Normal, 0, 1, {}};
  const std::string late = value_of(d, 7, 1000, "k");
  std::set<std::string> all;
  for (int i = 0; i < 1000; ++i) all.insert(value_of(d, 7, i, "k"));
  EXPECT_EQ(all.size(), 1000u);
  EXPECT_EQ(value_of(d, 7, 1000, "k"), late);
  // frozen: a sweep that is run again next year gets the same draws
  EXPECT_EQ(value_of({Kind::Uniform, 0.5, 1.5, {}}, 1, 0, "controller.model.mass_scale"),
            "0.939490509482871");
}

}  // namespace
}  // namespace lab::sweep
