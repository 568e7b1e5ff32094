// lab-experiment: looks at experiments and at what came of them. Scripts ask it, so that they need not read
// YAML.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/util/atomic_file.h"
#include "core/util/number.h"
#include "lab/check/check.h"
#include "lab/evaluation/evaluate.h"
#include "lab/evaluation/read_run.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/hash.h"
#include "lab/tool/manifest.h"
#include "lab/tool/procfile.h"
#include "lab/tool/report_verbs.h"
#include "lab/tool/sweep_verb.h"

namespace lab {
namespace {

using nlohmann::json;
enum Exit { kOk = 0, kFailed = 1, kUsage = 2, kBadConfig = 3 };

struct Options {
  std::vector<std::string> files, set, exits;
  std::string file, out, run_dir = ".", restart = "never";
  Launch launch;
  bool as_json = false;
};

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::cerr << warning << "\n";
}

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
        std::cout << file << ": ok (" << robot.model.name << ", nq " << robot.model.nq << ", nv "
                  << robot.model.nv << "; " << e.last_step() << " steps of " << number(e.simulator.dt)
                  << " s)\n";
      }
    } catch (const std::exception& error) {
      one["ok"] = false;
      one["error"] = error.what();
      if (!options.as_json) std::cerr << error.what() << "\n";
      result = kBadConfig;
    }
    all.push_back(one);
  }
  if (options.as_json) std::cout << all.dump(2) << "\n";
  return result;
}

int resolve_file(const Options& options) {
  Experiment e = load_experiment(options.file, options.set);
  print_warnings(check(e, load_robot(e)));
  if (const std::string model = find_model(e); !model.empty())
    e.robot.model = model;  // the run's folder is elsewhere
  const std::string text =
      "# As run; made from " + std::filesystem::path(options.file).filename().string() + ".\n" + resolve(e);
  if (options.out.empty() || options.out == "-")
    std::cout << text;
  else
    write_atomically(options.out, text);
  return kOk;
}

int list_processes(const Options& options) {
  std::cout << procfile(load_experiment(options.file, options.set), options.run_dir, options.restart);
  return kOk;
}

void print_metrics(const json& all) {
  const auto cell = [](const json& value) { return value.is_number() ? rounded(value.get<double>()) : "-"; };
  size_t width = 6;
  for (const json& joint : all["joints"]) width = std::max(width, joint["name"].get<std::string>().size());
  const char* columns[] = {"max_error",   "mean_error",    "rms_error",
                           "final_error", "settling_time", "max_effort"};
  const auto line = [&](const std::string& name, const json& row, bool head) {
    std::cout << name << std::string(width + 2 - name.size(), ' ');
    for (const char* column : columns) {
      const std::string text = head ? column : cell(row.value(column, json()));
      std::cout << std::string(text.size() < 14 ? 14 - text.size() : 1, ' ') << text;
    }
    std::cout << "\n";
  };
  line("joint", {}, true);
  for (const json& joint : all["joints"]) line(joint["name"], joint, false);
  line("all", all, false);
  if (all.contains("handbook_grade"))
    std::cout << "handbook's figure " << cell(all["handbook_error"]) << " ("
              << all["handbook_grade"].get<std::string>() << "), energy drift " << cell(all["energy_drift"])
              << " J\n";
  if (all.contains("tool_frame") && all["tool_frame"].is_string())
    std::cout << "tool " << all["tool_frame"].get<std::string>() << " within " << cell(all["max_tool_error"])
              << " m and " << cell(all["max_tool_turn"]) << " rad of its reference\n";
  if (!all["reaches"].empty())
    std::cout << all["reaches"].size() << (all["reaches"].size() == 1 ? " reach" : " reaches")
              << ": settled after at most " << cell(all["reach_settling_max"]) << " s, overshoot "
              << cell(all["overshoot_max"]) << ", error left " << cell(all["steady_error_max"]) << "\n";
  for (const json& verdict : all["verdicts"]) {
    std::cout << (verdict["ok"].get<bool>() ? "ok      " : "FAILED  ") << verdict["metric"].get<std::string>()
              << " " << cell(verdict["value"]);
    if (verdict.contains("min")) std::cout << ", at least " << cell(verdict["min"]);
    if (verdict.contains("max")) std::cout << ", at most " << cell(verdict["max"]);
    std::cout << "\n";
  }
  if (!all["complete"].get<bool>())
    std::cout << "FAILED  the run ended at step " << all["last_step"] << " of " << all["wanted_last_step"]
              << (all["reason"].get<std::string>().empty() ? "" : ": " + all["reason"].get<std::string>())
              << "\n";
}

int evaluate_run(const Options& options) {
  const LoggedRun logged = read_run(options.run_dir + "/log.lcm");
  json all = evaluate(logged.run, logged.experiment.expect);
  all["experiment"] = logged.experiment.name;
  all["robot"] = logged.robot.model.name;
  all["run"] = hex(logged.id);
  write_atomically(options.run_dir + "/metrics.json", all.dump(2) + "\n");
  if (options.as_json)
    std::cout << all.dump(2) << "\n";
  else
    print_metrics(all);
  return all["passed"].get<bool>() ? kOk : kFailed;
}

int write_manifest(Options options) {
  for (const std::string& text : options.exits) {
    const size_t equals = text.find('=');
    try {
      options.launch.exit_codes[text.substr(0, equals)] = std::stoi(text.substr(equals + 1));
    } catch (const std::exception&) {
      std::cerr << "--exit " << text << ": must look like simulator=0\n";
      return kUsage;
    }
  }
  const std::string text = manifest(options.run_dir, options.launch).dump(2) + "\n";
  write_atomically(options.run_dir + "/manifest.json", text);
  if (options.as_json) std::cout << text;
  return kOk;
}

int run(int argc, char** argv) {
  CLI::App app("Looks at experiments and at what came of them.", "lab-experiment");
  app.require_subcommand(1);
  app.set_version_flag("--version", LAB_VERSION);
  app.footer(
      "Exit codes: 0 ok, 1 a verdict failed, 2 usage, 3 bad experiment, robot or file.\n"
      "example: lab-experiment check experiments/cubic_pd.yaml --set controller.kp=80");
  Options o;
  const auto file = [&](CLI::App* verb) { verb->add_option("experiment", o.file, "YAML file")->required(); };
  const auto set = [&](CLI::App* verb) {
    verb->add_option("--set", o.set, "key=value over what the file says, such as controller.kp=80")
        ->allow_extra_args(false);
  };
  const auto run_dir = [&](CLI::App* verb) {
    verb->add_option("run", o.run_dir, "folder of a run")->required();
  };
  const auto as_json = [&](CLI::App* verb) { verb->add_flag("--json", o.as_json, "print JSON"); };

  CLI::App* check =
      app.add_subcommand("check", "Says what is wrong with experiments; warnings go to stderr.");
  check->add_option("experiments", o.files, "YAML files")->required();
  set(check), as_json(check);
  check->footer("example: lab-experiment check experiments/*.yaml");

  CLI::App* resolve =
      app.add_subcommand("resolve", "Checks an experiment and prints every key as it will run.");
  file(resolve), set(resolve);
  resolve->add_option("-o,--output", o.out, "file to write instead of printing");
  resolve->footer(
      "example: lab-experiment resolve experiments/cubic_pd.yaml --set simulator.dt=0.002 -o "
      "experiment.yaml");

  CLI::App* processes = app.add_subcommand("processes", "Prints the Procfile of an experiment.");
  file(processes), set(processes);
  processes->add_option("--run-dir", o.run_dir, "folder of the run; it holds experiment.yaml")
      ->capture_default_str();
  processes->add_option("--restart", o.restart, "policy of all but the simulator")
      ->check(CLI::IsMember({"never", "on-failure", "always"}))
      ->capture_default_str();
  processes->footer("example: lab-experiment processes runs/latest/experiment.yaml --run-dir runs/latest");

  CLI::App* evaluate =
      app.add_subcommand("evaluate", "Reads RUN/log.lcm, writes RUN/metrics.json; exit code = verdict.");
  run_dir(evaluate), as_json(evaluate);
  evaluate->footer("example: lab-experiment evaluate runs/latest");

  CLI::App* manifest =
      app.add_subcommand("manifest", "Writes RUN/manifest.json: versions, hashes, host, times, exit codes.");
  run_dir(manifest), as_json(manifest);
  manifest->add_option("--exit", o.exits, "name=code of a process that has ended")->allow_extra_args(false);
  manifest->add_option("--started", o.launch.started, "UTC, ISO 8601");
  manifest->add_option("--ended", o.launch.ended, "UTC, ISO 8601");
  manifest->add_option("--wall", o.launch.wall_seconds, "seconds the run took");
  manifest->footer("example: lab-experiment manifest runs/latest --exit simulator=0 --wall 3.2");

  CLI::App* report = app.add_subcommand(
      "report", "Writes RUN/report.html of each run: one page, plots and all; prints its path.");
  report->add_option("runs", o.files, "folders of runs")->required();
  report->footer("example: lab-experiment report runs/latest");

  CLI::App* compare = app.add_subcommand("compare", "Compares runs with the first of them.");
  compare->add_option("runs", o.files, "folders of runs")->required()->expected(2, 32);
  compare->add_option("-o,--output", o.out, "page to write (HTML)");
  as_json(compare);
  compare->footer("example: lab-experiment compare runs/sinusoid_pd runs/sinusoid_ct -o compare.html");
  sweep::Options many;
  CLI::App* sweep = sweep::add_verb(app, many);

  CLI::App* keys = app.add_subcommand("keys", "Prints the table of all keys (Markdown).");
  keys->footer("example: lab-experiment keys");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kOk : kUsage;
  }
  try {
    if (*check) return check_files(o);
    if (*resolve) return resolve_file(o);
    if (*processes) return list_processes(o);
    if (*evaluate) return evaluate_run(o);
    if (*manifest) return write_manifest(o);
    if (*report) report::report_runs(o.files);
    if (*compare) report::compare_runs(o.files, o.out, o.as_json);
    if (*sweep) return sweep::run(many);
    if (*keys) std::cout << key_table();
    return kOk;
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return kBadConfig;
  }
}

}  // namespace
}  // namespace lab

int main(int argc, char** argv) { return lab::run(argc, argv); }
