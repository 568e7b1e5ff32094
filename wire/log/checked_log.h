// The reader of a run's log. It proves what it gives: framing, numbers, run, order of the steps, and the digests and hashes
// that the recorder left. Everything that judges or draws a run reads its log with this.
#pragma once
#include <string>

#include "wire/log/findings.h"
#include "wire/log/logged_steps.h"

namespace lab {

/// Calls visit(channel, message) for RUN, TYPE, the messages of whole steps and END of the first run in the file, in its order;
/// messages of earlier versions as this version has them. What is damaged is left out and named in the
/// findings. Memory: one step in lockstep, 2,000 events in real time. Throws std::runtime_error if the file cannot be read.
LogFindings read_checked(const std::string& path, const VisitLogged& visit);

/// The log of a run's folder: log.lcm, or log.lcm.part if that is all there is. Any other path as it is.
std::string find_log(const std::string& source);

/// Whether the run in whose folder this log is goes on (it holds a lock on its folder): then END is still to come.
bool is_being_written(const std::string& path);

}  // namespace lab
