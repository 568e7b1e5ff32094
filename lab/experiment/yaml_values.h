// One value of an experiment's text, by the type of the member that takes it: read(node, key, member) throws Fault for
// a value of another kind or out of the key's bounds.
#pragma once
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/util/number.h"
#include "lab/experiment/keys.h"

namespace lab::yaml {

/// Thrown while one value is read; the reader adds where it stands.
struct Fault {
  std::string message;
  std::string below{};  ///< the part of the value that is meant: ".max_error.max"
};

inline std::string show(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  return node.IsMap() ? "a map" : "a list";
}

/// "; a decimal comma: write 0.001" for the text 0,001; else "".
inline std::string decimal_comma(std::string text) {
  const size_t comma = text.find(',');
  if (comma == std::string::npos || comma == 0 ||
      text.find_first_not_of("+-0123456789eE.,") != std::string::npos ||
      text.find(',', comma + 1) != std::string::npos)
    return "";
  text[comma] = '.';
  return "; a decimal comma: write " + text;
}

inline double to_number(const YAML::Node& node, const char* wanted = "a number") {
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
    throw Fault{std::string("must be ") + wanted + ", not " + show(node) +
                (quoted ? " in quotes" : decimal_comma(text))};
  if (error != std::errc() || !std::isfinite(value))
    throw Fault{"must be a finite number, not '" + text + "'"};
  return value;
}

inline double bounded(double value, const Key& key) {
  const std::string unit = *key.unit ? std::string(" (") + key.unit + ")" : "";
  if (value < key.min) throw Fault{number(value) + " is too small; give at least " + number(key.min) + unit};
  if (value > key.max) throw Fault{number(value) + " is too large; give at most " + number(key.max) + unit};
  return value;
}

inline void read(const YAML::Node& node, const Key& key, double& value) {
  value = bounded(to_number(node), key);
}

inline void read(const YAML::Node& node, const Key& key, int64_t& value) {
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  int64_t whole = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (text.empty() || stop != text.data() + text.size() || error != std::errc())
    throw Fault{"must be a whole number, not " + show(node) + decimal_comma(text)};
  bounded(static_cast<double>(whole), key);
  value = whole;
}

inline void read(const YAML::Node& node, const Key&, bool& value) {
  if (!node.IsScalar() || (node.Scalar() != "true" && node.Scalar() != "false"))
    throw Fault{"must be true or false, not " + show(node)};
  value = node.Scalar() == "true";
}

inline void read(const YAML::Node& node, const Key& key, std::string& value) {
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

inline void read(const YAML::Node& node, const Key& key, std::vector<double>& value) {
  read_list(node, key, "numbers", value);
}

inline void read(const YAML::Node& node, const Key& key, std::vector<std::string>& value) {
  read_list(node, key, "names", value);
}

/// A map from names to numbers or lists of numbers; `what`: "joint: number".
template <class T>
void read_named(const YAML::Node& node, const Key& key, const std::string& what,
                std::map<std::string, T>& value) {
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

inline void read(const YAML::Node& node, const Key& key, std::map<std::string, double>& value) {
  read_named(node, key, "joint: number", value);
}

inline void read(const YAML::Node& node, const Key& key,
                 std::map<std::string, std::array<double, 3>>& value) {
  read_named(node, key, "body: [x, y, z]", value);
}

inline void read(const YAML::Node& node, const Key& key, JointValues& value) {
  if (node.IsMap()) {
    read(node, key, value.value.emplace<JointValues::Named>());
  } else if (node.IsSequence()) {
    if (node.size() == 0) throw Fault{"is an empty list; give one number per joint, or one for all"};
    read(node, key, value.value.emplace<std::vector<double>>());
  } else {
    value.value = bounded(to_number(node, "a number, a list of numbers or a map joint: number"), key);
  }
}

inline void read(const YAML::Node& node, const Key& key, std::vector<JointValues>& value) {
  if (!node.IsSequence() || node.size() == 0)
    throw Fault{"must be a list of configurations, not " + (node.IsSequence() ? "empty" : show(node))};
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
    if (const auto name = part.first.as<std::string>("");
        std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = did_you_mean(name, known);
      throw Fault{"is not known" + (near.empty() ? "; there are " + list_of(known) : near), "." + name};
    }
  for_each_part(value, [&](const Key& part, auto& member) {
    const YAML::Node given = node[part.name];
    try {
      if (given)
        read(given, part, member);
      else if (part.standard == std::string(kMustBeGiven))
        throw Fault{"is missing"};
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

inline void read(const YAML::Node& node, const Key&, std::map<std::string, std::string>& value) {
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
inline void read_bounds(const YAML::Node& node, const std::string& metric,
                        std::map<std::string, Bound>& value) {
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

inline void read(const YAML::Node& node, const Key&, std::map<std::string, Bound>& value) {
  if (!node.IsMap()) throw Fault{"must be a map metric: {max: x}, not " + show(node)};
  for (const auto& item : node) read_bounds(item.second, item.first.as<std::string>(""), value);
}

}  // namespace lab::yaml
