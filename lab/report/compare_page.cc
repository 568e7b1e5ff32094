#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

#include "lab/report/compare.h"
#include "lab/report/figures.h"
#include "lab/report/html.h"

namespace lab::report {
namespace {

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
    Curve curve{.label = all.names[i], .x = times(runs[i].logged->run), .y = value(runs[i].logged->run)};
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

Gallery overview(const Comparison& all, const std::vector<Folder>& runs) {
  Gallery out;
  out.legend = legend_of(all);
  out.columns = 1;
  if (!all.joints.empty()) {
    Chart chart = overlaid(all, runs, "size of the error over time", 2,
                           [&](const Run& run) { return norm(run, all.joints); });
    chart.width = 1080, chart.height = 290, chart.logarithmic = true;
    out.figures.push_back({"Size of the error, all common joints", "rad, m; logarithmic", std::move(chart)});
  }
  return out;
}

Gallery tools(const Comparison& all, const std::vector<Folder>& runs) {
  Gallery out;
  out.legend = legend_of(all);
  out.columns = 2;
  Chart error =
      overlaid(all, runs, "tool error over time", 2, [](const Run& run) { return tool_path(run).error; });
  Chart turn =
      overlaid(all, runs, "tool angle over time", 2, [](const Run& run) { return tool_path(run).angle; });
  for (auto& [chart, caption, unit] : {std::tuple(&error, "Tool: distance from the reference", "m"),
                                       {&turn, "Tool: angle from the reference", "rad"}}) {
    if (chart->curves.empty()) continue;
    chart->width = 530, chart->height = 210;
    const Scale scale = scale_for(y_range(*chart).second, unit);
    rescale(*chart, scale.factor);
    out.figures.push_back({caption, scale.unit, std::move(*chart)});
  }
  return out;
}

Gallery joints(const Comparison& all, const std::vector<Folder>& runs) {
  Gallery out;
  out.legend = legend_of(all);
  for (const std::string& name : all.joints) {
    Chart chart = overlaid(all, runs, name + ": error over time", all.joints.size(),
                           [&](const Run& run) { return error_of(run, name); });
    const rbd::Model& model = runs[0].logged->run.model;
    const auto [low, high] = y_range(chart);
    const Scale scale = scale_for(std::max(std::abs(low), std::abs(high)),
                                  unit_of(model, model.joints[model.getJointId(name)].idx_v()));
    rescale(chart, scale.factor);
    out.figures.push_back({name, scale.unit, std::move(chart)});
  }
  return out;
}

std::string key_table(const Comparison& all) {
  if (all.keys.empty()) return missing("The experiments are the same, key for key.");
  Table table{{"key"}, {}, all.names.size() + 1};
  for (const std::string& name : all.names) table.head.push_back(escape(name));
  for (const Comparison::Key& key : all.keys) {
    std::vector<std::string> row{"<code>" + escape(key.name) + "</code>"};
    for (const std::string& value : key.values) row.push_back(value.empty() ? "–" : escape(value));
    table.rows.push_back(row);
  }
  return table.html();
}

std::string metric_table(const Comparison& all, bool per_joint) {
  // of more than three runs a value and what it is against the first share a cell, so that all of them are in sight
  const bool share = all.names.size() > 3;
  const std::string against = "against " + escape(all.names[0]);
  Table table{{"metric", "unit", escape(all.names[0])}, {}, 2, share};
  const auto add = [&](std::vector<std::string>& row, const std::string& value, const std::string& words) {
    if (share)
      row.push_back(value + "<br>" + words);
    else
      row.push_back(value), row.push_back(words);
  };
  for (size_t i = 1; i < all.names.size(); ++i) add(table.head, escape(all.names[i]), against);
  for (const Comparison::Row& one : all.rows) {
    if ((one.name.find('.') != std::string::npos) != per_joint) continue;
    std::vector<std::string> row{"<code>" + escape(one.name) + "</code>", one.unit, figure(one.values[0])};
    for (size_t i = 1; i < one.values.size(); ++i) {
      const std::string words = in_words(one.better, one.values[0], one.values[i]);
      const char* mood = words.ends_with("better") ? "good" : words.ends_with("worse") ? "bad" : "soft";
      add(row, figure(one.values[i]), std::string("<span class=\"") + mood + "\">" + words + "</span>");
    }
    table.rows.push_back(row);
  }
  return table.rows.empty() ? "" : table.html();
}

}  // namespace

Page compare_page(const Comparison& all, const std::vector<Folder>& runs) {
  std::string title;
  for (const std::string& name : all.names) title += (title.empty() ? "" : " · ") + name;
  std::string body = "<header>\n<h1>" + std::to_string(runs.size()) + " runs side by side</h1>\n";
  Table table{{"run", "", "what", "RMS error"}, {}, 3};
  for (size_t i = 0; i < runs.size(); ++i) {
    const nlohmann::json rms = value_of(runs[i].metrics, "rms_error");
    table.rows.push_back({"<strong>" + escape(all.names[i]) + "</strong>", badge_html(badge_of(runs[i])),
                          escape(about(runs[i])), figure(rms.is_number() ? rms.get<double>() : NAN)});
  }
  body += table.html();
  for (const std::string& note : all.notes) body += missing(note);
  body += "</header>\n";
  const Shown shown = show({overview(all, runs), tools(all, runs), joints(all, runs)});
  body += section("What is different", key_table(all));
  body += section("What came of it", metric_table(all, false));
  body += section("Errors", shown.html[0]);
  body += section(
      "Joints", (shown.html[2].empty() ? missing("No joint has the same name in all runs.") : shown.html[2]) +
                    metric_table(all, true));
  body += section("Tool", shown.html[1].empty() ? missing("No run has a tool.") : shown.html[1]);
  Page page;
  page.drawn = shown.drawn;
  page.html = report::page(title, body);
  return page;
}

}  // namespace lab::report
