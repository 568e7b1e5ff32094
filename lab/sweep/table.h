// The results of a sweep as numbers: sweep.csv, JSON, the best runs. The same rows give the same bytes.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lab/sweep/results.h"
#include "lab/sweep/sweep.h"

namespace lab::sweep {

/// One row a run: its number, the draw, the keys that vary, the metrics (empty = no value), complete, passed, last_step,
/// reason. RFC 4180, with \n at the ends of lines.
std::string csv(const Sweep&, const std::vector<Row>&);
/// The same without results, for --dry-run.
std::string list_of_runs(const Sweep&);
nlohmann::json runs_as_json(const Sweep&);

struct Counts {
  int64_t complete = 0, ended_early = 0, unable = 0, missing = 0;
};
Counts count(const std::vector<Row>&);

/// The runs with the smallest and the largest value of a metric; of equal ones the first.
struct Extremes {
  int64_t smallest = -1, largest = -1;
};
Extremes extremes(const std::vector<Row>&, size_t metric);

/// "controller.kp 50, controller.kd 10"
std::string settings(const Sweep&, int64_t run);

/// The command that runs one of them again, as a run of its own.
std::string command(const Sweep&, int64_t run);

nlohmann::json summary(const Sweep&, const std::vector<Row>&);

}  // namespace lab::sweep
