// A sweep: one experiment, run once for every point of a grid and every draw. docs/sweep.md shows the file.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "lab/experiment/experiment_yaml.h"
#include "lab/sweep/draw.h"

namespace lab::sweep {

/// place: "FILE:LINE", for messages.
struct Axis {
  std::string key, place;
  std::vector<std::string> values;  ///< each as YAML on one line
};

struct Draw {
  std::string key, place;
  Distribution distribution;
};

struct Sweep {
  std::string file, name;        ///< name: the file's, without .yaml
  std::string experiment, text;  ///< file, and its text
  std::vector<Override> set;     ///< for all runs
  std::vector<Axis> grid;
  std::vector<Draw> draws;
  int64_t draw_count = 1, seed = 0;  ///< every point of the grid gets the same draws
  std::vector<std::string> metrics;
  std::string metrics_place;

  /// Points of the grid times draws. Runs are counted from 0: draws fastest, the first key of the grid slowest.
  int64_t runs() const;
  int64_t draw_of(int64_t run) const { return run % draw_count; }
  /// Which value of each key of the grid.
  std::vector<size_t> point_of(int64_t run) const;
  /// The keys that vary: the grid's, then the drawn ones; and their values in one run.
  std::vector<std::string> keys() const;
  std::vector<std::string> values(int64_t run) const;
  /// What a run overrides in the experiment's text.
  std::vector<Override> overrides(int64_t run) const;
};

/// Throws ExperimentError, one line per fault.
Sweep read_sweep(const std::string& file);

}  // namespace lab::sweep
