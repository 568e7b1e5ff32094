// Bins of loop times for histograms over a whole run: one bin each for 0, 1, 2, 3 us, then four per octave, so that
// a bin is at most a quarter of its start wide. PROCESS carries the counts.
#pragma once
#include <bit>
#include <cstdint>

namespace lab {

inline constexpr int kLoopBins = 84;  ///< the last one starts at 3.7 s

constexpr int loop_bin(int64_t us) {
  if (us < 4) return us < 0 ? 0 : static_cast<int>(us);
  const int octave = std::bit_width(static_cast<uint64_t>(us)) - 1;
  const int bin = 4 * (octave - 1) + static_cast<int>(us >> (octave - 2) & 3);
  return bin < kLoopBins ? bin : kLoopBins - 1;
}

/// us: where a bin starts; for kLoopBins: where the last one ends.
constexpr int64_t loop_bin_start(int bin) {
  return bin < 4 ? bin : static_cast<int64_t>(4 + bin % 4) << (bin / 4 - 1);
}

}  // namespace lab
