#include "lab/sweep/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/util/number.h"
#include "lab/report/html.h"

namespace lab::sweep::svg {

Scale::Scale(const std::vector<double>& values, double pixel_from, double pixel_to, bool room)
    : from_(pixel_from), to_(pixel_to) {
  if (values.empty()) return;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  low_ = *least, high_ = *most;
  log_ = low_ > 0 && high_ / low_ > 50;
  if (low_ == high_) {  // one value: in the middle
    const double half = low_ == 0 ? 1 : std::abs(low_) / 2;
    low_ -= half, high_ += half;
  } else if (room) {  // so that no point lies on the frame
    const double edge = log_ ? std::pow(high_ / low_, 0.04) : 0.04 * (high_ - low_);
    low_ = log_ ? low_ / edge : low_ - edge;
    high_ = log_ ? high_ * edge : high_ + edge;
  }
}

double Scale::share(double value) const {
  return log_ ? std::log(value / low_) / std::log(high_ / low_) : (value - low_) / (high_ - low_);
}

std::vector<double> Scale::ticks() const {
  std::vector<double> ticks;
  if (log_) {
    const int first = static_cast<int>(std::ceil(std::log10(low_) - 1e-9)),
              last = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
    const int step = std::max(1, (last - first) / 6);
    for (int power = first; power <= last; power += step) ticks.push_back(std::pow(10, power));
    return ticks;
  }
  const double rough = (high_ - low_) / 5, unit = std::pow(10, std::floor(std::log10(rough)));
  const double step = unit * (rough / unit > 5 ? 10 : rough / unit > 2 ? 5 : rough / unit > 1 ? 2 : 1);
  for (double k = std::ceil(low_ / step); k * step <= high_; ++k) ticks.push_back(k * step + 0.0);
  return ticks;
}

std::string label(double value) { return rounded(value); }

std::string label(const std::string& value) {
  double x = 0;
  const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), x);
  return error == std::errc() && stop == value.data() + value.size() ? label(x) : value;
}

std::string colour(double share) {
  constexpr std::array<std::array<int, 3>, 6> kStops{
      {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {253, 231, 37}}};
  const double x = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const size_t i = std::min<size_t>(static_cast<size_t>(x), kStops.size() - 2);
  std::array<int, 3> c{};
  for (size_t k = 0; k < 3; ++k)
    c[k] = static_cast<int>(
        std::lround(kStops[i][k] + (x - static_cast<double>(i)) * (kStops[i + 1][k] - kStops[i][k])));
  return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
}

const char* ink(double share) { return share > 0.6 ? "#000" : "#fff"; }

std::string text(double x, double y, const std::string& words, const std::string& anchor,
                 const std::string& more) {
  return fmt::format("<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}{}>{}</text>\n", x, y,
                     anchor, more.empty() ? "" : " ", more, report::escape(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* kind) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>\n", x1, y1,
                     x2, y2, kind);
}

namespace {

/// The words at the mouse; none if empty.
std::string titled(const std::string& title, const char* tag) {
  return title.empty() ? "/>\n" : "><title>" + report::escape(title) + "</title></" + tag + ">\n";
}

}  // namespace

std::string rect(double x, double y, double width, double height, const std::string& fill,
                 const std::string& title) {
  return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"", x, y,
                     width, height, fill) +
         titled(title, "rect");
}

std::string dot(double x, double y, double radius, const std::string& title) {
  return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" class=\"dot\"", x, y, radius) +
         titled(title, "circle");
}

std::string cross(double x, double y, const std::string& title) {
  return fmt::format("<path d=\"M{:.1f} {:.1f}l8 8m0 -8l-8 8\" class=\"cross\"", x - 4, y - 4) +
         titled(title, "path");
}

}  // namespace lab::sweep::svg
