#include "lab/report/chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lab::report {
namespace {

std::pair<double, double> range(const Chart& chart, std::vector<double> Curve::* axis,
                                const std::vector<double>& in_sight) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (double value : in_sight) least = std::min(least, value), most = std::max(most, value);
  for (const Curve& curve : chart.curves)
    for (double value : curve.*axis)
      if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
  return least <= most ? std::pair(least, most) : std::pair(0.0, 1.0);
}

}  // namespace

void thin(Curve& curve, size_t buckets) {
  const size_t n = curve.y.size();
  if (n <= 2 * buckets) return;
  Curve out;
  out.x.push_back(curve.x.front()), out.y.push_back(curve.y.front());
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
  out.x.push_back(curve.x.back()), out.y.push_back(curve.y.back());
  curve.x = std::move(out.x), curve.y = std::move(out.y);
}

void thin_evenly(Curve& curve, size_t points) {
  const size_t n = curve.y.size();
  if (n <= points) return;
  Curve out;
  for (size_t i = 0; i < points; ++i) {
    const size_t at = i * (n - 1) / (points - 1);
    out.x.push_back(curve.x[at]), out.y.push_back(curve.y[at]);
  }
  curve.x = std::move(out.x), curve.y = std::move(out.y);
}

std::pair<double, double> x_range(const Chart& chart) { return range(chart, &Curve::x, chart.in_sight_x); }
std::pair<double, double> y_range(const Chart& chart) { return range(chart, &Curve::y, chart.in_sight_y); }

Scale scale_for(double most, const std::string& unit) {
  if (most >= 0.1 || most < 1e-9) return {1, unit};  // no prefix makes the latter kind
  return most >= 1e-4 ? Scale{1e3, "m" + unit} : Scale{1e6, "µ" + unit};
}

void rescale(Chart& chart, double factor) {
  for (Curve& curve : chart.curves)
    for (double& y : curve.y) y *= factor;
  for (double& y : chart.in_sight_y) y *= factor;
  for (double& level : chart.levels) level *= factor;
  for (auto& [low, high] : chart.bands) low *= factor, high *= factor;
}

}  // namespace lab::report
