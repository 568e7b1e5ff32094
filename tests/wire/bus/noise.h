// Bytes of any length for messages whose content does not matter.
#pragma once
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace lab {

using Bytes = std::vector<uint8_t>;

/// n pseudo-random bytes; the same for the same seed.
inline Bytes noise(size_t n, uint32_t seed) {
  std::mt19937 rng(seed);
  Bytes out(n);
  for (uint8_t& b : out) b = static_cast<uint8_t>(rng());
  return out;
}

}  // namespace lab
