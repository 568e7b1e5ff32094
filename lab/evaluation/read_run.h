// Reads a run back from its log.lcm, which is self-contained: RUN has the experiment and the robot.
#pragma once
#include <string>

#include "lab/evaluation/evaluate.h"
#include "lab/experiment/robot.h"
#include "wire/log/findings.h"

namespace lab {

struct LoggedRun {
  Experiment experiment;
  Robot robot;
  Run run;
  int64_t id = 0;
  std::string path;      ///< of the log
  LogFindings log;       ///< what is wrong with it: `run` has its whole steps
  bool growing = false;  ///< the run goes on: END is still to come

  /// These are the figures of all that was run so far.
  bool whole() const { return log.complete() || (log.sound() && growing); }
};

/// `source`: a log, or the folder of a run. Throws std::runtime_error with one line: no such file, no RUN, ..
/// With noise or delay the states are the true ones, recomputed from the log's commands; a log that this does not
/// reproduce is refused. A log without END counts as aborted. Memory does not grow with the log.
LoggedRun read_run(const std::string& source);

/// evaluate() of its steps, and "log": whether it is sound, has an END and checksums, and its damages as texts. "passed" is
/// false if it is damaged.
nlohmann::json evaluate_logged(const LoggedRun&);

}  // namespace lab
