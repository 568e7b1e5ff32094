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

Curve KeptPoints::curve(std::string label, Ink ink) const {
  return {.label = std::move(label), .x = x_, .y = y_, .ink = ink};
}

void Thinned::keep(const Point& point) {
  x_.push_back(point.x);
  y_.push_back(point.y);
}

void Thinned::add(double x, double y) {
  const Point point{.at = added_++, .x = x, .y = y};
  if (n_ <= 2 * buckets_) return keep(point);
  if (point.at == 0) keep(point);
  if (point.at == bucket_end_) {
    bucket_end_ = n_ * ++bucket_ / buckets_;
    low_ = high_ = point;
  }
  if (y < low_.y) low_ = point;
  if (y >= high_.y) high_ = point;
  if (added_ == bucket_end_) close_bucket();
  if (added_ == n_) keep(point);
}

void Thinned::close_bucket() {
  const auto& [first, second] = low_.at < high_.at ? std::pair(low_, high_) : std::pair(high_, low_);
  keep(first);
  if (first.at != second.at) keep(second);
}

void ThinnedEvenly::add(double x, double y) {
  const size_t at = added_++;
  if (n_ > points_ && at != x_.size() * (n_ - 1) / (points_ - 1)) return;
  x_.push_back(x);
  y_.push_back(y);
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
