// A histogram of how late ticks were.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "wire/protocol/role.h"

namespace lab {

/// How late ticks were, over a whole run: a histogram with bins of 1 us; the last one, 20 ms, holds all later ones.
class Lateness {
 public:
  void add(Micros late) {
    ++counts_[static_cast<size_t>(std::clamp<Micros>(late, 0, kBins - 1))];
    ++total_;
    longest_ = std::max(longest_, late);
  }
  int64_t ticks() const { return total_; }
  /// us: this share of the ticks (0..1) was at most so late; 0 without a tick.
  Micros quantile(double share) const {
    int64_t left = static_cast<int64_t>(share * static_cast<double>(total_));
    for (size_t us = 0; us < kBins; ++us) {
      left -= counts_[us];
      if (left < 0) return static_cast<Micros>(us);
    }
    return longest_;
  }
  Micros longest() const { return longest_; }

 private:
  static constexpr Micros kBins = 20'000;
  std::array<int64_t, kBins> counts_{};
  int64_t total_ = 0;
  Micros longest_ = 0;
};

}  // namespace lab
