#include "lab/sweep/sweep.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "core/util/number.h"
#include "lab/evaluation/evaluate.h"
#include "lab/experiment/yaml_load.h"

namespace lab::sweep {
namespace {

constexpr int64_t kMaxRuns = 1'000'000;

/// A value as YAML on one line.
std::string one_line(const YAML::Node& node) {
  std::string text;
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) text += (text.empty() ? "" : ", ") + one_line(item);
    return "[" + text + "]";
  }
  if (node.IsMap()) {
    for (const auto& item : node)
      text += (text.empty() ? "" : ", ") + one_line(item.first) + ": " + one_line(item.second);
    return "{" + text + "}";
  }
  if (!node.IsScalar() || node.Tag() != "!") return node.IsScalar() ? node.Scalar() : "~";
  for (char c : node.Scalar()) text += c == '\'' ? "''" : std::string(1, c);  // in quotes it stays a text
  return "'" + text + "'";
}

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file) {}

  Sweep read() {
    sweep_.file = file_;
    sweep_.name = std::filesystem::path(file_).stem();
    YAML::Node root;
    try {
      root = yaml::load(experiment_text(file_), file_);
    } catch (const YAML::ParserException& e) {
      throw ExperimentError(place(e.mark) + ": not YAML: " + e.msg);
    }
    if (!root.IsMap())
      throw ExperimentError(file_ + ":1: must be a map with experiment: and grid: or draws:");
    if (root["robot"].IsDefined() && !root["experiment"].IsDefined())
      throw ExperimentError(file_ + ": is an experiment, not a sweep: run it with scripts/lab run " + file_);
    for (const auto& [key, value] : entries(root, "the sweep")) {
      if (key == "experiment")
        read_experiment(value);
      else if (key == "set")
        read_set(value);
      else if (key == "grid")
        read_grid(value);
      else if (key == "draws")
        read_draws(value);
      else if (key == "metrics")
        read_metrics(value);
      else
        unknown(key, {"experiment", "set", "grid", "draws", "metrics"});
    }
    if (sweep_.text.empty() && faults_.empty())
      fault(file_, "experiment is missing; name the file of one, beside this one");
    if (sweep_.grid.empty() && sweep_.draws.empty() && faults_.empty())
      fault(file_, "nothing varies; give keys under grid: or draws:");
    if (!faults_.empty()) throw ExperimentError(faults_);
    count_runs();
    if (sweep_.metrics.empty())
      for (const Metric& metric : metrics()) sweep_.metrics.push_back(metric.name);
    return std::move(sweep_);
  }

 private:
  std::string place(const YAML::Mark& mark) const { return file_ + ":" + std::to_string(mark.line + 1); }
  void fault(const std::string& where, const std::string& what) {
    faults_ += (faults_.empty() ? "" : "\n") + where + ": " + what;
  }
  std::string at(const std::string& key) const { return places_.at(key); }

  /// The entries of a map in the file's order; notes where each stands.
  std::vector<std::pair<std::string, YAML::Node>> entries(const YAML::Node& map, const std::string& what) {
    std::vector<std::pair<std::string, YAML::Node>> out;
    if (!map.IsMap()) {
      fault(map.Mark().is_null() ? file_ : place(map.Mark()), what + " must be a map");
      return out;
    }
    for (const auto& item : map) {
      const std::string key = item.first.as<std::string>("?");
      places_[key] = place(item.first.Mark());
      for (const auto& other : out)
        if (other.first == key) fault(at(key), "'" + key + "' is given twice; keep one");
      out.emplace_back(key, item.second);
    }
    return out;
  }

  void unknown(const std::string& key, const std::vector<std::string>& known) {
    const std::string near = did_you_mean(key, known);
    fault(at(key), "unknown key '" + key + "'" + (near.empty() ? "; there are " + list_of(known) : near));
  }

  double to_number(const YAML::Node& node, const std::string& key) {
    double value = 0;
    const std::string text = node.IsScalar() ? node.Scalar() : "";
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || stop != text.data() + text.size() || error != std::errc() || !std::isfinite(value)) {
      fault(at(key),
            key + ": must be a finite number, not " + (node.IsScalar() ? "'" + text + "'" : "a list or map"));
      return 1;
    }
    return value;
  }

  int64_t to_count(const YAML::Node& node, const std::string& key, int64_t least, int64_t most) {
    int64_t value = least;
    const std::string text = node.IsScalar() ? node.Scalar() : "";
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || stop != text.data() + text.size() || error != std::errc() || value < least ||
        value > most) {
      fault(at(key),
            fmt::format("{}: must be a whole number from {} to {}, not '{}'", key, least, most, text));
      return least;
    }
    return value;
  }

  void read_experiment(const YAML::Node& node) {
    const std::string name = node.IsScalar() ? node.Scalar() : "";
    if (name.empty()) return fault(at("experiment"), "experiment: must be the name of a file");
    sweep_.experiment = (std::filesystem::path(file_).parent_path() / name).lexically_normal();
    try {
      sweep_.text = experiment_text(sweep_.experiment);
    } catch (const ExperimentError& error) {
      fault(at("experiment"), std::string("experiment: ") + error.what());
    }
  }

  void read_set(const YAML::Node& node) {
    for (const auto& [key, value] : entries(node, "set"))
      sweep_.set.push_back({key + "=" + one_line(value), at(key)});
  }

  void read_grid(const YAML::Node& node) {
    for (const auto& [key, value] : entries(node, "grid")) {
      Axis axis{key, at(key), {}};
      if (value.IsSequence())
        for (const YAML::Node& item : value) axis.values.push_back(one_line(item));
      else if (value.IsMap())
        read_range(value, axis);
      else
        fault(axis.place,
              key + ": must be a list of values or {from: a, to: b, count: n, scale: linear|log}");
      if (value.IsSequence() && axis.values.empty())
        fault(axis.place, key + ": is an empty list; give at least one value");
      for (size_t i = 0; i < axis.values.size(); ++i)
        if (std::find(axis.values.begin(), axis.values.begin() + static_cast<ptrdiff_t>(i), axis.values[i]) !=
            axis.values.begin() + static_cast<ptrdiff_t>(i))
          fault(axis.place, key + ": has the value " + axis.values[i] + " twice");
      sweep_.grid.push_back(std::move(axis));
    }
  }

  void read_range(const YAML::Node& node, Axis& axis) {
    std::map<std::string, YAML::Node> given;
    const std::string where = axis.place;
    for (const auto& [key, value] : entries(node, axis.key)) {
      if (key == "from" || key == "to" || key == "count" || key == "scale")
        given[key] = value;
      else
        unknown(key, {"from", "to", "count", "scale"});
    }
    for (const char* needed : {"from", "to", "count"})
      if (!given.count(needed))
        return fault(where, axis.key + ": a range needs from, to and count; " + needed + " is missing");
    const double from = to_number(given["from"], "from"), to = to_number(given["to"], "to");
    const int64_t count = to_count(given["count"], "count", 2, kMaxRuns);
    const std::string scale = given.count("scale") ? one_line(given["scale"]) : "linear";
    if (scale != "linear" && scale != "log")
      return fault(at("scale"), "scale: '" + scale + "' is not known; use linear or log");
    if (scale == "log" && !(from > 0 && to > 0))
      return fault(where, axis.key + ": a log scale needs from and to above 0");
    for (int64_t i = 0; i < count; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(count - 1);
      axis.values.push_back(number(i + 1 == count   ? to
                                   : scale == "log" ? from * std::pow(to / from, share)
                                                    : from + (to - from) * share));
    }
  }

  void read_draws(const YAML::Node& node) {
    bool counted = false, keyed = false;
    for (const auto& [key, value] : entries(node, "draws")) {
      if (key == "count")
        sweep_.draw_count = to_count(value, key, 1, kMaxRuns);
      else if (key == "seed")
        sweep_.seed = to_count(value, key, 0, INT64_MAX);
      else if (key == "keys")
        for (const auto& [drawn, how] : entries(value, "keys")) read_distribution(drawn, how);
      else
        unknown(key, {"count", "seed", "keys"});
      counted = counted || key == "count";
      keyed = keyed || (key == "keys" && value.size() > 0);
    }
    if (!keyed || !counted) fault(at("draws"), "draws: needs count: and keys:");
  }

  void read_distribution(const std::string& key, const YAML::Node& node) {
    using Kind = Distribution::Kind;
    static const std::vector<std::pair<std::string, Kind>> kinds{{"uniform", Kind::Uniform},
                                                                 {"log_uniform", Kind::LogUniform},
                                                                 {"normal", Kind::Normal},
                                                                 {"integer", Kind::Integer},
                                                                 {"choice", Kind::Choice}};
    Draw draw{key, at(key), {}};
    if (!node.IsMap() || node.size() != 1)
      return fault(draw.place, key +
                                   ": must be like {uniform: [0.5, 1.5]}; there are uniform, log_uniform, "
                                   "normal, integer, choice");
    const auto [word, given] = entries(node, key).front();
    const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& one) { return one.first == word; });
    if (kind == kinds.end()) return unknown(word, {"uniform", "log_uniform", "normal", "integer", "choice"});
    Distribution& d = draw.distribution;
    d.kind = kind->second;
    const bool choice = d.kind == Kind::Choice, normal = d.kind == Kind::Normal;
    if (!given.IsSequence() || (choice ? given.size() == 0 : given.size() != 2))
      return fault(at(word), key + ": " + word +
                                 (choice   ? " needs a list of values"
                                  : normal ? " needs [mean, deviation]"
                                           : " needs [least, most]"));
    if (choice) {
      for (const YAML::Node& item : given) d.choices.push_back(one_line(item));
    } else {
      d.a = to_number(given[0], word);
      d.b = to_number(given[1], word);
      if (normal && d.b < 0) fault(at(word), key + ": normal: the deviation is below 0");
      if (!normal && d.b < d.a) fault(at(word), key + ": " + word + ": the second number is below the first");
      if (d.kind == Kind::LogUniform && !(d.a > 0))
        fault(at(word), key + ": log_uniform needs numbers above 0");
      if (d.kind == Kind::Integer && (d.a != std::floor(d.a) || d.b != std::floor(d.b)))
        fault(at(word), key + ": integer needs whole numbers");
    }
    sweep_.draws.push_back(std::move(draw));
  }

  void read_metrics(const YAML::Node& node) {
    sweep_.metrics_place = at("metrics");
    if (!node.IsSequence() || node.size() == 0)
      return fault(at("metrics"), "metrics: must be a list of names");
    for (const YAML::Node& item : node) {
      const std::string name = item.as<std::string>("?");
      if (std::find(sweep_.metrics.begin(), sweep_.metrics.end(), name) == sweep_.metrics.end())
        sweep_.metrics.push_back(name);
    }
  }

  void count_runs() {
    for (const Draw& draw : sweep_.draws)
      for (const Axis& axis : sweep_.grid)
        if (axis.key == draw.key)
          fault(draw.place, "'" + draw.key + "' is in the grid too; a key can vary in one way only");
    double runs = static_cast<double>(sweep_.draw_count);
    for (const Axis& axis : sweep_.grid) runs *= static_cast<double>(axis.values.size());
    if (runs > static_cast<double>(kMaxRuns))
      fault(file_, fmt::format("{:.3g} runs; at most {} at a time", runs, kMaxRuns));
    if (!faults_.empty()) throw ExperimentError(faults_);
  }

  const std::string file_;
  Sweep sweep_;
  std::string faults_;
  std::map<std::string, std::string> places_;  // of the key that was read last under this name
};

}  // namespace

Sweep read_sweep(const std::string& file) { return Reader(file).read(); }

int64_t Sweep::runs() const {
  int64_t runs = draw_count;
  for (const Axis& axis : grid) runs *= static_cast<int64_t>(axis.values.size());
  return runs;
}

std::vector<size_t> Sweep::point_of(int64_t run) const {
  std::vector<size_t> point(grid.size());
  auto left = static_cast<size_t>(run / draw_count);
  for (size_t i = grid.size(); i-- > 0; left /= grid[i].values.size())
    point[i] = left % grid[i].values.size();
  return point;
}

std::vector<std::string> Sweep::keys() const {
  std::vector<std::string> keys;
  for (const Axis& axis : grid) keys.push_back(axis.key);
  for (const Draw& draw : draws) keys.push_back(draw.key);
  return keys;
}

std::vector<std::string> Sweep::values(int64_t run) const {
  std::vector<std::string> values;
  const std::vector<size_t> point = point_of(run);
  for (size_t i = 0; i < grid.size(); ++i) values.push_back(grid[i].values[point[i]]);
  for (const Draw& draw : draws) values.push_back(value_of(draw.distribution, seed, draw_of(run), draw.key));
  return values;
}

std::vector<Override> Sweep::overrides(int64_t run) const {
  std::vector<Override> all = set;
  const std::vector<std::string> given = values(run);
  for (size_t i = 0; i < grid.size(); ++i) all.push_back({grid[i].key + "=" + given[i], grid[i].place});
  for (size_t i = 0; i < draws.size(); ++i)
    all.push_back({draws[i].key + "=" + given[grid.size() + i], draws[i].place});
  return all;
}

}  // namespace lab::sweep
