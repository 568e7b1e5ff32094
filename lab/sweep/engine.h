#pragma once
#include <span>
#include <string>
#include <vector>

#include "lab/sweep/results.h"
#include "lab/sweep/workbench.h"

namespace lab::sweep {

/// How far it is, on stderr: a bar that stays on its line if that is a terminal, else a line every ten seconds.
class Progress {
 public:
  Progress(int64_t total, bool quiet);
  ~Progress();
  /// `done` of all, `fresh` of them in this life, which tells the time left.
  void show(int64_t done, int64_t fresh);

 private:
  const int64_t total_;
  const bool quiet_, terminal_;
  const double began_;
  double next_;
  bool shown_ = false;
};

/// Finds the result of each of these runs, into rows[run]; with `run_missing` runs those that have none, on so many
/// threads. Values that cannot be run make a row that says so. Ends early when interrupted. Throws if results cannot
/// be written.
void work_through(Workbench&, Results&, std::vector<Row>& rows, std::span<const int64_t> runs, int threads,
                  bool run_missing, bool quiet);

struct SlurmJob {
  std::string sweep_file, dir, name;
  int64_t tasks = 1;
};
/// Writes DIR/slurm/sweep.sh and submits it as an array, and waits for its end. Each task is this program again as
/// `sweep FILE -o DIR --part I/N`. Throws std::runtime_error if Slurm refuses. When interrupted, cancels the job.
void run_on_slurm(const SlurmJob&, Results&, int64_t total, int64_t missing, bool quiet);

/// The runs of one task: every N-th.
std::vector<int64_t> part_of(int64_t runs, int64_t part, int64_t parts);

}  // namespace lab::sweep
