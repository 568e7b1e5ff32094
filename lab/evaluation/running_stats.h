// Running statistics of one quantity, and numbers as JSON values.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace lab {

/// JSON has neither NaN nor infinity: null says that there is no value.
inline nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}
inline void put(nlohmann::json& out, const std::string& name, double value) {
  out[name] = number_or_null(value);
}

/// Of absolute values. Sums are taken in the order of the steps.
struct RunningStats {
  double max = 0, sum = 0, squares = 0, last = 0;
  int64_t count = 0;

  void add(double value) {
    const double size = std::abs(value);
    max = std::max(max, size);
    sum += size;
    squares += value * value;
    last = size;
    ++count;
  }
  void add(const RunningStats& other) {
    max = std::max(max, other.max);
    sum += other.sum;
    squares += other.squares;
    count += other.count;
  }
  double mean() const { return sum / static_cast<double>(count); }
  double rms() const { return std::sqrt(squares / static_cast<double>(count)); }
};

}  // namespace lab
