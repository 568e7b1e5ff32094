// Runs an experiment in one process and one thread, with the same roles as the separate processes.
#pragma once
#include <functional>

#include "lab/experiment/experiment.h"
#include "lab/experiment/robot.h"
#include "wire/protocol/logger_role.h"
#include "wire/protocol/role.h"

namespace lab::solo {

/// Runs an experiment in one process and one thread: the same roles around the same steps as the separate processes,
/// on a bus that is a queue. The sink gets the same bytes. `keep_going` is called about every thousand messages; when
/// it returns false, the run ends gracefully. Throws ExperimentError.
Outcome run(const Experiment& experiment, const Robot& robot, LogSink& sink,
            const std::function<bool(int64_t step)>& keep_going);

}  // namespace lab::solo
