// Random values that depend on (seed, number of the draw, key) alone: not on the order in which they are computed, nor on
// what else is drawn.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace lab::sweep {

struct Distribution {
  enum class Kind {
    Uniform,     ///< a .. b
    LogUniform,  ///< a .. b, its logarithm uniform
    Normal,      ///< mean a, standard deviation b
    Integer,     ///< a .. b, both included
    Choice,      ///< one of `choices`
  };
  Kind kind = Kind::Uniform;
  double a = 0, b = 0;
  std::vector<std::string> choices;
};

/// A number in [0, 1), the `which`-th of this draw and key: 53 bits of XXH3.
double uniform(int64_t seed, int64_t draw, const std::string& key, int which);

/// The drawn value as text; numbers have all digits they need.
std::string value_of(const Distribution&, int64_t seed, int64_t draw, const std::string& key);

}  // namespace lab::sweep
