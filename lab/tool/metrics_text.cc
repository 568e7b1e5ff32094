#include "lab/tool/metrics_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/util/json_text.h"
#include "core/util/number.h"
#include "core/util/printable.h"
#include "lab/evaluation/metrics.h"

namespace lab {
namespace {

using nlohmann::json;

std::string cell(const json& value) { return value.is_number() ? rounded(value.get<double>()) : "-"; }

/// The unit of a metric, or of "max_error.elbow"; "" if it has none.
std::string unit_of(const std::string& name) {
  const std::string metric = name.substr(0, name.find('.'));
  for (const Metric& known : metrics())
    if (metric == known.name) return known.unit;
  return "";
}
/// A value of a metric with its unit.
std::string figure(const json& all, const std::string& metric) {
  const std::string unit = unit_of(metric);
  return cell(all.value(metric, json())) + (unit.empty() ? "" : " " + unit);
}

std::string joint_table(const json& all) {
  constexpr const char* kColumns[] = {"max_error",   "mean_error",    "rms_error",
                                      "final_error", "settling_time", "max_effort"};
  size_t width = 6;
  for (const json& joint : all["joints"])
    width = std::max(width, printable_name(joint["name"].get<std::string>()).size());
  std::string out = fmt::format("{:<{}}", "joint", width + 2);
  for (const char* column : kColumns) out += fmt::format(" {:>13}", column);
  out += fmt::format("\n{:<{}}", "", width + 2);
  for (const char* column : kColumns) out += fmt::format(" {:>13}", "(" + unit_of(column) + ")");
  out += "\n";
  const auto add = [&](const std::string& name, const json& row) {
    out += fmt::format("{:<{}}", name, width + 2);
    for (const char* column : kColumns) out += fmt::format(" {:>13}", cell(row.value(column, json())));
    out += "\n";
  };
  for (const json& joint : all["joints"]) add(printable_name(joint["name"].get<std::string>()), joint);
  add("all", all);
  return out;
}

std::string reach_line(const json& all) {
  const size_t count = all["reaches"].size();
  const json& settling = all["reach_settling_max"];
  return fmt::format("{} {}: {}, overshoot {}, steady error {}\n", count, count == 1 ? "reach" : "reaches",
                     settling.is_number() ? "settled within " + cell(settling) + " s" : "not settled",
                     figure(all, "overshoot_max"), figure(all, "steady_error_max"));
}

std::string verdict_line(const json& verdict) {
  std::string out = fmt::format("{}{} {}", verdict["ok"].get<bool>() ? "ok      " : "FAILED  ",
                                printable(verdict["metric"].get<std::string>()), cell(verdict["value"]));
  if (verdict.contains("min")) out += ", at least " + cell(verdict["min"]);
  if (verdict.contains("max")) out += ", at most " + cell(verdict["max"]);
  const std::string unit = unit_of(verdict["metric"].get<std::string>());
  return out + (unit.empty() ? "" : " " + unit) + "\n";
}

}  // namespace

std::string metrics_text(const json& all) {
  std::string out = joint_table(all);
  if (all.contains("handbook_grade"))
    out += fmt::format("handbook's figure {} ({}), energy drift {} J\n", figure(all, "handbook_error"),
                       all["handbook_grade"].get<std::string>(), cell(all["energy_drift"]));
  if (all.contains("tool_frame") && all["tool_frame"].is_string())
    out += fmt::format("tool {} within {} m and {} rad of its reference\n",
                       printable_name(all["tool_frame"].get<std::string>()), cell(all["max_tool_error"]),
                       cell(all["max_tool_turn"]));
  if (!all["reaches"].empty()) out += reach_line(all);
  for (const json& verdict : all["verdicts"]) out += verdict_line(verdict);
  if (!all["complete"].get<bool>()) {
    const std::string reason = all["reason"];
    out += fmt::format("FAILED  the run ended at step {} of {}{}\n", json_text(all["last_step"]),
                       json_text(all["wanted_last_step"]), reason.empty() ? "" : ": " + reason);
  }
  return out;
}

}  // namespace lab
