#pragma once
#include <string>

namespace CLI {
class App;
}

namespace lab::sweep {

/// `lab-experiment sweep`.
struct Options {
  std::string file, dir, engine = "local", part;
  int jobs = 0;  ///< threads, or tasks of Slurm; 0 = as many as seem right
  bool dry_run = false, as_json = false;
};
CLI::App* add_verb(CLI::App& app, Options& options);

/// Returns the exit code: 0 all ran, 1 some could not be run, 2 usage, 3 bad sweep, 128 + n signal. Throws
/// ExperimentError and std::runtime_error.
int run(const Options& options);

}  // namespace lab::sweep
