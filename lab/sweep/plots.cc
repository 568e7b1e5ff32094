#include "lab/sweep/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "lab/page/page.h"
#include "lab/plot/axis.h"
#include "lab/plot/draw.h"

namespace lab::sweep {
namespace {

using page::figure;
using page::short_figure;

constexpr size_t kMaxColours = 5;      // of points of the grid, beside each other above a plot
constexpr size_t kMaxTooltips = 1000;  // cells of a map that say what they are; more make a heavy page

/// What the runs of one place have in common.
struct Place {
  double sum = 0, min = INFINITY, max = -INFINITY;
  int64_t values = 0, runs = 0, without = 0;  ///< without figures: ended early, or could not be run

  void add(const Row& row, size_t metric) {
    ++runs;
    without += !row.complete;
    if (row.metrics.empty() || !std::isfinite(row.metrics[metric])) return;
    const double value = row.metrics[metric];
    sum += value;
    ++values;
    min = std::min(min, value);
    max = std::max(max, value);
  }
  double mean() const { return values > 0 ? sum / static_cast<double>(values) : NAN; }
  std::string tooltip(const std::string& where) const {
    std::string text = where + ": ";
    if (values == 0)
      text += without == runs ? "no figures" : "no value";
    else if (runs == 1)
      text += figure(mean());
    else
      text += fmt::format("mean {} of {} runs ({} .. {})", figure(mean()), values, figure(min), figure(max));
    if (without > 0 && without < runs) text += fmt::format(", {} without figures", without);
    return text;
  }
};

std::optional<double> as_number(const std::string& text) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Puts one key along the axis of a chart: as a scale if all its values are numbers, else name by name. Returns where
/// each value is.
std::map<std::string, double> put_key(plot::Chart& chart, std::vector<std::string> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  std::map<std::string, double> places;
  for (const std::string& value : values)
    if (const auto x = as_number(value)) places[value] = *x;
  if (places.size() != values.size()) {
    chart.categories = true;
    for (size_t i = 0; i < values.size(); ++i) places[values[i]] = static_cast<double>(i) + 0.5;
    chart.must_include_x = {0, static_cast<double>(values.size())};
  }
  std::map<double, std::string> labels;
  for (const auto& [value, x] : places) labels[x] = short_figure(value);
  for (const auto& [x, label] : labels) chart.x_ticks.push_back({x, label});
  chart.logarithmic_x =
      !chart.categories && plot::suits_logarithm({labels.begin()->first, labels.rbegin()->first});
  return places;
}

/// How many points of the grid have colours of their own; 0 if there are too many, or nothing is drawn over them.
size_t coloured_points(const Sweep& sweep) {
  const auto points = static_cast<size_t>(sweep.runs() / sweep.draw_count);
  return sweep.draws.empty() || points < 2 || points > kMaxColours ? 0 : points;
}

/// Gives the runs of each point of the grid its colour, in every plot. The marks are in the order of `places`.
void colour_by_point(const Sweep& sweep, plot::Chart& chart, const std::map<std::string, Place>& places,
                     bool joined) {
  const size_t points = coloured_points(sweep);
  if (points == 0 || (joined && sweep.grid.size() != 1)) return;
  size_t i = 0;
  for (const auto& [name, place] : places) {
    const auto& values = sweep.grid[0].values;
    const auto point = joined ? std::find(values.begin(), values.end(), name) - values.begin()
                              : std::stoll(name) / sweep.draw_count;
    chart.marks[i++].ink = plot::series_ink(static_cast<size_t>(point));
  }
  for (size_t point = 0; point < points; ++point) {
    const std::vector<std::string> values = sweep.values(static_cast<int64_t>(point) * sweep.draw_count);
    std::string label;
    for (size_t k = 0; k < sweep.grid.size(); ++k) {
      const std::string& key = sweep.grid[k].key;
      label += (k ? ", " : "") + key.substr(key.rfind('.') + 1) + " " + short_figure(values[k]);
    }
    chart.key.push_back({plot::series_ink(point), label});
  }
}

/// The metric along one key: every run a mark, or, with `joined`, the runs of each value a mark and a line through them.
Plot along(const Sweep& sweep, const std::vector<Row>& rows, const Units& units, size_t metric, size_t which,
           bool joined) {
  const std::string key = sweep.keys()[which];
  std::vector<std::string> values;
  std::map<std::string, Place> places;  // by value, or by run
  for (size_t run = 0; run < rows.size(); ++run) {
    values.push_back(sweep.values(static_cast<int64_t>(run))[which]);
    places[joined ? values.back() : fmt::format("{}", run)].add(rows[run], metric);
  }
  plot::Chart chart{.title = sweep.metrics[metric] + " over " + key, .width = 520, .height = 290};
  const std::map<std::string, double> x = put_key(chart, values);
  for (const auto& [name, place] : places) {
    const std::string& value = joined ? name : values[static_cast<size_t>(std::stoll(name))];
    chart.marks.push_back({x.at(value), place.mean(), place.min, place.max,
                           place.tooltip((joined ? "" : "run " + name + ", ") + key + " " + value)});
  }
  colour_by_point(sweep, chart, places, joined);
  if (joined) {
    std::sort(chart.marks.begin(), chart.marks.end(),
              [](const plot::Mark& a, const plot::Mark& b) { return a.x < b.x; });
    plot::Curve line{.label = ""};
    if (coloured_points(sweep) > 0) line.ink = plot::Ink::Grey;
    for (const plot::Mark& mark : chart.marks) {
      if (!std::isfinite(mark.y)) continue;
      line.x.push_back(mark.x);
      line.y.push_back(mark.y);
    }
    chart.curves = {line};
  }
  chart.logarithmic_y = plot::suits_logarithm(y_range(chart));
  chart.x_label = units.with_unit(key) + (chart.logarithmic_x ? ", logarithmic" : "");
  chart.y_label = units.with_unit(sweep.metrics[metric]) + (chart.logarithmic_y ? ", logarithmic" : "");
  return {plot::draw(chart), chart.width};
}

Plot heat_map(const Sweep& sweep, const std::vector<Row>& rows, const Units& units, size_t metric) {
  const Axis &down = sweep.grid[0], &across = sweep.grid[1];
  std::vector<Place> places(down.values.size() * across.values.size());
  for (size_t run = 0; run < rows.size(); ++run) {
    const std::vector<size_t> point = sweep.point_of(static_cast<int64_t>(run));
    places[point[0] * across.values.size() + point[1]].add(rows[run], metric);
  }
  plot::HeatMap map;
  map.title = fmt::format("{} over {} and {}", sweep.metrics[metric], across.key, down.key);
  map.x_name = units.with_unit(across.key);
  map.y_name = units.with_unit(down.key);
  map.value_name = units.with_unit(sweep.metrics[metric]);
  for (const std::string& value : across.values) map.columns.push_back(short_figure(value));
  for (const std::string& value : down.values) map.rows.push_back(short_figure(value));
  for (size_t i = 0; i < places.size(); ++i) {
    const std::string where = fmt::format("{} {}, {} {}", down.key, down.values[i / across.values.size()],
                                          across.key, across.values[i % across.values.size()]);
    map.cells.push_back({places[i].mean(), places[i].without > 0,
                         places.size() > kMaxTooltips ? "" : places[i].tooltip(where)});
  }
  return {plot::draw(map), plot::map_width(map.columns.size())};
}

}  // namespace

std::vector<Plot> plots_of(const Sweep& sweep, const std::vector<Row>& rows, const Units& units,
                           size_t metric) {
  std::vector<Plot> plots;
  if (sweep.grid.size() >= 2) plots.push_back(heat_map(sweep, rows, units, metric));
  if (sweep.grid.size() == 1) plots.push_back(along(sweep, rows, units, metric, 0, true));
  for (size_t i = 0; i < sweep.draws.size(); ++i)
    plots.push_back(along(sweep, rows, units, metric, sweep.grid.size() + i, false));
  return plots;
}

}  // namespace lab::sweep
