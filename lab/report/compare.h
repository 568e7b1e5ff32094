// Runs side by side: what differs in their experiments and in their results. The first run is the baseline.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lab/evaluation/metrics.h"
#include "lab/report/report.h"

namespace lab::report {

/// How much better than the first, of a metric of which less is better.
struct Gain {
  double percent;  ///< 100: as good as perfect; below 0: worse; NaN if that has no meaning
  double times;    ///< 2: twice as good; 0.5: half as good; NaN
};
Gain gain(Better, double first, double other);

/// "99.9 %, 720 times better", "12 % worse", "same", "–"; of a metric of which neither is better "12 % more", "3 times less"
std::string in_words(Better, double first, double other);

struct Comparison {
  std::vector<std::string> names;  ///< of the runs, all different
  std::vector<std::string> notes;  ///< what could not be compared, and why
  bool same_joints = true;
  std::vector<std::string> joints;  ///< that all runs have

  struct Key {
    std::string name;
    std::vector<std::string> values;  ///< by run; empty = none
  };
  std::vector<Key> keys;  ///< those that differ

  struct Row {
    /// "max_error", or "max_error.elbow". Where the robots have joints that turn and joints that slide, "max_error" has two
    /// rows, in rad and in m.
    std::string name, unit;
    Better better;
    std::vector<double> values;  ///< by run; NaN: has none
  };
  std::vector<Row> rows;  ///< of metrics that at least one run has
};

/// Throws std::runtime_error when a run has nothing to compare.
Comparison compare(const std::vector<Folder>&);

std::string compare_text(const Comparison&);
nlohmann::json compare_json(const Comparison&);
std::string compare_page(const Comparison&, const std::vector<Folder>&);

}  // namespace lab::report
