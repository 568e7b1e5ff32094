#include "lab/sweep/table.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/util/number.h"

namespace lab::sweep {
namespace {

using nlohmann::json;

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::string head(const Sweep& sweep) {
  std::string line = sweep.draws.empty() ? "run" : "run,draw";
  for (const std::string& key : sweep.keys()) line += "," + cell(key);
  return line;
}

std::string start(const Sweep& sweep, int64_t run) {
  std::string line =
      sweep.draws.empty() ? fmt::format("{}", run) : fmt::format("{},{}", run, sweep.draw_of(run));
  for (const std::string& value : sweep.values(run)) line += "," + cell(value);
  return line;
}

json set_of(const Sweep& sweep, int64_t run) {
  json set = json::object();
  const std::vector<std::string> keys = sweep.keys(), values = sweep.values(run);
  for (size_t i = 0; i < keys.size(); ++i) set[keys[i]] = values[i];
  return set;
}

/// As a shell takes it.
std::string word(const std::string& text) {
  if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:+") ==
      std::string::npos)
    return text;
  std::string out = "'";
  for (char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

}  // namespace

std::string csv(const Sweep& sweep, const std::vector<Row>& rows) {
  std::string out = head(sweep);
  for (const std::string& metric : sweep.metrics) out += "," + cell(metric);
  out += ",complete,passed,last_step,reason\n";
  for (size_t run = 0; run < rows.size(); ++run) {
    const Row& row = rows[run];
    out += start(sweep, static_cast<int64_t>(run));
    for (size_t m = 0; m < sweep.metrics.size(); ++m)
      out += "," + (m < row.metrics.size() && std::isfinite(row.metrics[m]) ? number(row.metrics[m]) : "");
    const bool done = row.state == Row::State::Done;
    out += fmt::format(",{},{},{},{}\n", row.complete, row.passed,
                       done ? fmt::format("{}", row.last_step) : "", cell(row.reason));
  }
  return out;
}

std::string list_of_runs(const Sweep& sweep) {
  std::string out = head(sweep) + "\n";
  for (int64_t run = 0; run < sweep.runs(); ++run) out += start(sweep, run) + "\n";
  return out;
}

json runs_as_json(const Sweep& sweep) {
  json all = json::array();
  for (int64_t run = 0; run < sweep.runs(); ++run) all.push_back({{"run", run}, {"set", set_of(sweep, run)}});
  return all;
}

Counts count(const std::vector<Row>& rows) {
  Counts counts;
  for (const Row& row : rows) {
    if (row.state == Row::State::Missing)
      ++counts.missing;
    else if (row.state == Row::State::Unable)
      ++counts.unable;
    else
      ++(row.complete ? counts.complete : counts.ended_early);
  }
  return counts;
}

Extremes extremes(const std::vector<Row>& rows, size_t metric) {
  Extremes found;
  const auto value = [&](int64_t run) { return rows[static_cast<size_t>(run)].metrics[metric]; };
  for (int64_t run = 0; run < static_cast<int64_t>(rows.size()); ++run) {
    if (rows[static_cast<size_t>(run)].metrics.empty() || !std::isfinite(value(run))) continue;
    if (found.smallest < 0 || value(run) < value(found.smallest)) found.smallest = run;
    if (found.largest < 0 || value(run) > value(found.largest)) found.largest = run;
  }
  return found;
}

std::string settings(const Sweep& sweep, int64_t run) {
  std::string text;
  const std::vector<std::string> keys = sweep.keys(), values = sweep.values(run);
  for (size_t i = 0; i < keys.size(); ++i) text += (i ? ", " : "") + keys[i] + " " + values[i];
  return text;
}

std::string command(const Sweep& sweep, int64_t run) {
  std::string text = "scripts/lab run " + word(std::filesystem::path(sweep.experiment).filename());
  for (const Override& one : sweep.overrides(run)) text += " --set " + word(one.text);
  return text;
}

json summary(const Sweep& sweep, const std::vector<Row>& rows) {
  const Counts counts = count(rows);
  json best = json::object();
  for (size_t m = 0; m < sweep.metrics.size(); ++m) {
    const Extremes found = extremes(rows, m);
    const auto about = [&](int64_t run) {
      if (run < 0) return json();
      return json{
          {"run", run}, {"value", rows[static_cast<size_t>(run)].metrics[m]}, {"set", set_of(sweep, run)}};
    };
    best[sweep.metrics[m]] = {{"smallest", about(found.smallest)}, {"largest", about(found.largest)}};
  }
  return {{"sweep", sweep.name},
          {"experiment", sweep.experiment},
          {"runs", rows.size()},
          {"complete", counts.complete},
          {"ended_early", counts.ended_early},
          {"unable", counts.unable},
          {"metrics", best}};
}

}  // namespace lab::sweep
