#include "lab/report/compare.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "core/util/json_text.h"
#include "core/util/number.h"
#include "core/util/printable.h"
#include "lab/evaluation/tracking.h"
#include "lab/evaluation/units.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/page/page.h"

namespace lab::report {
namespace {

using nlohmann::json;
using page::figure;

std::vector<std::string> names_of(const std::vector<Folder>& runs) {
  std::vector<std::string> names;
  for (const Folder& run : runs) {
    std::string name = run.name;
    for (int n = 2; std::find(names.begin(), names.end(), name) != names.end(); ++n)
      name = run.name + " (" + std::to_string(n) + ")";
    names.push_back(name);
  }
  return names;
}

void find_joints(const std::vector<Folder>& runs, Comparison& out) {
  for (const Folder& run : runs) {
    std::vector<std::string> own;
    for (const TrackedJoint& joint : joints_of(run.log().run.model)) own.push_back(joint.name);
    if (&run == &runs.front()) {
      out.joints = own;
      continue;
    }
    if (own != out.joints) out.same_joints = false;
    std::erase_if(out.joints, [&](const std::string& name) {
      return std::find(own.begin(), own.end(), name) == own.end();
    });
  }
  if (out.same_joints) return;
  std::string note = "The robots differ (";
  for (size_t i = 0; i < runs.size(); ++i)
    note += (i ? ", " : "") + out.names[i] + ": " + printable_name(runs[i].log().robot.model.name);
  out.notes.push_back(note + "), so figures over all joints mean nothing: compared are the tool and " +
                      (out.joints.empty() ? "nothing else, as no joint has the same name in all of them."
                                          : "the joints that have the same name in all of them: " +
                                                list_of(out.joints) + "."));
}

void find_keys(const std::vector<Folder>& runs, Comparison& out) {
  for (size_t i = 0; i < runs.size(); ++i) {
    const std::optional<Experiment>& experiment = runs[i].experiment;
    if (!experiment) continue;
    const auto all = key_values(*experiment);
    out.keys.resize(all.size());
    for (size_t k = 0; k < all.size(); ++k) {
      out.keys[k].name = all[k].first;
      out.keys[k].values.resize(runs.size());
      out.keys[k].values[i] = all[k].second;
    }
  }
  std::erase_if(out.keys, [](const Comparison::Key& key) {
    return key.name == "name" || key.name == "expect" ||
           std::all_of(key.values.begin(), key.values.end(),
                       [&](const std::string& value) { return value == key.values.front(); });
  });
  for (Comparison::Key& key : out.keys) {  // of a path, the name is enough if it is another
    std::set<std::string> names;
    for (const std::string& value : key.values) names.insert(value.substr(value.rfind('/') + 1));
    if (key.name == "robot.model" && names.size() == key.values.size())
      for (std::string& value : key.values) value.erase(0, value.rfind('/') + 1);
  }
}

void add_row(Comparison::Row row, Comparison& out) {
  if (std::any_of(row.values.begin(), row.values.end(), [](double value) { return std::isfinite(value); }))
    out.rows.push_back(std::move(row));
}

/// Over all joints: a row for each unit.
void add_rows(const std::vector<Folder>& runs, const Metric& metric, Comparison& out) {
  std::vector<Comparison::Row> rows;
  for (const Folder& run : runs) {
    const std::vector<Figure> figures = figures_of(run.metrics, metric.name, run.log().run.model);
    for (size_t i = 0; i < figures.size(); ++i) {
      if (i == rows.size()) rows.push_back({metric.name, figures[i].unit, metric.better, {}});
      rows[i].values.push_back(figures[i].value);
    }
  }
  for (Comparison::Row& row : rows) add_row(std::move(row), out);
}

void find_rows(const std::vector<Folder>& runs, Comparison& out) {
  for (const Metric& metric : metrics())
    if (out.same_joints || std::string(metric.name).find("_tool_") != std::string::npos)
      add_rows(runs, metric, out);
  for (const Metric& metric : metrics()) {
    const std::string base = metric.name;
    if (!metric.per_joint || (out.same_joints && base != "max_error" && base != "rms_error")) continue;
    for (const std::string& joint : out.joints) {
      const std::string name = base + "." + joint;
      Comparison::Row row{name, unit_of(name, runs[0].log().run.model), metric.better, {}};
      for (const Folder& run : runs)
        row.values.push_back(figure_of(run.metrics, name, run.log().run.model).value);
      add_row(std::move(row), out);
    }
  }
}

/// Cells in columns: the first to the left, the others to the right.
std::string columns(std::vector<std::vector<std::string>> rows) {
  std::vector<size_t> width;
  const auto letters = [](const std::string& text) {  // of UTF-8
    return static_cast<size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
  };
  for (auto& row : rows) {
    for (std::string& cell : row)
      if (!cell.empty()) cell = printable_name(cell);
    width.resize(std::max(width.size(), row.size()));
    for (size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], letters(row[i]));
  }
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (size_t i = 0; i < row.size(); ++i) {
      const std::string room(width[i] - letters(row[i]), ' ');
      line += (i ? "  " : "") + (i ? room + row[i] : row[i] + room);
    }
    while (line.ends_with(' ')) line.pop_back();
    out += line + "\n";
  }
  return out;
}

std::string plain(double value) { return std::isfinite(value) ? rounded(value) : "-"; }

/// Three digits; no powers of ten.
std::string count(double times) {
  if (times > 1e6) return "over a million";
  if (times < 1000) return figure(times, 3);
  const double unit = std::pow(10, std::floor(std::log10(times)) - 2);
  return std::to_string(std::llround(std::round(times / unit) * unit));
}

}  // namespace

Gain gain(Better better, double first, double other) {
  if (better == Better::Neither || !std::isfinite(first) || !std::isfinite(other)) return {NAN, NAN};
  return {first == 0 ? NAN : 100 * (first - other) / std::abs(first),
          first > 0 && other > 0 ? first / other : NAN};
}

std::string in_words(Better better, double first, double other) {
  if (first == other) return "same";
  if (better == Better::Neither && !(first > 0 && other > 0)) return "–";
  const auto [percent, times] = gain(Better::Less, first, other);
  if (std::isnan(percent)) return "–";
  const double size = std::abs(percent);
  std::string out = size > 99.99 && size < 100 ? "> 99.99 %" : figure(size, size >= 99.9 ? 4 : 3) + " %";
  if (times >= 1.5) out += ", " + count(times) + " times";
  if (times <= 1 / 1.5) out = count(1 / times) + " times";
  if (better == Better::Neither) return out + (percent > 0 ? " less" : " more");
  return out + (percent > 0 ? " better" : " worse");
}

Comparison compare(const std::vector<Folder>& runs) {
  Comparison out;
  out.names = names_of(runs);
  for (size_t i = 0; i < runs.size(); ++i) {
    const std::optional<LoggedRun>& logged = runs[i].logged;
    if (!logged || logged->run.steps.empty())
      throw std::runtime_error(out.names[i] + ": has nothing to compare (" +
                               (logged ? "no whole step in its log" : runs[i].no_log) + ")");
  }
  for (size_t i = 0; i < runs.size(); ++i)
    if (!runs[i].metrics["complete"].get<bool>())
      out.notes.push_back(out.names[i] + " ended early, at step " + json_text(runs[i].metrics["last_step"]) +
                          " of " + json_text(runs[i].metrics["wanted_last_step"]) +
                          ": its figures cover the time until then.");
  for (size_t i = 1; i < runs.size(); ++i)
    if (runs[i].metrics["band"] != runs[0].metrics["band"])
      out.notes.push_back(out.names[i] + " was judged by another band (" +
                          json_text(runs[i].metrics["band"]) + ", not " + json_text(runs[0].metrics["band"]) +
                          "): settling times differ for that alone.");
  find_joints(runs, out);
  find_keys(runs, out);
  find_rows(runs, out);
  return out;
}

std::string compare_text(const Comparison& all) {
  std::vector<std::vector<std::string>> rows{{"experiment"}};
  rows[0].insert(rows[0].end(), all.names.begin(), all.names.end());
  for (const Comparison::Key& key : all.keys) {
    std::vector<std::string> row{key.name};
    for (const std::string& value : key.values) row.push_back(value.empty() ? "-" : value);
    rows.push_back(row);
  }
  std::string out = all.keys.empty() ? "The experiments are the same.\n" : columns(rows);
  rows = {{"metric", "unit", all.names[0]}};
  for (size_t i = 1; i < all.names.size(); ++i) rows[0].insert(rows[0].end(), {all.names[i], ""});
  for (const Comparison::Row& one : all.rows) {
    std::vector<std::string> row{one.name, one.unit, plain(one.values[0])};
    for (size_t i = 1; i < one.values.size(); ++i)
      row.insert(row.end(), {plain(one.values[i]), in_words(one.better, one.values[0], one.values[i])});
    rows.push_back(row);
  }
  out += "\n" + columns(rows);
  for (const std::string& note : all.notes) out += "\n" + note + "\n";
  return out;
}

json compare_json(const Comparison& all) {
  const auto or_null = [](double value) { return std::isfinite(value) ? json(value) : json(nullptr); };
  json out{{"runs", all.names},
           {"notes", all.notes},
           {"joints", all.joints},
           {"keys", json::array()},
           {"metrics", json::array()}};
  for (const Comparison::Key& key : all.keys)
    out["keys"].push_back({{"key", key.name}, {"values", key.values}});
  for (const Comparison::Row& row : all.rows) {
    json one{{"metric", row.name},
             {"unit", row.unit},
             {"values", json::array()},
             {"improvement_percent", json::array()},
             {"times_better", json::array()}};
    for (double value : row.values) {
      const auto [percent, times] = gain(row.better, row.values[0], value);
      one["values"].push_back(or_null(value));
      one["improvement_percent"].push_back(or_null(percent));
      one["times_better"].push_back(or_null(times));
    }
    out["metrics"].push_back(one);
  }
  return out;
}

}  // namespace lab::report
