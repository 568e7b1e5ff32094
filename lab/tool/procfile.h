// The Procfile of an experiment: which processes a run has, and how each is started.
#pragma once
#include <string>

#include "lab/experiment/experiment.h"

namespace lab {

/// The Procfile of an experiment: "name: command" per process, policy in "#lab:" lines before it. honcho and
/// foreman run it too. `run_dir` holds experiment.yaml; it is quoted where a shell needs it.
/// The usual programs replace their shell (exec), so that a signal reaches them alone.
/// `restart` (never, on-failure, always) is the policy of all but the simulator.
std::string procfile(const Experiment&, const std::string& run_dir, const std::string& restart = "never");

/// Makes the paths in `processes` absolute that exist beside the file which names them ("./pd.py", "python3 tools/pd.py"), so
/// that the experiment runs from anywhere. Throws ExperimentError for a program "./x" or "../x" that is not there.
void resolve_processes(Experiment&);

}  // namespace lab
