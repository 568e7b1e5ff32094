// Counter-based noise: a pure function of seed, step, joint and kind, so that any step can be recomputed on its own, in
// any process and in any order. Not std::normal_distribution: its numbers depend on the standard library.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>

namespace lab::simulator {

enum class NoiseKind : uint64_t { Position = 1, Velocity = 2 };

/// SplitMix64: every bit of the result depends on every bit of x. Source: Steele, Lea, Flood 2014, figure 16.
constexpr uint64_t mix(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Gaussian of mean 0 and standard deviation 1, at most 8.6 in magnitude. Source: Box, Muller 1958.
inline double gaussian(int64_t seed, int64_t step, int joint, NoiseKind kind) {
  constexpr double kTiny = 0x1p-53;
  const uint64_t of_step = mix(mix(static_cast<uint64_t>(seed)) ^ static_cast<uint64_t>(step));
  const uint64_t key = mix(mix(of_step ^ static_cast<uint64_t>(joint)) ^ static_cast<uint64_t>(kind)),
                 next = mix(key);
  const double a = kTiny * static_cast<double>((key >> 11) + 1);  // (0, 1]
  const double b = kTiny * static_cast<double>(next >> 11);       // [0, 1)
  return std::sqrt(-2 * std::log(a)) * std::cos(2 * std::numbers::pi * b);
}

}  // namespace lab::simulator
