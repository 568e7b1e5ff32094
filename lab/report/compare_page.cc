#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/page/page.h"
#include "lab/report/charts.h"
#include "lab/report/compare.h"
#include "lab/report/tables.h"

namespace lab::report {
namespace {

using nlohmann::json;
using page::figure;
using plot::Chart;
using plot::Curve;

std::vector<Curve> legend_of(const Comparison& all) {
  std::vector<Curve> legend;
  for (size_t i = 0; i < all.names.size(); ++i) {
    legend.push_back({.label = all.names[i]});
    ink(legend.back(), i);
  }
  return legend;
}

/// One curve per run; `value(run)` is by step.
template <class F>
Chart overlaid(const Comparison& all, const std::vector<Folder>& runs, const std::string& title,
               size_t charts, F&& value) {
  Chart chart{.title = title};
  for (size_t i = 0; i < runs.size(); ++i) {
    const Run& run = runs[i].log().run;
    Curve curve{.label = all.names[i], .x = times(run), .y = value(run)};
    if (curve.y.empty()) continue;
    thin(curve, buckets_for(2 * charts * runs.size()));
    ink(curve, i);
    chart.curves.push_back(std::move(curve));
  }
  return chart;
}

/// By step: root of the sum of the squared errors of these joints.
std::vector<double> norm(const Run& run, const std::vector<std::string>& names) {
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  const std::vector<std::vector<double>> e = errors(run);
  std::vector<double> out(run.states.size());
  for (size_t k = 0; k < out.size(); ++k) {
    for (size_t j = 0; j < joints.size(); ++j)
      if (std::find(names.begin(), names.end(), joints[j].name) != names.end()) out[k] += e[j][k] * e[j][k];
    out[k] = std::sqrt(out[k]);
  }
  return out;
}

std::vector<double> error_of(const Run& run, const std::string& name) {
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  for (size_t j = 0; j < joints.size(); ++j)
    if (joints[j].name == name) return errors(run)[j];
  return {};
}

ChartGroup overview(const Comparison& all, const std::vector<Folder>& runs) {
  ChartGroup out;
  out.legend = legend_of(all);
  out.columns = 1;
  const rbd::Model& model = runs[0].log().run.model;
  for (const char* const unit : {"rad", "m"}) {
    std::vector<std::string> names;
    for (const std::string& name : all.joints)
      if (unit_of("max_error." + name, model) == unit) names.push_back(name);
    if (names.empty()) continue;
    Chart chart = overlaid(all, runs, "size of the error over time", 2,
                           [&](const Run& run) { return norm(run, names); });
    chart.width = 1080;
    chart.height = 290;
    chart.logarithmic_y = true;
    out.panels.push_back(
        {"Size of the error, all common joints", std::string(unit) + ", logarithmic", std::move(chart)});
  }
  return out;
}

ChartGroup tools(const Comparison& all, const std::vector<Folder>& runs) {
  ChartGroup out;
  out.legend = legend_of(all);
  out.columns = 2;
  Chart error =
      overlaid(all, runs, "tool error over time", 2, [](const Run& run) { return tool_path(run).error; });
  Chart angle =
      overlaid(all, runs, "tool angle over time", 2, [](const Run& run) { return tool_path(run).angle; });
  for (auto& [chart, caption, unit] : {std::tuple(&error, "Tool: distance from the reference", "m"),
                                       {&angle, "Tool: angle from the reference", "rad"}}) {
    if (chart->curves.empty()) continue;
    chart->width = 530;
    chart->height = 210;
    out.panels.push_back({caption, unit, std::move(*chart)});
  }
  return out;
}

ChartGroup joints(const Comparison& all, const std::vector<Folder>& runs) {
  ChartGroup out;
  out.legend = legend_of(all);
  for (const std::string& name : all.joints) {
    Chart chart = overlaid(all, runs, name + ": error over time", all.joints.size(),
                           [&](const Run& run) { return error_of(run, name); });
    out.panels.push_back({name, unit_of("max_error." + name, runs[0].log().run.model), std::move(chart)});
  }
  return out;
}

json key_rows(const Comparison& all) {
  json rows = json::array();
  for (const Comparison::Key& key : all.keys) {
    json values = json::array();
    for (const std::string& value : key.values) values.push_back(value.empty() ? "–" : value);
    rows.push_back({{"name", page::breakable(key.name)}, {"values", std::move(values)}});
  }
  return rows;
}

std::vector<std::string> breakable(std::vector<std::string> names) {
  for (std::string& name : names) name = page::breakable(name);
  return names;
}

/// Of all joints, or joint by joint; null if there are none.
json metric_table(const Comparison& all, bool per_joint) {
  json rows = json::array();
  for (const Comparison::Row& one : all.rows) {
    if ((one.name.find('.') != std::string::npos) != per_joint) continue;
    json others = json::array();
    for (size_t i = 1; i < one.values.size(); ++i) {
      const std::string words = in_words(one.better, one.values[0], one.values[i]);
      const char* mood = words.ends_with("better") ? "good" : words.ends_with("worse") ? "bad" : "soft";
      others.push_back({{"value", figure(one.values[i])}, {"words", words}, {"mood", mood}});
    }
    rows.push_back({{"name", page::breakable(one.name)},
                    {"unit", one.unit},
                    {"value", figure(one.values[0])},
                    {"others", std::move(others)}});
  }
  if (rows.empty()) return nullptr;
  // of more than three runs a value and what it is against the first share a cell, so that the table fits the page
  std::vector<std::string> names = breakable(all.names);
  const std::string first = names[0];
  names.erase(names.begin());
  return {{"narrow", all.names.size() > 3},
          {"first", first},
          {"others", std::move(names)},
          {"rows", std::move(rows)}};
}

}  // namespace

std::string compare_page(const Comparison& all, const std::vector<Folder>& runs) {
  std::string title;
  for (const std::string& name : all.names) title += (title.empty() ? "" : " · ") + name;
  json rows = json::array();
  for (size_t i = 0; i < runs.size(); ++i) {
    json rms = json::array();
    for (const Figure& one : figures_of(runs[i].metrics, "rms_error", runs[i].log().run.model))
      rms.push_back(shown(one));
    rows.push_back({{"name", page::breakable(all.names[i])},
                    {"badge", badge_of(runs[i])},
                    {"about", about(runs[i])},
                    {"rms_error", std::move(rms)}});
  }
  const json values{{"count", runs.size()},
                    {"names", breakable(all.names)},
                    {"runs", std::move(rows)},
                    {"notes", all.notes},
                    {"has_keys", !all.keys.empty()},
                    {"keys", key_rows(all)},
                    {"metrics", metric_table(all, false)},
                    {"overview", drawn(overview(all, runs))},
                    {"joints", drawn(joints(all, runs))},
                    {"joint_metrics", metric_table(all, true)},
                    {"tool", drawn(tools(all, runs))}};
  return page::document(title, page::fill(embedded(), "compare.html", values));
}

}  // namespace lab::report
