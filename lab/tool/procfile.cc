#include "lab/tool/procfile.h"

#include "core/util/number.h"
#include "core/util/shell_quote.h"

namespace lab {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

}  // namespace

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
