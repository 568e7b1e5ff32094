#pragma once
#include <string>

#include "procs/experiment/experiment.h"

namespace lab {

/// The Procfile of an experiment: "name: command" per process, policy in "#lab:" lines before it. honcho and
/// foreman run it too. `run_dir` holds experiment.yaml; it is quoted where a shell needs it.
std::string procfile(const Experiment&, const std::string& run_dir);

}  // namespace lab
