#include "lab/tool/metrics_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/util/json_text.h"
#include "core/util/number.h"
#include "core/util/printable.h"
#include "lab/evaluation/running_stats.h"
#include "lab/evaluation/tracking.h"
#include "lab/evaluation/units.h"

namespace lab {
namespace {

using nlohmann::json;

std::string cell(const json& value) { return value.is_number() ? rounded(value.get<double>()) : "-"; }

/// "0.3 rad", or of a robot with joints of both kinds "0.3 rad and 0.1 m".
std::string figure(const json& all, const std::string& metric, const rbd::Model& model) {
  std::string out;
  for (const Figure& one : figures_of(all, metric, model))
    out += (out.empty() ? "" : " and ") + (std::isfinite(one.value) ? rounded(one.value) : "-") +
           (one.unit.empty() ? "" : " " + one.unit);
  return out;
}

std::string joint_table(const json& all, const rbd::Model& model, bool sliding) {
  constexpr const char* kColumns[] = {"max_error",   "mean_error",    "rms_error",
                                      "final_error", "settling_time", "max_effort"};
  const std::vector<TrackedJoint> joints = joints_of(model);
  size_t width = 6;
  std::string a_joint;
  for (const TrackedJoint& joint : joints) {
    if (slides(model, joint.iv) != sliding) continue;
    width = std::max(width, printable_name(joint.name).size());
    a_joint = "." + joint.name;
  }
  if (a_joint.empty() || all["joints"].empty()) return "";
  std::string out = fmt::format("{:<{}}", "joint", width + 2);
  for (const char* column : kColumns) out += fmt::format(" {:>13}", column);
  out += fmt::format("\n{:<{}}", "", width + 2);
  for (const char* column : kColumns)
    out += fmt::format(" {:>13}", "(" + unit_of(column + a_joint, model) + ")");
  out += "\n";
  for (size_t j = 0; j < joints.size(); ++j) {
    if (slides(model, joints[j].iv) != sliding) continue;
    out += fmt::format("{:<{}}", printable_name(joints[j].name), width + 2);
    for (const char* column : kColumns)
      out += fmt::format(" {:>13}", cell(all["joints"][j].value(column, json())));
    out += "\n";
  }
  out += fmt::format("{:<{}}", "all", width + 2);
  for (const char* column : kColumns)
    out += fmt::format(" {:>13}", cell(number_or_null(figure_over(all, column, model, sliding).value)));
  return out + "\n";
}

std::string reach_line(const json& all, const rbd::Model& model) {
  const size_t count = all["reaches"].size();
  const json& settling = all["reach_settling_max"];
  return fmt::format("{} {}: {}, overshoot {}, steady error {}\n", count, count == 1 ? "reach" : "reaches",
                     settling.is_number() ? "settled within " + cell(settling) + " s" : "not settled",
                     figure(all, "overshoot_max", model), figure(all, "steady_error_max", model));
}

std::string verdict_line(const json& all, const json& verdict, const rbd::Model& model) {
  const std::string metric = verdict["metric"];
  std::string out = fmt::format("{}{} {}", verdict["ok"].get<bool>() ? "ok      " : "FAILED  ",
                                printable(metric), cell(verdict["value"]));
  if (verdict.contains("min")) out += ", at least " + cell(verdict["min"]);
  if (verdict.contains("max")) out += ", at most " + cell(verdict["max"]);
  const std::string unit = figure_of(all, metric, model).unit;
  return out + (unit.empty() ? "" : " " + unit) + "\n";
}

}  // namespace

std::string metrics_text(const json& all, const rbd::Model& model) {
  std::string out = joint_table(all, model, false) + joint_table(all, model, true);
  if (all.contains("handbook_grade"))
    out += fmt::format("handbook's figure {} ({}), energy drift {} J\n", figure(all, "handbook_error", model),
                       all["handbook_grade"].get<std::string>(), cell(all["energy_drift"]));
  if (all.contains("tool_frame") && all["tool_frame"].is_string())
    out += fmt::format("tool {} within {} m and {} rad of its reference\n",
                       printable_name(all["tool_frame"].get<std::string>()), cell(all["max_tool_error"]),
                       cell(all["max_tool_turn"]));
  if (!all["reaches"].empty()) out += reach_line(all, model);
  for (const json& verdict : all["verdicts"]) out += verdict_line(all, verdict, model);
  if (!all["complete"].get<bool>()) {
    const std::string reason = all["reason"];
    out += fmt::format("FAILED  the run ended at step {} of {}{}\n", json_text(all["last_step"]),
                       json_text(all["wanted_last_step"]), reason.empty() ? "" : ": " + reason);
  }
  return out;
}

}  // namespace lab
