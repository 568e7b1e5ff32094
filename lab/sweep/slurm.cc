// The same runs as tasks of a Slurm array.
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
#include "core/util/interrupt.h"
#include "core/util/progress.h"
#include "core/util/shell_quote.h"
#include "lab/sweep/engine.h"

namespace lab::sweep {
namespace {

namespace fs = std::filesystem;

struct Said {
  int code = 0;
  std::string text;  ///< stdout and stderr
};

Said shell(const std::string& command) {
  Said said;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot start a shell");
  char block[4096];
  for (size_t n; (n = fread(block, 1, sizeof block, pipe)) > 0;) said.text.append(block, n);
  const int status = pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  while (!said.text.empty() && said.text.back() == '\n') said.text.pop_back();
  return said;
}

/// False once the job has left the queue. A controller that does not answer for a while is waited for.
bool in_queue(const std::string& job, int& silent) {
  const Said said = shell("squeue --noheader --jobs " + job);
  if (said.code == 0) return silent = 0, !said.text.empty();
  if (said.text.find("Invalid job id") != std::string::npos) return false;
  if (++silent > 30)
    throw std::runtime_error("squeue fails: " + said.text +
                             "; the job goes on: run the same sweep again to collect it");
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
  const Said said = shell(fmt::format(
      "sbatch --parsable --job-name={} --array=0-{} --ntasks=1 --cpus-per-task=1 --output={} {}",
      shell_quote(job.name), job.tasks - 1, shell_quote(folder + "/%a.out"), shell_quote(script)));
  const std::string id = said.text.substr(0, said.text.find(';'));
  if (said.code != 0 || id.find_first_not_of("0123456789") != std::string::npos || id.empty())
    throw std::runtime_error("sbatch failed: " + (said.text.empty() ? "no answer" : said.text));
  if (!quiet) fmt::print(stderr, "lab sweep: Slurm job {} of {} tasks\n", id, job.tasks);

  Progress progress(total, {.line_name = "lab sweep", .quiet = quiet});
  const int64_t before = total - missing;
  const auto known = static_cast<int64_t>(results.size());
  for (int silent = 0; in_queue(id, silent);) {
    for (int i = 0; i < 10 && !interrupted; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (interrupted) {
      shell("scancel " + id);
      return;
    }
    results.load();
    const int64_t fresh = static_cast<int64_t>(results.size()) - known;
    progress.show(std::min(before + fresh, total), fresh);
  }
  results.load();
}

}  // namespace lab::sweep
