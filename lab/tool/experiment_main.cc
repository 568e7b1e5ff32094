// lab-experiment: checks experiments, evaluates runs, makes reports. Scripts call it, so that they need not read YAML.
#include "core/util/command_line.h"
#include "core/util/console.h"
#include "core/util/exit_code.h"
#include "lab/tool/experiment_verbs.h"
#include "lab/tool/sweep_verb.h"

namespace lab {
namespace {

struct AllOptions : Options {
  sweep::Options sweep;
};

// options that several verbs have
void add_file(CommandLine& verb, Options& o) { verb.option("experiment", o.file, "YAML file").required(); }
void add_set(CommandLine& verb, Options& o) {
  verb.option("--set", o.set, "key=value over what the file says, such as controller.kp=80").one_word();
}
void add_run_dir(CommandLine& verb, Options& o) {
  verb.option("run", o.run_dir, "folder of a run").required();
}
void add_json(CommandLine& verb, Options& o) { verb.flag("--json", o.as_json, "print JSON"); }

void check_options(CommandLine& verb, AllOptions& o) {
  verb.option("experiments", o.files, "YAML files").required();
  add_set(verb, o);
  add_json(verb, o);
}

void resolve_options(CommandLine& verb, AllOptions& o) {
  add_file(verb, o);
  add_set(verb, o);
  verb.option("-o,--output", o.out, "file to write instead of printing");
  verb.flag("--stay", o.stay, "in real time and until it is ended; the motion keeps its duration");
  add_json(verb, o);
}

void processes_options(CommandLine& verb, AllOptions& o) {
  add_file(verb, o);
  add_set(verb, o);
  verb.option("--run-dir", o.run_dir, "folder of the run; it holds experiment.yaml").show_default();
  verb.option("--restart", o.restart, "policy of all but the simulator")
      .one_of({"never", "on-failure", "always"})
      .show_default();
}

void evaluate_options(CommandLine& verb, AllOptions& o) {
  add_run_dir(verb, o);
  add_json(verb, o);
}

void manifest_options(CommandLine& verb, AllOptions& o) {
  add_run_dir(verb, o);
  add_json(verb, o);
  verb.option("--exit", o.exits, "name=code of a process that has ended").one_word();
  verb.option("--started", o.launch.started, "UTC, ISO 8601");
  verb.option("--ended", o.launch.ended, "UTC, ISO 8601");
  verb.option("--wall", o.launch.wall_seconds, "seconds the run took");
}

void verdict_options(CommandLine& verb, AllOptions& o) {
  verb.option("run", o.ended_run, "folder of a run (default: nothing has run)");
  verb.option("--name", o.name, "of the experiment").required();
  verb.option("--code", o.code, "exit code of the run").required();
  verb.option("--reason", o.reason, "why it did not run");
  verb.option("--junit", o.junit, "JUnit XML to write");
  add_json(verb, o);
}

void report_options(CommandLine& verb, AllOptions& o) {
  verb.option("runs", o.files, "folders of runs").required();
}

void compare_options(CommandLine& verb, AllOptions& o) {
  verb.option("runs", o.files, "folders of runs").required().count(2, 32);
  verb.option("-o,--output", o.out, "page to write (HTML)");
  add_json(verb, o);
}

void sweep_options(CommandLine& verb, AllOptions& all) {
  sweep::Options& o = all.sweep;
  verb.option("sweep", o.file, "YAML file (docs/sweep.md)").required();
  verb.option("-o,--output", o.dir,
              "the sweep's folder; what has been run there is not run again (default: sweep-NAME)");
  verb.option("-j,--jobs", o.jobs, "threads (default: one per CPU), or tasks of the Slurm array (default: 8)")
      .range(1, 10000);
  verb.option("--engine", o.engine, "who computes: threads of this process, or a Slurm array")
      .one_of({"local", "slurm"})
      .show_default();
  verb.flag("--dry-run", o.dry_run, "only list the runs");
  verb.flag("--json", o.as_json, "print JSON");
  verb.option("--part", o.part, "I/N: only every N-th run from I on, and no pages: a task of a Slurm array");
}

void keys_options(CommandLine& verb, AllOptions& o) {
  verb.option("keys", o.files, "words: keys that contain one of them (default: all)");
  add_json(verb, o);
}

struct Verb {
  const char *name, *what, *example;
  void (*add_options)(CommandLine&, AllOptions&);
  int (*run)(const AllOptions&);
};

constexpr Verb kVerbs[] = {
    {"check", "Says what is wrong with experiments; warnings go to stderr.", "check experiments/*.yaml",
     check_options, [](const AllOptions& o) { return check_files(o); }},
    {"resolve", "Checks an experiment and prints every key as it will run.",
     "resolve experiments/cubic_pd.yaml --set simulator.dt=0.002 -o experiment.yaml", resolve_options,
     [](const AllOptions& o) { return resolve_file(o); }},
    {"processes", "Prints the Procfile of an experiment.",
     "processes runs/latest/experiment.yaml --run-dir runs/latest", processes_options,
     [](const AllOptions& o) { return list_processes(o); }},
    {"evaluate", "Reads RUN/log.lcm, writes RUN/metrics.json; exit code = verdict.", "evaluate runs/latest",
     evaluate_options, [](const AllOptions& o) { return evaluate_run(o); }},
    {"manifest", "Writes RUN/manifest.json: versions, hashes, host, times, exit codes.",
     "manifest runs/latest --exit simulator=0 --wall 3.2", manifest_options,
     [](const AllOptions& o) { return write_manifest(o); }},
    {"verdict", "Says what came of a run, as JSON or JUnit XML: what `lab run --json --junit FILE` prints.",
     "verdict runs/latest --name cubic_pd --code 0 --json", verdict_options,
     [](const AllOptions& o) { return tell_verdict(o); }},
    {"report", "Writes RUN/report.html of each run: one page, plots and all; prints its path.",
     "report runs/latest", report_options, [](const AllOptions& o) { return report_runs(o); }},
    {"compare", "Compares runs with the first of them.",
     "compare runs/sinusoid_pd runs/sinusoid_ct -o compare.html", compare_options,
     [](const AllOptions& o) { return compare_runs(o); }},
    {"sweep", "Runs an experiment for every point of a grid and every draw; writes sweep.csv and sweep.html.",
     "sweep experiments/sweeps/kp_kd.yaml -o runs/sweep-kp_kd", sweep_options,
     [](const AllOptions& o) { return sweep::run(o.sweep); }},
    {"keys", "Prints the table of all keys (Markdown), or what is to say of some.", "keys controller.kp",
     keys_options, [](const AllOptions& o) { return list_keys(o); }},
};

int run(int argc, char** argv) {
  CommandLine line("lab-experiment", "Looks at experiments and at what came of them.");
  line.needs_verb();
  line.footer(
      "Exit codes: 0 ok, 1 a verdict failed, 2 usage, 3 bad experiment, robot or file.\n"
      "example: lab-experiment check experiments/cubic_pd.yaml --set controller.kp=80");
  AllOptions options;
  for (const Verb& verb : kVerbs) {
    CommandLine sub = line.verb(verb.name, verb.what);
    verb.add_options(sub, options);
    sub.footer(std::string("example: lab-experiment ") + verb.example);
  }
  if (const auto code = line.parse(argc, argv)) return *code;
  try {
    for (const Verb& verb : kVerbs)
      if (line.chosen() == verb.name) return verb.run(options);
    return kUsage;
  } catch (const std::exception& e) {
    return refuse("lab-experiment", e.what(), kBadConfig);
  }
}

}  // namespace
}  // namespace lab

int main(int argc, char** argv) {
  return lab::run_program("lab-experiment", [&] { return lab::run(argc, argv); });
}
