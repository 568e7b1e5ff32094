// Makes RUN and TYPE from an experiment, and from RUN what a process needs.
#pragma once
#include <lab/run_t.hpp>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/experiment/robot.h"
#include "wire/protocol/follower.h"

namespace lab {

/// RUN of a run. In lockstep its id is a hash of the experiment's canonical text, the model hash and the seed, so that
/// the same experiment has the same id; in real time no two runs are the same, and it is random.
run_t make_run(const Experiment& experiment, const Robot& robot);

/// The experiment and the robot of a RUN. Throws ExperimentError.
struct RunView {
  Experiment experiment;
  Robot robot;
};
RunView open_run(const run_t& run);

/// The numbers that the roles need.
RunSetup setup_of(const RunView& run);

/// The encoded TYPE messages of a run, sorted by name: one for each type that log.lcm may hold.
std::vector<Bytes> type_messages(int64_t run);

/// The same of every type that travels on the bus or is in a log.
std::vector<Bytes> all_type_messages(int64_t run);

/// Reads the whole steps that a run's log has so far, for a process that restarts. Messages of other
/// runs are skipped; without a file there are none.
ReadLog log_reader(const std::string& log_path);

}  // namespace lab
