// lab-model: looks at a robot file without running anything.
#include <iostream>
#include <iterator>

#include "core/util/command_line.h"
#include "core/util/console.h"
#include "core/util/exit_code.h"
#include "core/util/json_text.h"
#include "core/util/printable.h"
#include "lab/model/describe.h"
#include "lab/model/eval.h"
#include "lab/model/robot.h"
#include "lab/model/tree.h"

namespace lab::model {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::vector<std::string> files;
  std::string file, gravity;
  bool no_mimic = false, notes = false, as_json = false;
  RobotOptions robot;
};

void print(const ordered_json& value, int indent) { emit("{}\n", json_text(value, indent)); }

/// Errors always; warnings and notes on demand.
void print(const std::vector<rbd::urdf::Diagnostic>& diagnostics, rbd::urdf::Severity least) {
  for (const rbd::urdf::Diagnostic& d : diagnostics)
    if (d.severity >= least) say("{}", printable(d.text()));
}

int check(const Options& options) {
  int result = kOk;
  ordered_json all = ordered_json::array();
  for (const std::string& file : options.files) {
    const Robot robot = load(file, options.robot);
    if (!robot.ok()) result = kBadConfig;
    if (options.as_json) {
      ordered_json said = ordered_json::array();
      for (const rbd::urdf::Diagnostic& d : robot.diagnostics) said.push_back(to_json(d));
      ordered_json one{{"file", file}, {"ok", robot.ok()}};
      if (robot.ok())
        one.update({{"name", robot.model.name}, {"nq", robot.model.nq}, {"nv", robot.model.nv}});
      one["diagnostics"] = said;
      all.push_back(one);
      continue;
    }
    print(robot.diagnostics, options.notes ? rbd::urdf::Severity::Note : rbd::urdf::Severity::Warning);
    if (robot.ok())
      emit("{}: ok ({}, nq {}, nv {}, {:.6g} kg)\n", file, printable_name(robot.model.name), robot.model.nq,
           robot.model.nv, mass_of(robot.model));
  }
  if (options.as_json) print(all, 2);
  return result;
}

int info(const Options& options, const Robot& robot) {
  if (options.as_json) {
    print(info_json(robot), 2);
    return kOk;
  }
  print(robot.diagnostics, rbd::urdf::Severity::Warning);
  emit_text(info_text(robot));
  return kOk;
}

int tree(const Options& options, const Robot& robot) {
  if (options.as_json)
    print(tree_json(robot.model), 2);
  else
    emit_text(tree_text(robot.model));
  return kOk;
}

int eval(const Robot& robot) {
  const std::string text(std::istreambuf_iterator<char>(std::cin), {});
  const Evaluation result = evaluate(robot.model, parse(text));
  for (const auto* lines : {&result.warnings, &result.errors})
    for (const std::string& line : *lines)
      say("lab-model: {}{}", lines == &result.warnings ? "warning: " : "", line);
  print(result.out, -1);
  return result.errors.empty() ? kOk : kCheckFailed;
}

struct Verb {
  const char *name, *what, *example;
  bool many;  ///< takes several robots
};
constexpr Verb kVerbs[] = {
    {"info", "Name, joints with kinds and limits, masses, frames.", "info models/simple_3dof_arm.urdf",
     false},
    {"check", "Says what is wrong with robot files, one line each: FILE:LINE: element: what (value seen).",
     "check robots/*.urdf", true},
    {"eval", "Reads states (JSON) from stdin, prints all of their dynamics (JSON).",
     "eval builtin:manipulator <<< '{\"states\": [{\"q\": [0, 0, 0, 0, 0, 0]}], \"frames\": "
     "[\"arm_tool_link\"]}'",
     false},
    {"tree", "Joints, links and frames as a tree.", "tree builtin:humanoid", false}};

void add_verb(CommandLine& line, const Verb& verb, Options& o) {
  CommandLine sub = line.verb(verb.name, verb.what);
  sub.flag("--floating-base", o.robot.floating_base,
           "the root link floats (a free-flyer joint 'root_joint')");
  sub.flag("--no-mimic", o.no_mimic, "mimic joints are free");
  sub.option("--gravity", o.gravity, "x,y,z in m/s2 (default 0,0,-9.81)");
  sub.flag("--json", o.as_json, "print JSON");
  sub.footer(std::string("example: lab-model ") + verb.example);
  if (verb.many) {
    sub.option("robots", o.files, "URDF files, package://.. or builtin:NAME").required();
    sub.flag("--notes", o.notes, "also what was left out or adapted without harm");
  } else {
    sub.option("robot", o.file, "URDF file, package://.. or builtin:NAME").required();
  }
}

int run_verb(const std::string& verb, Options& o) {
  if (verb == "check") {
    o.robot.meshes = true;
    return check(o);
  }
  const Robot loaded = load(o.file, o.robot);
  if (!loaded.ok()) {
    print(loaded.diagnostics, rbd::urdf::Severity::Error);
    return kBadConfig;
  }
  if (verb == "info") return info(o, loaded);
  if (verb == "tree") return tree(o, loaded);
  return eval(loaded);
}

int run(int argc, char** argv) {
  CommandLine line("lab-model",
                   "Looks at a robot: what it is, what is wrong with its file, what its dynamics are.");
  line.needs_verb();
  line.footer(
      "A robot is a URDF file, package://.., builtin:manipulator or builtin:humanoid.\n"
      "Exit codes: 0 ok, 1 a state cannot be evaluated, 2 usage or bad input, 3 the robot is refused.\n"
      "example: lab-model info builtin:manipulator");
  Options o;
  for (const Verb& verb : kVerbs) add_verb(line, verb, o);
  if (const auto code = line.parse(argc, argv)) return *code;

  try {
    o.robot.mimic = !o.no_mimic;
    if (!o.gravity.empty()) o.robot.gravity = gravity_of(o.gravity);
  } catch (const std::invalid_argument& error) {
    return refuse("lab-model", std::string("--gravity: ") + error.what(), kUsage);
  }
  try {
    return run_verb(line.chosen(), o);
  } catch (const InputError& error) {
    return refuse("lab-model", error.what(), kUsage);
  } catch (const std::exception& error) {
    return refuse("lab-model", error.what(), kCheckFailed);
  }
}

}  // namespace
}  // namespace lab::model

int main(int argc, char** argv) {
  return lab::run_program("lab-model", [&] { return lab::model::run(argc, argv); });
}
