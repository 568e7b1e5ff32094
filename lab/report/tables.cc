#include "lab/report/tables.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/evaluation/metrics.h"
#include "lab/evaluation/tracking.h"
#include "lab/page/page.h"

namespace lab::report {
namespace {

using nlohmann::json;
using page::figure;

bool has_both_kinds(const rbd::Model& model) { return unit_of("max_error", model) == "rad or m"; }

/// The columns of the table of joints: a metric, and its words.
constexpr std::pair<const char*, const char*> kJointColumns[] = {{"max_error", "max error"},
                                                                 {"mean_error", "mean error"},
                                                                 {"rms_error", "RMS error"},
                                                                 {"final_error", "final error"},
                                                                 {"max_effort", "max effort"},
                                                                 {"rms_effort", "RMS effort"},
                                                                 {"max_effort_share", "effort / limit"},
                                                                 {"max_speed", "max speed"},
                                                                 {"max_speed_share", "speed / limit"},
                                                                 {"min_position_margin", "margin to limit"}};

json joint_table(const json& m, const rbd::Model& model, bool sliding) {
  json columns = json::array(), rows = json::array();
  const auto unit_here = [&](const std::string& metric) {
    for (const TrackedJoint& joint : joints_of(model))
      if (slides(model, joint.iv) == sliding) return unit_of(metric + "." + joint.name, model);
    return std::string();
  };
  for (const auto& [key, label] : kJointColumns)
    columns.push_back({{"label", label}, {"unit", unit_here(key)}});
  const std::vector<TrackedJoint> joints = joints_of(model);
  for (size_t j = 0; j < joints.size(); ++j) {
    if (slides(model, joints[j].iv) != sliding) continue;
    json cells = json::array();
    for (const auto& [key, label] : kJointColumns) cells.push_back(figure(number_in(m["joints"][j], key), 3));
    rows.push_back({{"name", page::breakable(joints[j].name)}, {"cells", std::move(cells)}});
  }
  if (rows.size() > 1) {
    json cells = json::array();
    for (const auto& [key, label] : kJointColumns) {
      cells.push_back(figure(figure_over(m, key, model, sliding).value, 3));
    }
    rows.push_back({{"name", "all"}, {"cells", std::move(cells)}});
  }
  return {{"columns", std::move(columns)}, {"rows", std::move(rows)}};
}

/// A reach with the names of metrics, as figures_of() reads them.
json as_metrics(const json& reach) {
  json out = reach;
  for (json& joint : out["joints"]) {
    joint["reach_settling_max"] = joint["settling"];
    joint["overshoot_max"] = joint["overshoot"];
    joint["overshoot_share_max"] = joint["overshoot_share"];
    joint["steady_error_max"] = joint["steady_error"];
  }
  return out;
}

json list_of_shown(const std::vector<Figure>& figures) {
  json list = json::array();
  for (const Figure& one : figures) list.push_back(shown(one));
  return list;
}

}  // namespace

json shown(const Figure& one, int digits) {
  return {{"value", figure(one.value, digits)},
          {"unit", std::isfinite(one.value) ? one.unit : ""},
          {"joint", page::breakable(one.joint)},
          {"bad", false}};
}

json key_figures(const json& m, const rbd::Model& model) {
  json out = json::array();
  const auto add = [&](const std::string& label, const std::string& metric) {
    const std::vector<Figure> figures = figures_of(m, metric, model);
    for (const Figure& one : figures) {
      json tile = shown(one, 3);
      tile["label"] = label + (figures.size() > 1 ? ", in " + one.unit : "");
      out.push_back(std::move(tile));
    }
  };
  add("largest error", "max_error");
  add("RMS error", "rms_error");
  if (m["tool_frame"].is_string()) add("largest tool error", "max_tool_error");
  if (number_in(m, "reach_count") > 0) {
    add("settling, slowest reach", "reach_settling_max");
    if (m["reach_settling_max"].is_null()) out.back().update({{"value", "not settled"}, {"bad", true}});
    if (std::isfinite(number_in(m, "overshoot_max"))) add("largest overshoot", "overshoot_max");
    if (std::isfinite(number_in(m, "overshoot_share_max"))) add("overshoot / way", "overshoot_share_max");
  }
  if (number_in(m, "max_effort_share") > 0) add("effort / limit", "max_effort_share");
  add("largest effort", "max_effort");
  add("energy drift", "energy_drift");
  if (m.contains("handbook_grade")) {
    const std::string grade = m["handbook_grade"];
    out.push_back({{"label", "handbook's grade"},
                   {"bad", false},
                   {"value", grade == "needs_tuning" ? "needs tuning" : grade},
                   {"unit", ""},
                   {"joint", ""}});
  }
  return out;
}

json verdict_rows(const json& m, const rbd::Model& model) {
  json rows = json::array();
  for (const json& one : m["verdicts"]) {
    const std::string name = one["metric"];
    const Figure found = figure_of(m, name, model);
    rows.push_back({{"ok", one["ok"]},
                    {"metric", page::breakable(name)},
                    {"value", figure(number_in(one, "value"))},
                    {"unit", found.unit},
                    {"joint", page::breakable(found.joint)},
                    {"min", one.contains("min") ? figure(number_in(one, "min")) : ""},
                    {"max", one.contains("max") ? figure(number_in(one, "max")) : ""}});
  }
  return rows;
}

json joint_tables(const json& m, const rbd::Model& model) {
  json tables = json::array();
  for (const bool sliding : {false, true})
    if (json table = joint_table(m, model, sliding); !table["rows"].empty())
      tables.push_back(std::move(table));
  return tables;
}

json reach_rows(const json& m, const rbd::Model& model) {
  json rows = json::array();
  for (const json& one : m["reaches"]) {
    const json reach = as_metrics(one);
    json settling = shown(figures_of(reach, "reach_settling_max", model)[0]);
    settling["never"] = one["reach_settling_max"].is_null();
    rows.push_back({{"number", rows.size() + 1},
                    {"arrival", figure(number_in(one, "arrival"))},
                    {"end", figure(number_in(one, "end"))},
                    {"settling", std::move(settling)},
                    {"overshoot", list_of_shown(figures_of(reach, "overshoot_max", model))},
                    {"overshoot_share", list_of_shown(figures_of(reach, "overshoot_share_max", model))},
                    {"steady_error", list_of_shown(figures_of(reach, "steady_error_max", model))}});
  }
  return rows;
}

json metric_rows(const json& m, const rbd::Model& model) {
  json rows = json::array();
  for (const Metric& metric : metrics())
    for (const Figure& one : figures_of(m, metric.name, model)) {
      json row = shown(one);
      row["name"] = page::breakable(metric.name);
      rows.push_back(std::move(row));
    }
  return rows;
}

std::string band_in_words(double band, const rbd::Model& model) {
  if (has_both_kinds(model)) return figure(band) + " rad or " + figure(band) + " m";
  return figure(band) + " " + unit_of("max_error", model);
}

}  // namespace lab::report
