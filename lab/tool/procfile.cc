#include "lab/tool/procfile.h"

#include <algorithm>
#include <filesystem>

#include "core/util/number.h"
#include "core/util/shell_quote.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

/// A word of a command line as it runs from anywhere.
std::string resolved(const std::string& word, bool is_program, const fs::path& beside) {
  if (word.empty() || std::string("/-~{$").find(word[0]) != std::string::npos ||
      word.find("://") != std::string::npos)
    return word;
  const bool is_path =
      word.find('/') != std::string::npos || (!is_program && word.find('.') != std::string::npos);
  std::error_code none;
  if (!is_path || !fs::exists(beside / word, none)) return word;
  return shell_quote((beside / word).lexically_normal().string());
}

}  // namespace

void resolve_processes(Experiment& e) {
  for (auto& [name, command] : e.processes) {
    const std::string key = "processes." + name;
    const auto place = e.where.find(key);
    const bool in_file = place != e.where.end() && place->second.starts_with(e.file + ":");
    const fs::path beside =
        in_file ? fs::absolute(e.file).lexically_normal().parent_path() : fs::current_path();
    constexpr const char* kEnds = " \t'\"`;&|<>()=,";
    std::string out;
    for (size_t at = 0, end = 0; at < command.size(); at = end) {
      end = std::min(command.find_first_of(kEnds, at), command.size());
      const std::string word = command.substr(at, end - at);
      const bool is_program = out.find_first_not_of(" \t") == std::string::npos;
      std::error_code none;
      if (is_program && (word.starts_with("./") || word.starts_with("../")) &&
          !fs::exists(beside / word, none))
        fail(e, key, "'" + word + "' is not there (looked in " + beside.string() + ")");
      out += resolved(word, is_program, beside);
      if (end < command.size()) out += command[end++];
    }
    command = out;
  }
}

std::string procfile(const Experiment& e, const std::string& run_dir, const std::string& restart) {
  const std::string dir = shell_quote(run_dir);
  std::string out;
  std::map<std::string, std::string> own = e.processes;
  const auto add = [&](const std::string& name, const std::string& usual, bool required) {
    const bool guest = own.contains(name);
    std::string command = "exec " + usual;  // else a signal of honcho would end the shell before the program
    if (const auto it = own.find(name); it != own.end()) {
      command = replaced(it->second, "{run_dir}", dir);
      own.erase(it);
    }
    if (e.faults.drop > 0)
      command =
          "export LAB_FAULT_DROP=" + number(e.faults.drop) + "," + std::to_string(e.seed) + "; " + command;
    out += "#lab: " + name + " required=" + (required ? "yes" : "no") +
           " restart=" + (name == "simulator" ? "never" : restart) + (guest ? " guest=yes" : "") + "\n" +
           name + ": " + command + "\n";
  };
  add("simulator",
      "lab-simulator --experiment " + shell_quote(run_dir + "/experiment.yaml") + " --run-dir " + dir, true);
  add("planner", "lab-planner --run-dir " + dir, true);
  add("controller", "lab-controller --run-dir " + dir, true);
  add("logger", "lab-logger --run-dir " + dir, true);
  if (e.renderer.enabled) add("renderer", "lab-renderer --run-dir " + dir, false);
  const std::map<std::string, std::string> others = own;
  for (const auto& [name, command] : others)
    if (name != "renderer") add(name, command, false);
  return out;
}

}  // namespace lab
