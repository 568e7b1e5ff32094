// Reads the states, references and pushes that pictures show from a log.
#pragma once
#include <cstdint>
#include <lab/run_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "procs/renderer/snapshot.h"
#include "wire/log/findings.h"

namespace lab::renderer {

struct Logged {
  run_t run{};
  std::vector<int64_t> steps;  ///< those with a state, increasing
  std::vector<Push> pushes;    ///< by request, not planned
  LogFindings log;             ///< what is wrong with the log
};
/// Throws ExperimentError if there is no RUN or no state.
Logged survey(const std::string& path);

/// The snapshots at some of its steps (rising), references where they are logged.
std::map<int64_t, Snapshot> read_snapshots(const std::string& path, const std::vector<int64_t>& steps,
                                           double dt);

}  // namespace lab::renderer
