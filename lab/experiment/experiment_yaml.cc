#include "lab/experiment/experiment_yaml.h"

#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "core/util/number.h"
#include "core/util/printable.h"
#include "lab/experiment/keys.h"
#include "lab/experiment/yaml_load.h"
#include "lab/experiment/yaml_values.h"

namespace lab {
namespace {

using yaml::Fault;
using yaml::show;

/// The leaves of the document by key, each with where it stands.
class Document {
 public:
  Document(const std::string& text, const std::string& file, std::span<const Override> overrides)
      : file_(file) {
    for_each_key(static_cast<const Experiment&>(nothing_),
                 [&](const Key& key, const auto&) { keys_.push_back(key.name); });
    try {
      root_ = yaml::load(text, file_);
    } catch (const YAML::ParserException& e) {
      throw ExperimentError(not_yaml(text, e));
    }
    if (root_.IsNull()) root_ = YAML::Node(YAML::NodeType::Map);
    if (!root_.IsMap())
      throw ExperimentError(file_ + ":1: must be a map of sections (robot:, simulator:, ..)");
    if (root_["experiment"].IsDefined() && (root_["grid"].IsDefined() || root_["draws"].IsDefined()))
      throw ExperimentError(file_ + ": is a sweep, not an experiment: run it with scripts/lab sweep " +
                            file_);
    for (const Override& one : overrides) override_with(one);
    walk(root_, "", 1);
  }

  std::map<std::string, YAML::Node> leaves;
  std::map<std::string, std::string> where;
  std::vector<std::string> faults;

 private:
  std::string at_line(const YAML::Mark& mark) const { return file_ + ":" + std::to_string(mark.line + 1); }

  /// Where the text stops being YAML; tabs and indentation are what usually is wrong.
  std::string not_yaml(const std::string& text, const YAML::ParserException& e) const {
    std::stringstream lines(text);
    std::string line;
    for (int n = 0; n <= e.mark.line && std::getline(lines, line); ++n)
      if (line.substr(0, line.find_first_not_of(" \t")).find('\t') != std::string::npos)
        return file_ + ":" + std::to_string(n + 1) + ": not YAML: begins with a tab; indent with spaces";
    const bool map = e.msg.find("map value") != std::string::npos;
    return at_line(e.mark) + ": not YAML: " + e.msg +
           (map ? "; is it indented like the lines around it?" : "");
  }

  void override_with(const Override& one) {
    const std::string& text = one.text;
    const size_t equals = text.find('=');
    const std::string path = text.substr(0, equals);
    const std::string head = one.place == "--set" ? "--set " : one.place + ": ";
    if (equals == std::string::npos || path.empty())
      throw ExperimentError(head + text + ": must look like controller.kp=80");
    YAML::Node value;
    try {
      value = yaml::load(text.substr(equals + 1), head + path);
    } catch (const YAML::ParserException& e) {
      throw ExperimentError(head + path + ": not a YAML value: " + e.msg);
    }
    YAML::Node at = root_;
    std::stringstream parts(path);
    std::string part, next;
    std::getline(parts, part, '.');
    for (; std::getline(parts, next, '.'); part = next) {
      YAML::Node below = at[part];
      if (!below.IsDefined() || below.IsNull()) {
        below = YAML::Node(YAML::NodeType::Map);
        at[part] = below;
      }
      if (!below.IsMap()) throw ExperimentError(head + path + ": '" + part + "' is not a map in " + file_);
      at.reset(below);
    }
    at[part] = value;
    set_[path] = one.place;
  }

  /// Where the value of `path` comes from: the text, or an override of it or of a part of it.
  std::string origin(const std::string& path, const std::string& in_text) const {
    const auto after = set_.lower_bound(path);
    if (after != set_.end() && (after->first == path || after->first.starts_with(path + ".")))
      return after->second;
    for (size_t dot = path.find_last_of(".["); dot != std::string::npos && dot > 0;
         dot = path.find_last_of(".[", dot - 1))
      if (const auto whole = set_.find(path.substr(0, dot)); whole != set_.end()) return whole->second;
    return in_text;
  }

  void walk(const YAML::Node& map, const std::string& prefix, int depth) {
    std::set<std::string> seen;
    for (const auto& item : map) {
      const std::string path = prefix + item.first.as<std::string>("?");
      const std::string place = origin(path, at_line(item.first.Mark()));
      if (!seen.insert(path).second) {
        faults.push_back(place + ": key '" + path + "' is given twice; keep one");
      } else if (std::find(keys_.begin(), keys_.end(), path) != keys_.end()) {
        leaves[path].reset(item.second);
        where[path] = place;
        note_parts(item.second, path);
      } else if (is_section(path)) {
        if (item.second.IsMap() && depth < 8)
          walk(item.second, path + ".", depth + 1);
        else if (!item.second.IsNull())
          faults.push_back(place + ": '" + path + "' is a section; put keys under it, not " +
                           show(item.second));
      } else {
        unknown(item.second, path, place);
      }
    }
  }

  // the lines of values inside a map or list, for messages about one of them
  void note_parts(const YAML::Node& node, const std::string& path) {
    for (size_t i = 0; node.IsSequence() && i < node.size(); ++i) {
      const std::string below = path + "[" + std::to_string(i) + "]";
      where[below] = origin(below, at_line(node[i].Mark()));
      note_parts(node[i], below);
    }
    if (!node.IsMap()) return;
    for (const auto& item : node) {
      const std::string below = path + "." + item.first.as<std::string>("?");
      where[below] = origin(below, at_line(item.first.Mark()));
      note_parts(item.second, below);
    }
  }

  void unknown(const YAML::Node& node, const std::string& path, const std::string& place) {
    if (node.IsMap() &&
        node.size() > 0) {  // a misspelt section; if it is like none, its keys give a better guess
      if (const std::string near = did_you_mean(path, sections()); !near.empty()) {
        faults.push_back(place + ": unknown section '" + path + "'" + near);
        return;
      }
      for (const auto& item : node) unknown(item.second, path + "." + item.first.as<std::string>("?"), place);
      return;
    }
    faults.push_back(place + ": unknown key '" + path + "'" + did_you_mean(path, keys_));
  }

  std::vector<std::string> sections() const {
    std::set<std::string> all;
    for (const std::string& key : keys_)
      for (size_t dot = key.find('.'); dot != std::string::npos; dot = key.find('.', dot + 1))
        all.insert(key.substr(0, dot));
    return {all.begin(), all.end()};
  }

  bool is_section(const std::string& path) const {
    for (const std::string& key : keys_)
      if (key.starts_with(path + ".")) return true;
    return false;
  }

  std::string file_;
  YAML::Node root_;
  std::map<std::string, std::string> set_;  // key: where the override was written
  std::vector<std::string> keys_;
  Experiment nothing_;
};

}  // namespace

Experiment parse_experiment(const std::string& text, const std::string& file,
                            const std::vector<std::string>& overrides) {
  std::vector<Override> all;
  for (const std::string& one : overrides) all.push_back({one});
  return parse_experiment(text, file, std::span<const Override>(all));
}

Experiment parse_experiment(const std::string& text, const std::string& file,
                            std::span<const Override> overrides) {
  Document document(text, file, overrides);
  Experiment experiment;
  experiment.file = file;
  experiment.name = std::filesystem::path(file).stem();
  std::vector<std::string>& faults = document.faults;
  for_each_key(experiment, [&](const Key& key, auto& member) {
    const auto leaf = document.leaves.find(key.name);
    if (leaf == document.leaves.end()) return;
    try {
      if (leaf->second.IsNull()) throw Fault{"is empty; give a value or remove the key"};
      yaml::read(leaf->second, key, member);
    } catch (const Fault& fault) {
      const std::string path = key.name + fault.below;
      std::string at = path;  // a missing part has no line: then that of the whole
      while (!document.where.contains(at)) at.resize(at.find_last_of(".["));
      faults.push_back(document.where[at] + ": " + path + ": " + fault.message);
    }
  });
  experiment.where = std::move(document.where);
  if (experiment.robot.model.empty() && faults.empty())
    faults.push_back(file + ": robot.model is missing; name a robot, for example builtin:manipulator");
  if (experiment.name.empty() || experiment.name[0] == '.' || experiment.name.find('/') != std::string::npos)
    faults.push_back((experiment.where.count("name") ? experiment.where["name"] : file) + ": name: '" +
                     experiment.name + "' cannot name a folder; leave out '/' and a leading '.'");
  if (experiment.last_step() < 1 && faults.empty())
    faults.push_back(file + ": simulator.duration: " + number(experiment.simulator.duration) +
                     " s is less than one step of " + number(experiment.simulator.dt) + " s");
  if (!faults.empty()) {
    std::string lines;
    for (const std::string& fault : faults) lines += (lines.empty() ? "" : "\n") + printable(fault);
    throw ExperimentError(lines);
  }
  if (!document.leaves.count("planner.duration")) experiment.planner.duration = experiment.simulator.duration;
  return experiment;
}

std::string experiment_text(const std::string& file) {
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  if (!in || std::filesystem::is_directory(file) || !(text << in.rdbuf()))
    throw ExperimentError(file + ": cannot be read (" +
                          (errno ? std::strerror(errno) : "empty, or not a file") + ")");
  return text.str();
}

Experiment load_experiment(const std::string& file, const std::vector<std::string>& overrides) {
  return parse_experiment(experiment_text(file), file, overrides);
}

}  // namespace lab
