// Works through the runs of a sweep: on threads of this process, or as tasks of a Slurm array.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "lab/sweep/results.h"
#include "lab/sweep/workbench.h"

namespace lab::sweep {

/// Finds the result of each of these runs and puts it into rows[run]; with `run_missing` runs those that have none, on so
/// many threads. Values that cannot be run make a row that says so. Ends early when interrupted. Throws if results cannot
/// be written.
void work_through(Workbench&, Results&, std::vector<Row>& rows, std::span<const int64_t> runs, int threads,
                  bool run_missing, bool quiet);

struct SlurmJob {
  std::string sweep_file, dir, name;
  int64_t tasks = 1;
};
/// Writes DIR/slurm/sweep.sh, submits it as an array and waits for its end. Each task is this program again as
/// `sweep FILE -o DIR --part I/N`. Throws std::runtime_error if Slurm refuses. When interrupted, cancels the job.
void run_on_slurm(const SlurmJob&, Results&, int64_t total, int64_t missing, bool quiet);

/// The runs of one task: every N-th.
std::vector<int64_t> part_of(int64_t runs, int64_t part, int64_t parts);

}  // namespace lab::sweep
