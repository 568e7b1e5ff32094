#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "core/util/atomic_file.h"
#include "core/util/console.h"
#include "core/util/interrupt.h"
#include "core/util/progress.h"
#include "core/util/shell_quote.h"
#include "lab/sweep/engine.h"

namespace lab::sweep {
namespace {

namespace fs = std::filesystem;

struct Output {
  int code = 0;
  std::string text;  ///< stdout and stderr
};

Output shell(const std::string& command) {
  Output output;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot start a shell");
  char block[4096];
  for (size_t n; (n = fread(block, 1, sizeof block, pipe)) > 0;) output.text.append(block, n);
  const int status = pclose(pipe);
  output.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  while (!output.text.empty() && output.text.back() == '\n') output.text.pop_back();
  return output;
}

/// False once the job has left the queue. Up to 30 calls in a row may fail, as when the Slurm controller restarts.
bool in_queue(const std::string& job, int& failures) {
  const Output output = shell("squeue --noheader --jobs " + job);
  if (output.code == 0) {
    failures = 0;
    return !output.text.empty();
  }
  if (output.text.find("Invalid job id") != std::string::npos) return false;
  if (++failures > 30)
    throw std::runtime_error("squeue fails: " + output.text +
                             "; the job continues: run the same sweep again to collect it");
  return true;
}

}  // namespace

void run_on_slurm(const SlurmJob& job, Results& results, int64_t total, int64_t missing, bool quiet) {
  const std::string folder = fs::absolute(job.dir) / "slurm", script = folder + "/sweep.sh";
  fs::create_directories(folder);
  write_atomically(
      script,
      fmt::format("#!/bin/bash\n"
                  "# {} runs in {} tasks; a task runs what is still missing of its part\n"
                  "exec {} sweep {} -o {} --part \"$SLURM_ARRAY_TASK_ID/{}\"\n",
                  missing, job.tasks, shell_quote(fs::read_symlink("/proc/self/exe")),
                  shell_quote(fs::absolute(job.sweep_file)), shell_quote(fs::absolute(job.dir)), job.tasks));
  const Output output = shell(fmt::format(
      "sbatch --parsable --job-name={} --array=0-{} --ntasks=1 --cpus-per-task=1 --output={} {}",
      shell_quote(job.name), job.tasks - 1, shell_quote(folder + "/%a.out"), shell_quote(script)));
  const std::string id = output.text.substr(0, output.text.find(';'));
  if (output.code != 0 || id.find_first_not_of("0123456789") != std::string::npos || id.empty())
    throw std::runtime_error("sbatch failed: " + (output.text.empty() ? "no answer" : output.text));
  if (!quiet) say("lab sweep: Slurm job {} of {} tasks", id, job.tasks);

  Progress progress(total, {.line_name = "lab sweep", .quiet = quiet});
  const int64_t before = total - missing;
  const auto known = static_cast<int64_t>(results.size());
  for (int failures = 0; in_queue(id, failures);) {
    for (int i = 0; i < 10 && !interrupted; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (interrupted) {
      shell("scancel " + id);
      return;
    }
    results.load();
    const int64_t completed = static_cast<int64_t>(results.size()) - known;
    progress.show(std::min(before + completed, total), completed);
  }
  results.load();
}

}  // namespace lab::sweep
