#include "lab/plot/draw.h"

#include <algorithm>
#include <cmath>

#include "lab/plot/axis.h"
#include "lab/plot/svg.h"

namespace lab::plot {
namespace {

using Interval = std::pair<double, double>;

constexpr double kTop = 8, kRight = 14, kBottom = 36;  // px: margins around the area of the data
constexpr double kKeyHeight = 16;                      // px: of the line that says what the inks of marks are
constexpr double kLetter = 6.2;                        // px: about the width of a digit at 11 px

const char* name_of(Ink ink) {
  constexpr const char* kNames[] = {"blue", "orange", "red", "green", "purple", "sky", "brown", "grey"};
  return kNames[static_cast<size_t>(ink)];
}

/// Letters of UTF-8.
double width_of(const std::string& label) {
  return kLetter * static_cast<double>(
                       std::count_if(label.begin(), label.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

/// Around the positive values, over six decades at most.
Interval logarithmic_range(const Chart& chart) {
  double least = INFINITY, most = 0;
  const auto include = [&](double y) {
    if (!(y > 0) || !std::isfinite(y)) return;
    least = std::min(least, y);
    most = std::max(most, y);
  };
  for (const Curve& curve : chart.curves)
    for (double y : curve.y) include(y);
  for (const Mark& mark : chart.marks) {
    include(mark.low);
    include(mark.high);
  }
  if (most == 0) return {0.1, 1};
  return padded_logarithmic({std::max(least, most * 1e-6), most});
}

/// Makes the ranges of an area `aspect` times as wide as high such that a length is the same on both axes.
void equalize(Interval& x, Interval& y, double aspect) {
  const auto widen = [](Interval& range, double more) {
    if (more <= 0) return;
    range.first -= more / 2;
    range.second += more / 2;
  };
  const double width = x.second - x.first, height = y.second - y.first;
  widen(x, aspect * height - width);
  widen(y, width / aspect - height);
}

Interval range_of_x(const Chart& chart) {
  Interval range = x_range(chart);
  if (chart.logarithmic_x) return chart.marks.empty() ? range : padded_logarithmic(range);
  if (chart.equal || !chart.marks.empty() || range.first == range.second) return padded(range, 0.04);
  return range;
}

Interval range_of_y(const Chart& chart) {
  if (chart.logarithmic_y) return logarithmic_range(chart);
  Interval range = padded(y_range(chart));
  if (chart.bars) range.first = 0;
  return range;
}

/// The area of the data, and its axes.
struct Area {
  double left, right, top, bottom;
  Axis x, y;
};

Area area_of(const Chart& chart) {
  const double top = kTop + (chart.marks.empty() ? 0 : 14) +  // a strip at the top for marks without a value
                     (chart.key.empty() ? 0 : kKeyHeight);
  const double bottom = chart.height - kBottom;
  Interval x = range_of_x(chart), y = range_of_y(chart);
  // the left margin depends on the labels, and with equal lengths the labels on the margin: half a guess is enough
  double left = 46;
  for (const Tick& tick : Axis(y, chart.logarithmic_y, bottom, top).ticks(5))
    left = std::max(left, width_of(tick.label) + 14);
  if (!chart.y_label.empty()) left += 18;
  const double right = chart.width - kRight;
  if (chart.equal) equalize(x, y, (right - left) / (bottom - top));
  return {left,
          right,
          top,
          bottom,
          Axis(x, chart.logarithmic_x, left, right),
          Axis(y, chart.logarithmic_y, bottom, top)};
}

/// The chart's own ticks where they fit, else round numbers or every n-th name.
std::vector<Tick> ticks_of_x(const Chart& chart, const Area& area) {
  const auto fit = [&](size_t every) {
    for (size_t i = every; i < chart.x_ticks.size(); i += every) {
      const Tick &before = chart.x_ticks[i - every], &tick = chart.x_ticks[i];
      if (area.x.at(tick.value) - area.x.at(before.value) <
          (width_of(before.label) + width_of(tick.label)) / 2 + 8)
        return false;
    }
    return true;
  };
  if (!chart.x_ticks.empty() && fit(1)) return chart.x_ticks;
  if (!chart.categories)
    return area.x.ticks(std::min<size_t>(10, static_cast<size_t>((area.right - area.left) / 52)));
  size_t every = 2;
  while (!fit(every)) ++every;
  std::vector<Tick> some;
  for (size_t i = 0; i < chart.x_ticks.size(); i += every) some.push_back(chart.x_ticks[i]);
  return some;
}

std::string axes(const Chart& chart, const Area& area) {
  std::string out;
  for (const auto& [low, high] : chart.bands) {
    const double from = std::max(low, area.y.low()), to = std::min(high, area.y.high());
    if (from < to)
      out += svg::rect(area.left, area.y.at(to), area.right - area.left, area.y.at(from) - area.y.at(to),
                       "class=\"band\"");
  }
  const size_t most = std::max<size_t>(3, static_cast<size_t>((area.bottom - area.top) / 26));
  for (const Tick& tick : area.y.ticks(most)) {
    const double y = area.y.at(tick.value);
    out += svg::line(area.left, y, area.right, y, "grid");
    out += svg::text(area.left - 7, y + 4, tick.label, "end");
  }
  for (const Tick& tick : ticks_of_x(chart, area)) {
    const double x = area.x.at(tick.value);
    if (chart.equal) out += svg::line(x, area.top, x, area.bottom, "grid");
    out += svg::line(x, area.bottom, x, area.bottom + 4, "frame");
    out += svg::text(x, area.bottom + 16, tick.label);
  }
  for (double level : chart.levels)
    if (level >= area.y.low() && level <= area.y.high())
      out += svg::line(area.left, area.y.at(level), area.right, area.y.at(level), "level");
  out += fmt::format("<path class=\"frame\" d=\"M{0:.1f},{1:.1f} {0:.1f},{2:.1f} {3:.1f},{2:.1f}\"/>\n",
                     area.left, area.top, area.bottom, area.right);
  out += svg::text((area.left + area.right) / 2, chart.height - 6, chart.x_label);
  if (!chart.y_label.empty()) out += svg::upright_text(12, (area.top + area.bottom) / 2, chart.y_label);
  return out;
}

/// The points of a curve as a path that ends at the bottom of the area, and is broken where a value cannot be shown.
std::string path_of(const Curve& curve, const Area& area) {
  std::string d;
  double last_x = NAN, last_y = NAN;  // px, unclipped
  bool pen_down = false;
  for (size_t i = 0; i < curve.y.size(); ++i) {
    const double x = area.x.at(curve.x[i]), y = area.y.at(curve.y[i]);
    if (!std::isfinite(x) || !std::isfinite(y)) {
      pen_down = false;
    } else {
      const bool inside = y <= area.bottom + 0.05, was_inside = last_y <= area.bottom + 0.05;
      const double edge_x = last_x + (x - last_x) * (area.bottom - last_y) / (y - last_y);
      if (inside && !pen_down)
        d += std::isfinite(last_y) && !was_inside ? fmt::format("M{:.1f},{:.1f} ", edge_x, area.bottom) : "M";
      if (inside) d += fmt::format("{:.1f},{:.1f} ", x, y);
      if (!inside && pen_down) d += fmt::format("{:.1f},{:.1f} ", edge_x, area.bottom);
      pen_down = inside;
    }
    last_x = x;
    last_y = y;
  }
  if (!d.empty()) d.pop_back();
  return d;
}

std::string draw_curve(const Curve& curve, const Area& area) {
  return fmt::format("<path class=\"s-{}\" stroke-width=\"{:g}\"{} d=\"{}\"", name_of(curve.ink), curve.width,
                     curve.dashed ? " stroke-dasharray=\"5 4\"" : "", path_of(curve, area)) +
         svg::close("path", curve.label);
}

std::string draw_bars(const Curve& bars, const Area& area) {
  std::string d;
  for (size_t i = 0; i < bars.y.size(); ++i)
    if (bars.y[i] > 0)
      d += fmt::format("M{:.1f},{:.1f}V{:.1f}H{:.1f}V{:.1f}Z", area.x.at(bars.x[i]), area.bottom,
                       area.y.at(bars.y[i]), area.x.at(bars.x[i + 1]), area.bottom);
  return fmt::format("<path class=\"f-{}\" d=\"{}\"/>\n", name_of(bars.ink), d);
}

std::string draw_mark(const Mark& mark, const Area& area) {
  const double x = area.x.at(mark.x);
  if (!std::isfinite(mark.y)) return svg::cross(x, area.top - 8, mark.tooltip);
  std::string out;
  if (mark.low < mark.high) out += svg::line(x, area.y.at(mark.low), x, area.y.at(mark.high), "frame");
  return out + svg::dot(x, area.y.at(mark.y), 3.5, name_of(mark.ink), mark.tooltip);
}

std::string draw_mark_key(const Chart& chart, const Area& area) {
  std::string out;
  double x = area.left;
  for (const auto& [ink, label] : chart.key) {
    out += svg::dot(x + 4, 8, 3.5, name_of(ink), "") + svg::text(x + 12, 12, label, "start");
    x += 12 + width_of(label) + 16;
  }
  return out;
}

}  // namespace

std::string draw(const Chart& chart) {
  const Area area = area_of(chart);
  std::string out = svg::open(chart.width, chart.height, chart.title) + axes(chart, area);
  for (size_t i = 0; i < chart.curves.size(); ++i)
    out += chart.bars && i == 0 ? draw_bars(chart.curves[i], area) : draw_curve(chart.curves[i], area);
  for (const Mark& mark : chart.marks) out += draw_mark(mark, area);
  out += draw_mark_key(chart, area);
  return out + "</svg>\n";
}

std::string draw_key(const Curve& curve) {
  return fmt::format(
      "<svg viewBox=\"0 0 22 8\"><path class=\"s-{}\" stroke-width=\"{:g}\"{} d=\"M2 4H20\"/></svg>",
      name_of(curve.ink), std::max(curve.width, 1.0) + 0.4, curve.dashed ? " stroke-dasharray=\"4 4\"" : "");
}

}  // namespace lab::plot
