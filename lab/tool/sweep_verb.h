// `lab-experiment sweep`.
#pragma once
#include <string>

namespace lab::sweep {

struct Options {
  std::string file, dir, engine = "local", part;
  int jobs = 0;  ///< threads, or tasks of the Slurm array; 0 = the default
  bool dry_run = false, as_json = false;
};

/// Returns the exit code: 0 all ran, 1 some could not be run, 2 usage, 3 bad sweep, 128 + n signal. Throws
/// ExperimentError and std::runtime_error.
int run(const Options& options);

}  // namespace lab::sweep
