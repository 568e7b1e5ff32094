#include "procs/experiment/experiment_yaml.h"

#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "procs/experiment/keys.h"

namespace lab {
namespace {

/// Thrown while one value is read; the reader adds where it stands.
struct Fault {
  std::string message;
  std::string below = "";  ///< the part of the value that is meant: ".max_error.max"
};

std::string show(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  return node.IsMap() ? "a map" : "a list";
}

// ---- one value

double to_number(const YAML::Node& node, const char* wanted = "a number") {
  std::string text = node.IsScalar() ? node.Scalar() : "";
  const bool quoted = node.IsScalar() && node.Tag() == "!";
  const char* begin = text.c_str() + (text.size() > 1 && text[0] == '+' && text[1] != '-');
  const char* end = text.c_str() + text.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (text == ".nan" || text == ".NaN" || text == ".NAN" || text.find(".inf") < 2 || text.find(".Inf") < 2 ||
      text.find(".INF") < 2)
    throw Fault{"must be finite, not '" + text + "'"};
  if (text.empty() || quoted || stop != end || error == std::errc::invalid_argument)
    throw Fault{std::string("must be ") + wanted + ", not " + show(node) + (quoted ? " in quotes" : "")};
  if (error != std::errc() || !std::isfinite(value))
    throw Fault{"must be a finite number, not '" + text + "'"};
  return value;
}

double bounded(double value, const Key& key) {
  const std::string unit = *key.unit ? std::string(" (") + key.unit + ")" : "";
  if (value < key.least)
    throw Fault{number(value) + " is too small; give at least " + number(key.least) + unit};
  if (value > key.most) throw Fault{number(value) + " is too large; give at most " + number(key.most) + unit};
  return value;
}

void read(const YAML::Node& node, const Key& key, double& value) { value = bounded(to_number(node), key); }

void read(const YAML::Node& node, const Key& key, int64_t& value) {
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  int64_t whole = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (text.empty() || stop != text.data() + text.size() || error != std::errc())
    throw Fault{"must be a whole number, not " + show(node)};
  bounded(static_cast<double>(whole), key);
  value = whole;
}

void read(const YAML::Node& node, const Key&, bool& value) {
  if (!node.IsScalar() || (node.Scalar() != "true" && node.Scalar() != "false"))
    throw Fault{"must be true or false, not " + show(node)};
  value = node.Scalar() == "true";
}

void read(const YAML::Node& node, const Key& key, std::string& value) {
  if (!node.IsScalar() || node.Scalar().empty()) throw Fault{"must be a text, not " + show(node)};
  const std::string& text = node.Scalar();
  for (unsigned char c : text)
    if (c < ' ') throw Fault{"must be one line of text without control characters"};
  const std::vector<std::string>& words = key.words;
  if (!words.empty() && std::find(words.begin(), words.end(), text) == words.end())
    throw Fault{"'" + text + "' is not known; use one of " + list_of(words)};
  value = text;
}

template <class T, size_t n>
void read(const YAML::Node& node, const Key& key, std::array<T, n>& value) {
  if (!node.IsSequence() || node.size() != n)
    throw Fault{"must be a list of " + std::to_string(n) + " numbers, not " +
                (node.IsSequence() ? "of " + std::to_string(node.size()) : show(node))};
  for (size_t i = 0; i < n; ++i) read(node[i], key, value[i]);
}

template <class T>
void read(const YAML::Node& node, const Key& key, std::optional<T>& value) {
  read(node, key, value.emplace());
}

/// A list of numbers or names; `what` they are.
template <class T>
void read_list(const YAML::Node& node, const Key& key, const std::string& what, std::vector<T>& value) {
  if (!node.IsSequence() || node.size() == 0)
    throw Fault{"must be a list of " + what + ", not " + (node.IsSequence() ? "empty" : show(node))};
  for (const YAML::Node& item : node) {
    try {
      read(item, key, value.emplace_back());
    } catch (const Fault& fault) {
      throw Fault{fault.message, "[" + std::to_string(value.size() - 1) + "]"};
    }
  }
}

void read(const YAML::Node& node, const Key& key, std::vector<double>& value) { read_list(node, key, "numbers", value); }

void read(const YAML::Node& node, const Key& key, std::vector<std::string>& value) { read_list(node, key, "names", value); }

/// A map from names to numbers or lists of numbers; `what`: "joint: number".
template <class T>
void read_named(const YAML::Node& node, const Key& key, const std::string& what, std::map<std::string, T>& value) {
  if (!node.IsMap()) throw Fault{"must be a map " + what + ", not " + show(node)};
  for (const auto& item : node) {
    const std::string name = item.first.as<std::string>("");
    try {
      if (value.contains(name)) throw Fault{"is given twice"};
      read(item.second, key, value[name]);
    } catch (const Fault& fault) {
      throw Fault{fault.message, "." + name};
    }
  }
  if (value.empty()) throw Fault{"is an empty map; name at least one " + what.substr(0, what.find(':'))};
}

void read(const YAML::Node& node, const Key& key, std::map<std::string, double>& value) {
  read_named(node, key, "joint: number", value);
}

void read(const YAML::Node& node, const Key& key, std::map<std::string, std::array<double, 3>>& value) {
  read_named(node, key, "body: [x, y, z]", value);
}

void read(const YAML::Node& node, const Key& key, JointValues& value) {
  if (node.IsMap()) {
    read(node, key, value.value.emplace<JointValues::Named>());
  } else if (node.IsSequence()) {
    std::vector<double> list;
    for (const YAML::Node& item : node) list.push_back(bounded(to_number(item), key));
    if (list.empty()) throw Fault{"is an empty list; give one number per joint, or one for all"};
    value.value = std::move(list);
  } else {
    value.value = bounded(to_number(node, "a number, a list of numbers or a map joint: number"), key);
  }
}

void read(const YAML::Node& node, const Key& key, std::vector<JointValues>& value) {
  if (!node.IsSequence() || node.size() == 0) throw Fault{"must be a list of configurations, not " + (node.IsSequence() ? "empty" : show(node))};
  for (const YAML::Node& item : node) {
    const std::string below = "[" + std::to_string(value.size()) + "]";
    try {
      if (item.IsScalar()) throw Fault{"must be a list of numbers or a map joint: number, not " + show(item)};
      read(item, key, value.emplace_back());
    } catch (const Fault& fault) {
      throw Fault{fault.message, below + fault.below};
    }
  }
}

/// A map with known parts, as an item of a list.
template <HasParts T>
void read_item(const YAML::Node& node, T& value) {
  std::vector<std::string> known;
  for_each_part(value, [&](const Key& part, auto&) { known.push_back(part.name); });
  if (!node.IsMap()) throw Fault{"must be a map with " + list_of(known) + ", not " + show(node)};
  for (const auto& part : node)
    if (const auto name = part.first.as<std::string>(""); std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = did_you_mean(name, known);
      throw Fault{"is not known" + (near.empty() ? "; there are " + list_of(known) : near), "." + name};
    }
  for_each_part(value, [&](const Key& part, auto& member) {
    const YAML::Node given = node[part.name];
    try {
      if (given) read(given, part, member);
      else if (part.standard == std::string(kMustBeGiven)) throw Fault{"is missing"};
    } catch (const Fault& fault) {
      throw Fault{fault.message, std::string(".") + part.name};
    }
  });
}

template <HasParts T>
void read(const YAML::Node& node, const Key&, std::vector<T>& value) {
  if (!node.IsSequence()) throw Fault{"must be a list of maps, not " + show(node)};
  for (const YAML::Node& item : node) {
    const std::string at = "[" + std::to_string(value.size()) + "]";
    try {
      read_item(item, value.emplace_back());
    } catch (const Fault& fault) {
      throw Fault{fault.message, at + fault.below};
    }
  }
}

void read(const YAML::Node& node, const Key&, std::map<std::string, std::string>& value) {
  if (!node.IsMap()) throw Fault{"must be a map name: command, not " + show(node)};
  for (const auto& item : node) {
    const std::string name = item.first.as<std::string>("");
    if (name.empty() || name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") != std::string::npos)
      throw Fault{"a process is named with small letters, digits, - and _", "." + name};
    try {
      read(item.second, Key{}, value[name]);
    } catch (Fault& fault) {
      throw Fault{fault.message, "." + name};
    }
  }
}

/// {max: x}, {min: x} or both; below that, names of joints: max_error: {max: 1, elbow: {max: 0.1}}.
void read_bounds(const YAML::Node& node, const std::string& metric, std::map<std::string, Bound>& value) {
  if (!node.IsMap() || node.size() == 0)
    throw Fault{"must be {max: x}, {min: x} or both, not " + show(node), "." + metric};
  for (const auto& side : node) {
    const std::string word = side.first.as<std::string>("");
    if (side.second.IsMap()) {
      read_bounds(side.second, metric + "." + word, value);
      continue;
    }
    try {
      if (word != "min" && word != "max") throw Fault{"a bound is min or max"};
      (word == "min" ? value[metric].min : value[metric].max) = to_number(side.second);
    } catch (const Fault& fault) {
      throw Fault{fault.message, "." + metric + "." + word};
    }
  }
  const Bound& bound = value[metric];
  if (bound.min && bound.max && *bound.min > *bound.max) throw Fault{"min is above max", "." + metric};
  if (!bound.min && !bound.max) value.erase(metric);
}

void read(const YAML::Node& node, const Key&, std::map<std::string, Bound>& value) {
  if (!node.IsMap()) throw Fault{"must be a map metric: {max: x}, not " + show(node)};
  for (const auto& item : node) read_bounds(item.second, item.first.as<std::string>(""), value);
}

// ---- the whole text

/// The leaves of the document by key, each with where it stands.
class Document {
 public:
  Document(const std::string& text, const std::string& file, std::span<const Override> overrides)
      : file_(file) {
    for_each_key(static_cast<const Experiment&>(nothing_),
                 [&](const Key& key, const auto&) { keys_.push_back(key.name); });
    try {
      root_ = YAML::Load(text);
    } catch (const YAML::ParserException& e) {
      throw ExperimentError(at_line(e.mark) + ": not YAML: " + e.msg);
    }
    if (root_.IsNull()) root_ = YAML::Node(YAML::NodeType::Map);
    if (!root_.IsMap())
      throw ExperimentError(file_ + ":1: must be a map of sections (robot:, simulator:, ..)");
    for (const Override& one : overrides) override_with(one);
    walk(root_, "", 1);
  }

  std::map<std::string, YAML::Node> leaves;
  std::map<std::string, std::string> where;
  std::vector<std::string> faults;

 private:
  std::string at_line(const YAML::Mark& mark) const { return file_ + ":" + std::to_string(mark.line + 1); }

  void override_with(const Override& one) {
    const std::string& text = one.text;
    const size_t equals = text.find('=');
    const std::string path = text.substr(0, equals);
    const std::string head = one.place == "--set" ? "--set " : one.place + ": ";
    if (equals == std::string::npos || path.empty())
      throw ExperimentError(head + text + ": must look like controller.kp=80");
    YAML::Node value;
    try {
      value = YAML::Load(text.substr(equals + 1));
    } catch (const YAML::ParserException& e) {
      throw ExperimentError(head + path + ": not a YAML value: " + e.msg);
    }
    YAML::Node at = root_;
    std::stringstream parts(path);
    std::string part, next;
    std::getline(parts, part, '.');
    for (; std::getline(parts, next, '.'); part = next) {
      YAML::Node below = at[part];
      if (!below.IsDefined() || below.IsNull()) below = YAML::Node(YAML::NodeType::Map), at[part] = below;
      if (!below.IsMap())
        throw ExperimentError(head + path + ": '" + part + "' is not a map in " + file_);
      at.reset(below);
    }
    at[part] = value;
    set_[path] = one.place;
  }

  /// Where the value of `path` comes from: the text, or an override of it or of a part of it.
  std::string origin(const std::string& path, const std::string& in_text) const {
    const auto after = set_.lower_bound(path);
    if (after != set_.end() && (after->first == path || after->first.starts_with(path + "."))) return after->second;
    for (size_t dot = path.find_last_of(".["); dot != std::string::npos && dot > 0; dot = path.find_last_of(".[", dot - 1))
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
    if (node.IsMap() && node.size() > 0) {  // a misspelt section: show what stands in it, for a better guess
      for (const auto& item : node) unknown(item.second, path + "." + item.first.as<std::string>("?"), place);
      return;
    }
    faults.push_back(place + ": unknown key '" + path + "'" + did_you_mean(path, keys_));
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

Experiment parse_experiment(const std::string& text, const std::string& file, std::span<const Override> overrides) {
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
      read(leaf->second, key, member);
    } catch (const Fault& fault) {
      const std::string path = key.name + fault.below;
      std::string at = path;  // what is missing stands nowhere: then where it should be
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
    for (const std::string& fault : faults) lines += (lines.empty() ? "" : "\n") + fault;
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
