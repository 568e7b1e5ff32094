#include "lab/sweep/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lab/evaluation/evaluate.h"
#include "lab/page/page.h"
#include "lab/page/template.h"
#include "lab/plot/draw.h"
#include "lab/sweep/plots.h"
#include "lab/sweep/table.h"
#include "lab/sweep/units.h"

namespace lab::sweep {

const lab::page::Texts& embedded();

namespace {

using lab::page::figure;
using lab::page::short_figure;
using nlohmann::json;

constexpr size_t kMaxNamed = 20;  // runs that went wrong, in the table

/// "controller.kp 50, controller.kd 10", numbers in four digits
std::string short_settings(const Sweep& sweep, int64_t run) {
  std::string text;
  const std::vector<std::string> keys = sweep.keys(), values = sweep.values(run);
  for (size_t i = 0; i < keys.size(); ++i) text += (i ? ", " : "") + keys[i] + " " + short_figure(values[i]);
  return text;
}

/// All values of a key, or the first three and the last of more than eight.
std::string short_list(const std::vector<std::string>& values) {
  const size_t shown = values.size() > 8 ? 3 : values.size();
  std::string text;
  for (size_t i = 0; i < shown; ++i) text += (i ? ", " : "") + short_figure(values[i]);
  return shown < values.size() ? text + ", .., " + short_figure(values.back()) : text;
}

json grid_rows(const Sweep& sweep, const Units& units) {
  json rows = json::array();
  for (const Axis& axis : sweep.grid)
    rows.push_back({{"key", axis.key},
                    {"unit", units.of_key(axis.key)},
                    {"count", axis.values.size()},
                    {"values", short_list(axis.values)}});
  return rows;
}

json draw_rows(const Sweep& sweep, const Units& units) {
  json rows = json::array();
  for (const Draw& draw : sweep.draws)
    rows.push_back({{"key", draw.key},
                    {"unit", units.of_key(draw.key)},
                    {"count", sweep.draw_count},
                    {"seed", sweep.seed}});
  return rows;
}

/// What the metric is.
std::string what(const std::string& name) {
  const size_t dot = name.find('.');
  const Metric* const known = metric_of(name);
  if (!known) return "";
  return known->what + (dot == std::string::npos ? "" : "; here of " + name.substr(dot + 1) + " alone");
}

json metric_values(const Sweep& sweep, const std::vector<Row>& rows, const Units& units, size_t m) {
  const Extremes found = extremes(rows, m);
  const auto about = [&](int64_t run) -> json {
    if (run < 0) return {{"value", "–"}, {"run", ""}};
    return {{"value", figure(rows[static_cast<size_t>(run)].metrics[m])},
            {"run", fmt::format("{}: {}", run, short_settings(sweep, run))}};
  };
  json out{{"name", lab::page::breakable(sweep.metrics[m])},
           {"unit", units.of_metric(sweep.metrics[m])},
           {"what", what(sweep.metrics[m])},
           {"smallest", about(found.smallest)},
           {"largest", about(found.largest)},
           {"has_values", found.smallest >= 0}};
  if (found.smallest < 0) return out;
  for (const Plot& one : plots_of(sweep, rows, units, m))
    out["plots"].push_back({{"svg", one.svg}, {"width", one.width}});
  out["means"] = sweep.grid.size() > 2 || (!sweep.draws.empty() && !sweep.grid.empty());
  out["command"] = command(sweep, found.smallest);
  return out;
}

}  // namespace

std::string page(const Sweep& sweep, const std::vector<Row>& rows) {
  const Counts counts = count(rows);
  const Units units(sweep);
  json set = json::array(), metrics = json::array(), incomplete = json::array();
  for (const Override& one : sweep.set) set.push_back(one.text);
  for (size_t m = 0; m < sweep.metrics.size(); ++m) metrics.push_back(metric_values(sweep, rows, units, m));
  size_t wrong = 0;
  for (size_t run = 0; run < rows.size(); ++run) {
    if (rows[run].complete || ++wrong > kMaxNamed) continue;
    incomplete.push_back({{"run", run},
                          {"settings", short_settings(sweep, static_cast<int64_t>(run))},
                          {"reason", rows[run].reason}});
  }
  json values{{"name", sweep.name},
              {"runs", rows.size()},
              {"experiment", std::filesystem::path(sweep.experiment).filename().string()},
              {"complete", counts.complete},
              {"ended_early", counts.ended_early},
              {"unable", counts.unable},
              {"set", std::move(set)},
              {"grid", grid_rows(sweep, units)},
              {"draws", draw_rows(sweep, units)},
              {"side_by_side", !sweep.grid.empty() + sweep.draws.size() == 1},  // each metric has one plot
              {"least_width", sweep.grid.size() < 2 ? 480 : plot::map_width(sweep.grid[1].values.size())},
              {"metrics", std::move(metrics)},
              {"has_incomplete", wrong > 0},
              {"incomplete", std::move(incomplete)},
              {"more_incomplete", nullptr}};
  if (wrong > kMaxNamed) values["more_incomplete"] = std::to_string(wrong - kMaxNamed);
  return lab::page::document("sweep " + sweep.name, lab::page::fill(embedded(), "sweep.html", values));
}

}  // namespace lab::sweep
