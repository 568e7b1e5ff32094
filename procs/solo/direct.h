#pragma once
#include <functional>
#include <optional>

#include "lab/evaluation/evaluate.h"
#include "lab/experiment/robot.h"

namespace lab::solo {

/// The same steps as run(), called one after the other: no messages, no log. Gives what evaluation reads back from the
/// log of such a run, bit for bit: the logged states and references, and why the run ended early. For when thousands of
/// runs are wanted for their metrics alone. `keep_going` is asked now and then; when it says no, there is no result.
/// Throws ExperimentError.
std::optional<Run> run_direct(const Experiment& experiment, const Robot& robot,
                              const std::function<bool()>& keep_going = {});

}  // namespace lab::solo
