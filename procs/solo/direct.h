// Runs an experiment by calling the steps in a loop: no messages, no log. For sweeps of thousands of runs that only
// need metrics, and for tests.
#pragma once
#include <functional>
#include <optional>

#include "lab/evaluation/evaluate.h"

namespace lab::solo {

/// The same steps as run() in solo.h, in sequence. Gives what evaluation reads from that run's log, bit for bit: the
/// logged states and references, and why the run ended early. `keep_going` is called every 1024 steps; when it returns
/// false, there is no result. Throws ExperimentError.
std::optional<Run> run_direct(const Experiment& experiment, const rbd::Model& model,
                              const std::function<bool()>& keep_going = {});

}  // namespace lab::solo
