// How often messages come.
#pragma once
#include <algorithm>
#include <vector>

#include "wire/protocol/timers.h"

namespace lab::spy {

struct Periods {
  Micros least = 0, most = 0;  ///< us between two; 0 if there are not two
  double hz = 0;
};

/// Of messages that came at these times, rising, within `span` s.
inline Periods periods(const std::vector<Micros>& times, double span) {
  Periods out;
  if (times.size() < 2) {
    out.hz = static_cast<double>(times.size()) / span;
    return out;
  }
  out.least = times[1] - times[0];
  for (size_t i = 1; i < times.size(); ++i) {
    out.least = std::min(out.least, times[i] - times[i - 1]);
    out.most = std::max(out.most, times[i] - times[i - 1]);
  }
  out.hz = static_cast<double>(times.size() - 1) / (static_cast<double>(times.back() - times.front()) * 1e-6);
  return out;
}

}  // namespace lab::spy
