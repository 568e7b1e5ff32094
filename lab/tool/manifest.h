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

/// What a JSON file of a run's folder holds; null if it is not there or is no object.
nlohmann::json object_in(const std::string& path);
/// A member of an object; null if there is none.
nlohmann::json member(const nlohmann::json& object, const char* key);

/// Of a run that has ended: versions, compiler, CPU, GL renderer (from gl.txt if there is one), seed, hashes, host, times,
/// exit codes, and the names that it may write, as its first manifest has them (scripts/lib-runs.sh, begin_manifest). Reads
/// what is there of experiment.yaml, log.lcm, metrics.json; what is missing is null.
nlohmann::json manifest(const std::string& run_dir, const Launch&);

}  // namespace lab
