// The writers of lab/experiment/experiment_yaml.h: block style for sections, flow style for what is inside
// a key.
#include <cctype>
#include <cstdio>
#include <set>

#include "core/util/number.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/keys.h"

namespace lab {
namespace {

class Writer {
 public:
  explicit Writer(bool exact) : exact_(exact) {}

  template <class T>
  void write(const std::string& path, const T& member) {
    if constexpr (std::is_same_v<T, std::string>)
      if (member.empty()) return;  // not needed
    const std::string value = text(member);
    if (value.empty()) return;  // unset: the default holds
    // open the sections that this key does not share with the one before
    size_t shared = 0, at = 0, depth = 0;
    while ((at = path.find('.', shared)) != std::string::npos &&
           section_.compare(0, at + 1, path, 0, at + 1) == 0) {
      shared = at + 1;
      ++depth;
    }
    while ((at = path.find('.', shared)) != std::string::npos) {
      out_.append(2 * depth++, ' ') += path.substr(shared, at - shared) + ":\n";
      shared = at + 1;
    }
    section_ = path.substr(0, shared);
    out_.append(2 * depth, ' ') += path.substr(shared) + ": " + value + "\n";
  }
  const std::string& result() const { return out_; }
  template <class T>
  std::string value(const T& member) const {
    return text(member);
  }

 private:
  std::string text(double value) const { return exact_ ? rounded(value, 17) : number(value); }
  std::string text(int64_t value) const { return std::to_string(value); }
  std::string text(bool value) const { return value ? "true" : "false"; }

  /// A word as it is if every YAML reader takes it for a text, else in quotes.
  std::string text(const std::string& value) const {
    if (value.empty()) return "";  // not given
    static const std::set<std::string> reserved{"true", "false", "null", "yes", "no",
                                                "on",   "off",   "y",    "n",   "~"};
    const bool word =
        !value.empty() && (std::isalpha(static_cast<unsigned char>(value[0])) || value[0] == '/') &&
        value.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./") ==
            std::string::npos;
    std::string lower = value;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (word && !reserved.count(lower)) return value;
    std::string quoted = "\"";
    for (char c : value) {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
    return quoted + '"';
  }

  template <class List>
  std::string list(const List& values) const {
    std::string all;
    for (const auto& value : values) all += (all.empty() ? "" : ", ") + text(value);
    return "[" + all + "]";
  }
  template <class Map>
  std::string map(const Map& values) const {
    std::string all;
    for (const auto& [name, value] : values)
      all += (all.empty() ? "" : ", ") + text(name) + ": " + text(value);
    return all.empty() ? "" : "{" + all + "}";
  }
  template <class T, size_t n>
  std::string text(const std::array<T, n>& values) const {
    return list(values);
  }
  std::string text(const std::map<std::string, std::string>& values) const { return map(values); }
  std::string text(const std::map<std::string, double>& values) const { return map(values); }
  std::string text(const std::map<std::string, std::array<double, 3>>& values) const { return map(values); }
  std::string text(const std::vector<std::string>& values) const {
    return values.empty() ? "" : list(values);
  }
  std::string text(const std::map<std::string, Bound>& values) const { return map(values); }
  std::string text(const Bound& bound) const {
    std::map<std::string, double> sides;
    if (bound.min) sides["min"] = *bound.min;
    if (bound.max) sides["max"] = *bound.max;
    return text(sides);
  }
  template <HasParts T>
  std::string text(const T& item) const {
    std::string all;
    for_each_part(item, [&](const Key& part, const auto& member) {
      all += (all.empty() ? "" : ", ") + std::string(part.name) + ": " + text(member);
    });
    return "{" + all + "}";
  }
  template <HasParts T>
  std::string text(const std::vector<T>& items) const {
    return items.empty() ? "" : list(items);
  }
  template <class T>
  std::string text(const std::optional<T>& value) const {
    return value ? text(*value) : "";
  }
  std::string text(const std::vector<double>& values) const { return values.empty() ? "" : list(values); }
  std::string text(const std::vector<JointValues>& values) const {
    return values.empty() ? "" : list(values);
  }
  std::string text(const JointValues& values) const {
    if (const auto* one = std::get_if<double>(&values.value)) return text(*one);
    if (const auto* some = std::get_if<std::vector<double>>(&values.value)) return list(*some);
    if (const auto* named = std::get_if<JointValues::Named>(&values.value)) return text(*named);
    return "";
  }

  bool exact_;
  std::string out_, section_;
};

}  // namespace

std::string resolve(const Experiment& experiment) {
  Writer writer(false);
  for_each_key(experiment, [&](const Key& key, const auto& member) { writer.write(key.name, member); });
  return writer.result();
}

std::vector<std::pair<std::string, std::string>> key_values(const Experiment& experiment) {
  const Writer writer(false);
  std::vector<std::pair<std::string, std::string>> all;
  for_each_key(experiment,
               [&](const Key& key, const auto& member) { all.emplace_back(key.name, writer.value(member)); });
  return all;
}

std::string canonical(const Experiment& experiment) {
  Experiment plain = experiment;
  if (!plain.robot.model.starts_with("builtin:")) plain.robot.model = "urdf";
  Writer writer(true);
  for_each_key(plain, [&](const Key& key, const auto& member) {
    if (key.canonical) writer.write(key.name, member);
  });
  return writer.result();
}

std::string key_table() {
  std::string table = "| key | unit | default | what |\n|---|---|---|---|\n";
  const Experiment standard;
  for_each_key(standard, [&](const Key& key, const auto&) {
    table +=
        std::string("| `") + key.name + "` | " + key.unit + " | " + key.standard + " | " + key.doc + " |\n";
  });
  return table;
}

}  // namespace lab
