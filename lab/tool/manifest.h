// manifest.json of a run folder: everything needed to make the same run again.
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lab {

/// What the supervisor knows and the run folder does not hold.
struct Launch {
  std::map<std::string, int> exit_codes;  ///< by process
  std::string started, ended;             ///< UTC, ISO 8601; empty = not known
  double wall_seconds = 0;                ///< 0 = not known
};

/// Of a run that has ended: versions, compiler, CPU, GL renderer (from gl.txt if there is one), seed, hashes, host, times,
/// exit codes, and the names that it may write, as its first manifest has them (scripts/lib.sh, begin_manifest). Reads
/// what is there of experiment.yaml, log.lcm, metrics.json; what is missing is null.
nlohmann::json manifest(const std::string& run_dir, const Launch&);

}  // namespace lab
