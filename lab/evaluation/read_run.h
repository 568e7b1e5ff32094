// Reads a run back from its log.lcm, which is self-contained: RUN has the experiment and the robot.
#pragma once
#include <string>

#include "lab/evaluation/evaluate.h"
#include "lab/experiment/robot.h"

namespace lab {

struct LoggedRun {
  Experiment experiment;
  Robot robot;
  Run run;
  int64_t id = 0;
};

/// Throws std::runtime_error with one line: no such file, no RUN, a message that the guard refuses, ..
/// With noise or delay the states are the true ones, recomputed from the log's commands; a log that this does not
/// reproduce is refused. A log without END counts as aborted.
LoggedRun read_run(const std::string& log);

}  // namespace lab
