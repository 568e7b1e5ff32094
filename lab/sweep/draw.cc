#include "lab/sweep/draw.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/util/number.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/hash.h"

namespace lab::sweep {

double uniform(int64_t seed, int64_t draw, const std::string& key, int which) {
  const auto bits = static_cast<uint64_t>(hash_of(fmt::format("{} {} {} {}", seed, draw, which, key)));
  return std::ldexp(static_cast<double>(bits >> 11), -53);
}

std::string value_of(const Distribution& d, int64_t seed, int64_t draw, const std::string& key) {
  const double u = uniform(seed, draw, key, 0);
  switch (d.kind) {
    case Distribution::Kind::Uniform:
      return number(d.a + (d.b - d.a) * u);
    case Distribution::Kind::LogUniform:
      return number(d.a * std::pow(d.b / d.a, u));
    case Distribution::Kind::Normal: {  // Box and Muller 1958; 1 - u is never 0
      const double r = std::sqrt(-2 * std::log(1 - u));
      return number(d.a + d.b * r * std::cos(2 * std::numbers::pi * uniform(seed, draw, key, 1)));
    }
    case Distribution::Kind::Integer:
      return fmt::format("{}", static_cast<int64_t>(d.a + std::floor((d.b - d.a + 1) * u)));
    case Distribution::Kind::Choice:
      return d.choices[static_cast<size_t>(std::floor(static_cast<double>(d.choices.size()) * u))];
  }
  return "";
}

}  // namespace lab::sweep
