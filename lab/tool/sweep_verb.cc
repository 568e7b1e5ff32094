#include "lab/tool/sweep_verb.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>

#include "core/util/atomic_file.h"
#include "core/util/command_line.h"
#include "core/util/console.h"
#include "core/util/exit_code.h"
#include "core/util/interrupt.h"
#include "core/util/json_text.h"
#include "lab/evaluation/metrics.h"
#include "lab/sweep/engine.h"
#include "lab/sweep/page.h"
#include "lab/sweep/table.h"

namespace lab::sweep {
namespace {

namespace fs = std::filesystem;
constexpr int kTasks = 8;         // of the Slurm array, without -j
constexpr size_t kMaxNamed = 10;  // runs that are named if something is wrong with them

int usage(const std::string& fault) { return refuse("lab-experiment", fault, kUsage); }

/// Locks the sweep's folder for as long as this process lives. Returns "" or what is wrong.
std::string take_folder(const std::string& dir) {
  std::error_code error;
  if (fs::exists(dir) && !fs::is_directory(dir)) return dir + " is a file, not a folder";
  if (fs::exists(dir, error) && !fs::is_empty(dir, error) && !Results::are_in(dir + "/results"))
    return dir + " is not empty and not the folder of a sweep: choose a new or empty folder";
  fs::create_directories(dir + "/results", error);
  const int folder = error ? -1 : open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0 || access(dir.c_str(), W_OK) != 0)
    return dir + " cannot be written (" + (error ? error.message() : std::strerror(errno)) + ")";
  if (flock(folder, LOCK_EX | LOCK_NB) != 0) return "another sweep is running in " + dir;
  return "";
}

/// "3/8"
bool read_part(const std::string& text, int64_t& part, int64_t& parts) {
  char rest = 0;
  return sscanf(text.c_str(), "%ld/%ld%c", &part, &parts, &rest) == 2 && part >= 0 && part < parts;
}

/// Prints the runs that `match`, the first few of them.
void name_runs(const Sweep& sweep, const std::vector<Row>& rows, const char* what, const auto& match) {
  std::vector<size_t> runs;
  for (size_t run = 0; run < rows.size(); ++run)
    if (match(rows[run])) runs.push_back(run);
  if (runs.empty()) return;
  say("{} of {} runs {}:", runs.size(), rows.size(), what);
  for (size_t i = 0; i < std::min(runs.size(), kMaxNamed); ++i)
    say("  run {} ({}): {}", runs[i], settings(sweep, static_cast<int64_t>(runs[i])), rows[runs[i]].reason);
  if (runs.size() > kMaxNamed)
    say("  .. and {} more: see column reason of sweep.csv", runs.size() - kMaxNamed);
}

/// " rad, m"; "" for a metric without a unit.
std::string unit_of(const std::string& name) {
  const Metric* const metric = metric_of(name);
  return metric && *metric->unit ? std::string(" ") + metric->unit : "";
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
    emit("{}\n", json_text(all, 2));
  } else {
    for (size_t m = 0; m < sweep.metrics.size(); ++m)
      if (const Extremes found = extremes(rows, m); found.smallest >= 0)
        emit("  smallest {} {:.4g}{}: run {} ({})\n", sweep.metrics[m],
             rows[static_cast<size_t>(found.smallest)].metrics[m], unit_of(sweep.metrics[m]), found.smallest,
             settings(sweep, found.smallest));
    emit("sweep folder: {}\n  figures   sweep.csv ({} runs, {} complete), sweep.html\n", o.dir, rows.size(),
         counts.complete);
  }
  return counts.unable > 0 ? kCheckFailed : kOk;
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
  if (!o.part.empty()) return interrupted ? 128 + interrupted : kOk;
  if (const int64_t missing = count(rows).missing; slurm && missing > 0 && !interrupted) {
    const int64_t tasks = std::min<int64_t>(o.jobs ? o.jobs : kTasks, missing);
    run_on_slurm({o.file, o.dir, "sweep-" + sweep.name, tasks}, results, sweep.runs(), missing, false);
    if (!interrupted) work_through(bench, results, rows, all, threads, false, true);
  }
  const int64_t missing = count(rows).missing;
  if (interrupted) {
    say("lab sweep: stopped with {} of {} runs done; the same command continues from there",
        sweep.runs() - missing, sweep.runs());
    return 128 + interrupted;
  }
  if (missing > 0) {
    say("lab sweep: {} of {} runs have no result; {}/slurm/*.out says why", missing, sweep.runs(), o.dir);
    return kCheckFailed;
  }
  return finish(sweep, rows, o);
}

}  // namespace

int run(const Options& options) {
  Options o = options;
  int64_t part = 0, parts = 1;
  if (!o.part.empty() && !read_part(o.part, part, parts))
    return usage(fmt::format("--part {}: must look like 0/8", o.part));
  const Sweep sweep = read_sweep(o.file);
  Workbench bench(sweep);
  bench.check();
  if (o.dry_run) {
    emit("{}", o.as_json ? json_text(runs_as_json(sweep), 2) + "\n" : list_of_runs(sweep));
    return kOk;
  }
  if (o.dir.empty()) o.dir = "sweep-" + sweep.name;
  if (const std::string fault = o.part.empty() ? take_folder(o.dir) : ""; !fault.empty()) return usage(fault);
  try {
    return run_all(sweep, bench, o, part, parts);
  } catch (const std::runtime_error&
               error) {  // results cannot be written, or no Slurm: not a fault of the experiment
    return refuse("lab sweep", error.what(), kCheckFailed);
  }
}

}  // namespace lab::sweep
