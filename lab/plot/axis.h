// An axis of a plot: values to pixels, and where its ticks are.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "lab/plot/chart.h"

namespace lab::plot {

class Axis {
 public:
  /// From range.first at pixel_from to range.second at pixel_to. A logarithmic axis needs a range above 0.
  Axis(std::pair<double, double> range, bool logarithmic, double pixel_from, double pixel_to);

  double low() const { return low_; }
  double high() const { return high_; }
  bool logarithmic() const { return logarithmic_; }
  /// 0 at the low end, 1 at the high end; NaN for what a logarithmic axis cannot show.
  double share(double value) const;
  double at(double value) const { return from_ + share(value) * (to_ - from_); }
  /// About `most` ticks at most, at round values; on a logarithmic axis at powers of ten, if these are few also between.
  std::vector<Tick> ticks(size_t most) const;

 private:
  std::vector<Tick> linear_ticks(size_t most) const;
  std::vector<Tick> logarithmic_ticks(size_t most) const;

  double low_, high_, from_, to_;
  bool logarithmic_;
};

/// The range with a margin on both sides, also if all values are equal or six digits cannot tell them apart.
std::pair<double, double> padded(std::pair<double, double> range, double share = 0.06);
/// The same for a logarithmic axis.
std::pair<double, double> padded_logarithmic(std::pair<double, double> range);

/// True if all values are above 0 and span more than a factor of 50.
bool suits_logarithm(std::pair<double, double> range);

}  // namespace lab::plot
