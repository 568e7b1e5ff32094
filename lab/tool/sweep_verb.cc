#include "lab/tool/sweep_verb.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>

#include "core/util/atomic_file.h"
#include "core/util/interrupt.h"
#include "lab/sweep/engine.h"
#include "lab/sweep/page.h"
#include "lab/sweep/table.h"

namespace lab::sweep {
namespace {

namespace fs = std::filesystem;
constexpr int kTasks = 8;      // of Slurm, unless -j says otherwise
constexpr size_t kNamed = 10;  // runs that are named when something is wrong with them

/// The sweep's folder, ours for as long as this process lives. Returns "" or what is wrong.
std::string take_folder(const std::string& dir) {
  std::error_code error;
  if (fs::exists(dir) && !fs::is_directory(dir)) return dir + " is a file, not a folder";
  if (fs::exists(dir / fs::path("experiment.yaml"))) return dir + " is the folder of a run: give a new one";
  fs::create_directories(dir, error);
  const int folder = error ? -1 : open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0 || access(dir.c_str(), W_OK) != 0)
    return dir + " cannot be written (" + (error ? error.message() : std::strerror(errno)) + ")";
  if (flock(folder, LOCK_EX | LOCK_NB) != 0) return "another sweep is alive in " + dir;
  return "";
}

/// "3/8"
bool read_part(const std::string& text, int64_t& part, int64_t& parts) {
  char rest = 0;
  return sscanf(text.c_str(), "%ld/%ld%c", &part, &parts, &rest) == 2 && part >= 0 && part < parts;
}

/// Names the runs that have this, the first few.
void name_runs(const Sweep& sweep, const std::vector<Row>& rows, const char* what, const auto& have) {
  std::vector<size_t> runs;
  for (size_t run = 0; run < rows.size(); ++run)
    if (have(rows[run])) runs.push_back(run);
  if (runs.empty()) return;
  fmt::print(stderr, "{} of {} runs {}:\n", runs.size(), rows.size(), what);
  for (size_t i = 0; i < std::min(runs.size(), kNamed); ++i)
    fmt::print(stderr, "  run {} ({}): {}\n", runs[i], settings(sweep, static_cast<int64_t>(runs[i])),
               rows[runs[i]].reason);
  if (runs.size() > kNamed)
    fmt::print(stderr, "  .. and {} more: column reason of sweep.csv\n", runs.size() - kNamed);
}

int finish(const Sweep& sweep, const std::vector<Row>& rows, const Options& o) {
  write_atomically(o.dir + "/sweep.csv", csv(sweep, rows));
  write_atomically(o.dir + "/sweep.html", page(sweep, rows));
  name_runs(sweep, rows, "ended early",
            [](const Row& row) { return row.state == Row::State::Done && !row.complete; });
  name_runs(sweep, rows, "could not be run", [](const Row& row) { return row.state == Row::State::Unable; });
  const Counts counts = count(rows);
  if (o.as_json) {
    nlohmann::json all = summary(sweep, rows);
    all["folder"] = o.dir;
    fmt::print("{}\n", all.dump(2));
  } else {
    for (size_t m = 0; m < sweep.metrics.size(); ++m)
      if (const Extremes found = extremes(rows, m); found.smallest >= 0)
        fmt::print("  smallest {} {:.4g}: run {} ({})\n", sweep.metrics[m],
                   rows[static_cast<size_t>(found.smallest)].metrics[m], found.smallest,
                   settings(sweep, found.smallest));
    fmt::print("sweep folder: {}\n  figures   sweep.csv ({} runs, {} complete), sweep.html\n", o.dir,
               rows.size(), counts.complete);
  }
  return counts.unable > 0 ? 1 : 0;
}

int run_all(const Sweep& sweep, Workbench& bench, const Options& o, int64_t part, int64_t parts) {
  install_signal_handlers();
  Results results(o.dir + "/results", sweep.metrics);
  results.load();
  std::vector<Row> rows(static_cast<size_t>(sweep.runs()));
  const std::vector<int64_t> all = part_of(sweep.runs(), part, parts);
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int threads = o.part.empty() ? std::min<int>(o.engine == "local" && o.jobs ? o.jobs : cores,
                                                     static_cast<int>(all.size()))
                                     : 1;
  const bool slurm = o.engine == "slurm" && o.part.empty();
  work_through(bench, results, rows, all, threads, !slurm, !o.part.empty());
  if (!o.part.empty()) return interrupted ? 128 + interrupted : 0;
  if (const int64_t missing = count(rows).missing; slurm && missing > 0 && !interrupted) {
    const int64_t tasks = std::min<int64_t>(o.jobs ? o.jobs : kTasks, missing);
    run_on_slurm({o.file, o.dir, "sweep-" + sweep.name, tasks}, results, sweep.runs(), missing, false);
    if (!interrupted) work_through(bench, results, rows, all, threads, false, true);
  }
  const int64_t missing = count(rows).missing;
  if (interrupted) {
    fmt::print(stderr, "lab sweep: stopped with {} of {} runs done; the same command goes on from there\n",
               sweep.runs() - missing, sweep.runs());
    return 128 + interrupted;
  }
  if (missing > 0) {
    fmt::print(stderr, "lab sweep: {} of {} runs have no result; {}/slurm/*.out says why\n", missing,
               sweep.runs(), o.dir);
    return 1;
  }
  return finish(sweep, rows, o);
}

}  // namespace

CLI::App* add_verb(CLI::App& app, Options& o) {
  CLI::App* verb = app.add_subcommand(
      "sweep",
      "Runs an experiment for every point of a grid and every draw; writes sweep.csv and sweep.html.");
  verb->add_option("sweep", o.file, "YAML file (docs/sweep.md)")->required();
  verb->add_option("-o,--output", o.dir,
                   "the sweep's folder; what has been run there is not run again (default: sweep-NAME)");
  verb->add_option("-j,--jobs", o.jobs,
                   "threads (default: one per CPU), or tasks of the Slurm array (default: 8)")
      ->check(CLI::Range(1, 10000));
  verb->add_option("--engine", o.engine, "who computes: threads of this process, or a Slurm array")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  verb->add_flag("--dry-run", o.dry_run, "only list the runs");
  verb->add_flag("--json", o.as_json, "print JSON");
  verb->add_option("--part", o.part,
                   "I/N: only every N-th run from I on, and no pages: a task of a Slurm array");
  verb->footer("example: lab-experiment sweep experiments/sweeps/kp_kd.yaml -o runs/sweep-kp_kd");
  return verb;
}

int run(const Options& options) {
  Options o = options;
  int64_t part = 0, parts = 1;
  if (!o.part.empty() && !read_part(o.part, part, parts))
    return fmt::print(stderr, "--part {}: must look like 0/8\n", o.part), 2;
  const Sweep sweep = read_sweep(o.file);
  Workbench bench(sweep);
  bench.check();
  if (o.dry_run)
    return fmt::print("{}", o.as_json ? runs_as_json(sweep).dump(2) + "\n" : list_of_runs(sweep)), 0;
  if (o.dir.empty()) o.dir = "sweep-" + sweep.name;
  if (const std::string fault = o.part.empty() ? take_folder(o.dir) : ""; !fault.empty())
    return fmt::print(stderr, "{}\n", fault), 2;
  try {
    return run_all(sweep, bench, o, part, parts);
  } catch (const std::runtime_error& error) {  // no place for results, no Slurm: nobody's experiment is wrong
    fmt::print(stderr, "lab sweep: {}\n", error.what());
    return 1;
  }
}

}  // namespace lab::sweep
