#include "lab/plot/chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lab::plot {
namespace {

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  std::pair<double, double> pair() const { return low <= high ? std::pair(low, high) : std::pair(0.0, 1.0); }
};

}  // namespace

Ink series_ink(size_t i) {
  constexpr Ink kOrder[kSeriesInks] = {Ink::Blue,   Ink::Red, Ink::Green, Ink::Purple,
                                       Ink::Orange, Ink::Sky, Ink::Brown};
  return kOrder[i % kSeriesInks];
}

void thin(Curve& curve, size_t buckets) {
  const size_t n = curve.y.size();
  if (n <= 2 * buckets) return;
  Curve out;
  out.x.push_back(curve.x.front());
  out.y.push_back(curve.y.front());
  for (size_t b = 0; b < buckets; ++b) {
    const auto from = curve.y.begin() + static_cast<std::ptrdiff_t>(n * b / buckets),
               to = curve.y.begin() + static_cast<std::ptrdiff_t>(n * (b + 1) / buckets);
    auto [first, second] = std::minmax_element(from, to);
    if (first > second) std::swap(first, second);
    for (const auto& at : {first, second}) {
      out.x.push_back(curve.x[static_cast<size_t>(at - curve.y.begin())]);
      out.y.push_back(*at);
      if (first == second) break;
    }
  }
  out.x.push_back(curve.x.back());
  out.y.push_back(curve.y.back());
  curve.x = std::move(out.x);
  curve.y = std::move(out.y);
}

void thin_evenly(Curve& curve, size_t points) {
  const size_t n = curve.y.size();
  if (n <= points) return;
  Curve out;
  for (size_t i = 0; i < points; ++i) {
    const size_t at = i * (n - 1) / (points - 1);
    out.x.push_back(curve.x[at]);
    out.y.push_back(curve.y[at]);
  }
  curve.x = std::move(out.x);
  curve.y = std::move(out.y);
}

std::pair<double, double> x_range(const Chart& chart) {
  Range range;
  for (double value : chart.must_include_x) range.include(value);
  for (const Curve& curve : chart.curves)
    for (double value : curve.x) range.include(value);
  for (const Mark& mark : chart.marks) range.include(mark.x);
  return range.pair();
}

std::pair<double, double> y_range(const Chart& chart) {
  Range range;
  for (double value : chart.must_include_y) range.include(value);
  for (const Curve& curve : chart.curves)
    for (double value : curve.y) range.include(value);
  for (const Mark& mark : chart.marks)
    if (std::isfinite(mark.y)) {
      range.include(mark.low);
      range.include(mark.high);
    }
  return range.pair();
}

}  // namespace lab::plot
