#include "lab/check/unused.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <span>
#include <vector>

#include "core/util/words.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/keys.h"
#include "procs/controller/controller.h"
#include "procs/planner/motions.h"

namespace lab {
namespace {

/// Whether a key was given by --set or by a sweep, and not by the experiment's file.
bool is_override(const Experiment& e, const std::string& key) {
  const auto place = e.where.find(key);
  return place != e.where.end() && !place->second.starts_with(e.file + ":");
}

bool is_as_run(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  return std::getline(in, line) && line.starts_with(kAsRun);
}

/// Whether a person gave this key for the kind that the experiment has now.
bool was_given(const Experiment& e, const std::string& section, const std::string& key) {
  if (!e.where.contains(key)) return false;
  return is_override(e, key) || (!is_as_run(e.file) && !is_override(e, section + ".kind"));
}

/// The values that differ from the default, by key.
std::map<std::string, std::string> changed_values(const Experiment& e) {
  Experiment standard;
  standard.planner.duration = e.simulator.duration;
  std::map<std::string, std::string> changed;
  for (const auto& [key, value] : key_values(e)) changed[key] = value;
  for (const auto& [key, value] : key_values(standard))
    if (changed[key] == value) changed.erase(key);
  for_each_key(e, [&](const Key& key, const auto&) {
    if (const auto it = changed.find(key.name); it != changed.end() && it->second == key.standard)
      changed.erase(it);
  });
  return changed;
}

template <class Kind>
void check_section(const Experiment& e, const std::string& section, const std::string& chosen,
                   std::span<const Kind> kinds) {
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& k) { return k.name == chosen; });
  if (kind == kinds.end() || !kind->keys) return;
  for (const auto& [key, value] : changed_values(e)) {
    if (!key.starts_with(section + ".") || !was_given(e, section, key)) continue;
    const std::string name = key.substr(section.size() + 1);
    std::vector<std::string> users;
    for (const Kind& other : kinds)
      if (other.keys && lists(other.keys, name)) users.push_back(other.name);
    if (!users.empty() && !lists(kind->keys, name))
      fail(e, key,
           "is not used by " + chosen + ", only by " + list_of(users) + "; remove it or choose another " +
               section + ".kind");
  }
}

}  // namespace

void check_unused(const Experiment& e, const std::set<std::string>& varies) {
  if (!e.processes.contains("planner") && !varies.contains("planner"))
    check_section(e, "planner", e.planner.kind, planner::kinds());
  if (!e.processes.contains("controller") && !varies.contains("controller"))
    check_section(e, "controller", e.controller.kind, controller::kinds());
}

}  // namespace lab
