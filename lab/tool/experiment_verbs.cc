#include "lab/tool/experiment_verbs.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/util/atomic_file.h"
#include "core/util/command_line.h"
#include "core/util/console.h"
#include "core/util/exit_code.h"
#include "core/util/json_text.h"
#include "core/util/number.h"
#include "core/util/printable.h"
#include "lab/check/check.h"
#include "lab/check/unused.h"
#include "lab/evaluation/evaluate.h"
#include "lab/evaluation/read_run.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/hash.h"
#include "lab/experiment/keys.h"
#include "lab/report/compare.h"
#include "lab/report/report.h"
#include "lab/tool/metrics_text.h"
#include "lab/tool/procfile.h"
#include "lab/tool/verdict.h"

namespace lab {
namespace {

using nlohmann::json;

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) complain("lab-experiment", warning);
}

/// Prints what is wrong with a log. False if its figures are not those of the whole run.
bool print_findings(const LoggedRun& logged) {
  if (logged.whole()) return true;
  for (const std::string& line : lines_of(logged.log)) complain("lab-experiment", logged.path + ": " + line);
  return false;
}

/// The same for what a page is made of, which may have no log at all.
bool print_findings(const report::Folder& folder) {
  if (folder.logged) return print_findings(*folder.logged);
  complain("lab-experiment", folder.name + ": " + folder.no_log);
  return false;
}

}  // namespace

int check_files(const Options& options) {
  int result = kOk;
  json all = json::array();
  for (const std::string& file : options.files) {
    json one{{"file", file}};
    try {
      const Experiment e = load_experiment(file, options.set);
      const Robot robot = load_robot(e);
      const std::vector<std::string> warnings = check(e, robot);
      one["ok"] = true;
      one["warnings"] = warnings;
      one["robot"] = robot.model.name;
      one["steps"] = e.last_step();
      if (!options.as_json) {
        print_warnings(warnings);
        emit("{}: ok ({}, nq {}, nv {}; {} steps of {} s)\n", file, printable_name(robot.model.name),
             robot.model.nq, robot.model.nv, e.last_step(), number(e.simulator.dt));
      }
    } catch (const std::exception& error) {
      one["ok"] = false;
      one["error"] = error.what();
      if (!options.as_json) complain("lab-experiment", error.what());
      result = kBadConfig;
    }
    all.push_back(one);
  }
  if (options.as_json) emit("{}\n", json_text(all, 2));
  return result;
}

int resolve_file(const Options& options) {
  Experiment e = load_experiment(options.file, options.set);
  if (options.stay) e.keep_running();
  print_warnings(check(e, load_robot(e)));
  if (const std::string model = find_model(e); !model.empty())
    e.robot.model = model;  // the run folder is elsewhere
  resolve_processes(e);
  const std::string text = std::string(kAsRun) + "; made from " +
                           std::filesystem::path(options.file).filename().string() + ".\n" + resolve(e);
  if (options.out.empty() || options.out == "-")
    emit_bytes(text);
  else
    write_atomically(options.out, text);
  return kOk;
}

int list_processes(const Options& options) {
  Experiment e = load_experiment(options.file, options.set);
  resolve_processes(e);
  emit_bytes(procfile(e, options.run_dir, options.restart));
  return kOk;
}

int evaluate_run(const Options& options) {
  const LoggedRun logged = read_run(options.run_dir);
  print_findings(logged);
  json all = evaluate_logged(logged);
  all["experiment"] = logged.experiment.name;
  all["robot"] = logged.robot.model.name;
  all["run"] = hex(logged.id);
  write_atomically(options.run_dir + "/metrics.json", json_text(all, 2) + "\n");
  if (options.as_json)
    emit("{}\n", json_text(all, 2));
  else
    emit_text(metrics_text(all, logged.robot.model));
  return all["passed"].get<bool>() ? kOk : kCheckFailed;
}

int write_manifest(Options options) {
  for (const std::string& text : options.exits) {
    const size_t equals = text.find('=');
    try {
      options.launch.exit_codes[text.substr(0, equals)] = std::stoi(text.substr(equals + 1));
    } catch (const std::exception&) {
      return refuse("lab-experiment", "--exit " + text + ": must look like simulator=0", kUsage);
    }
  }
  const std::string text = json_text(manifest(options.run_dir, options.launch), 2) + "\n";
  write_atomically(options.run_dir + "/manifest.json", text);
  if (options.as_json) emit_text(text);
  return kOk;
}

int report_runs(const Options& options) {
  int result = kOk;
  for (const std::string& dir : options.files) {
    const std::string path = dir + (dir.ends_with('/') ? "" : "/") + "report.html";
    const report::Folder folder = report::read_folder(dir);
    if (!folder.is_plain_group() && !print_findings(folder)) result = kCheckFailed;
    write_atomically(path, report::run_page(folder));
    emit("{}\n", path);
  }
  return result;
}

int compare_runs(const Options& options) {
  std::vector<report::Folder> runs;
  int result = kOk;
  for (const std::string& dir : options.files) {
    runs.push_back(report::read_folder(dir));
    if (runs.back().logged && !print_findings(runs.back())) result = kCheckFailed;
  }
  const report::Comparison all = report::compare(runs);
  if (!options.out.empty()) write_atomically(options.out, report::compare_page(all, runs));
  if (options.as_json)
    emit("{}\n", json_text(compare_json(all), 2));
  else
    emit_text(compare_text(all));
  return result;
}

int list_keys(const Options& options) {
  json all = json::array();
  std::vector<std::string> names;
  std::string text;
  const Experiment standard;
  for_each_key(standard, [&](const Key& key, const auto&) {
    const std::string name = key.name;
    names.push_back(name);
    const bool wanted = std::any_of(options.files.begin(), options.files.end(), [&](const std::string& word) {
      return name.find(word) != std::string::npos;
    });
    if (!options.files.empty() && !wanted) return;
    all.push_back({{"key", name}, {"unit", key.unit}, {"default", key.standard}, {"what", key.doc}});
    text += name + (*key.unit ? std::string(" (") + key.unit + ")" : "") + ", default " + key.standard +
            ": " + key.doc + "\n";
  });
  if (all.empty())
    return refuse("lab-experiment",
                  "there is no key '" + options.files[0] + "'" + did_you_mean(options.files[0], names),
                  kUsage);
  emit_text(options.as_json ? json_text(all, 2) + "\n" : options.files.empty() ? key_table() : text);
  return kOk;
}

int tell_verdict(const Options& options) {
  const auto verdict = run_verdict(options.ended_run, options.name, options.code, options.reason);
  if (!options.junit.empty()) write_atomically(options.junit, junit(verdict));
  if (options.as_json) emit("{}\n", json_text(verdict, 2));
  return kOk;
}

}  // namespace lab
