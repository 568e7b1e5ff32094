#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>
#include <functional>
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

/// Gives every point (time, value) of a run's curve to `add`.
using Points = std::function<void(const Run&, const std::function<void(double, double)>& add)>;

/// One curve per run.
Chart overlaid(const Comparison& all, const std::vector<Folder>& runs, const std::string& title,
               size_t charts, const Points& points) {
  Chart chart{.title = title};
  for (size_t i = 0; i < runs.size(); ++i) {
    const Run& run = runs[i].log().run;
    plot::Thinned thinned(run.steps.size(), buckets_for(2 * charts * runs.size()));
    points(run, [&](double time, double value) { thinned.add(time, value); });
    Curve curve = thinned.curve(all.names[i], plot::Ink::Blue);
    if (curve.y.empty()) continue;
    ink(curve, i);
    chart.curves.push_back(std::move(curve));
  }
  return chart;
}

/// Of each step what `value` makes of the errors of these joints; nothing if the run has none of them.
Points of_errors(const std::vector<std::string>& names, double (*value)(const std::vector<double>&)) {
  return [names, value](const Run& run, const std::function<void(double, double)>& add) {
    std::vector<int> places;
    for (const TrackedJoint& joint : joints_of(run.model))
      if (std::find(names.begin(), names.end(), joint.name) != names.end()) places.push_back(joint.iv);
    if (places.empty()) return;
    Eigen::VectorXd e(run.model.nv);
    std::vector<double> errors(places.size());
    StepReader steps(run.steps);
    for (size_t k = 0; k < run.steps.size(); ++k) {
      const RunStep& step = steps.at(k);
      rbd::difference(run.model, step.state.q, step.reference.q, e);
      for (size_t j = 0; j < places.size(); ++j) errors[j] = e[places[j]];
      add(time_of(step, run), value(errors));
    }
  };
}

/// Root of the sum of the squares.
double norm(const std::vector<double>& errors) {
  double squares = 0;
  for (double e : errors) squares += e * e;
  return std::sqrt(squares);
}

Points of_tool(double ToolStep::* value) {
  return [value](const Run& run, const std::function<void(double, double)>& add) {
    for_each_tool_step(run, [&](const ToolStep& step) { add(step.time, step.*value); });
  };
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
    Chart chart = overlaid(all, runs, "size of the error over time", 2, of_errors(names, norm));
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
  Chart error = overlaid(all, runs, "tool error over time", 2, of_tool(&ToolStep::error));
  Chart angle = overlaid(all, runs, "tool angle over time", 2, of_tool(&ToolStep::angle));
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
                           of_errors({name}, [](const std::vector<double>& errors) { return errors[0]; }));
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
