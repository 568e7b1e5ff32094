#pragma once
#include <optional>
#include <string>
#include <vector>

namespace lab::renderer {

/// Pictures from a finished (or broken off) log. What is not set comes from the run's experiment.yaml, if the log lies
/// beside one, or from the defaults.
struct FromLog {
  std::string source;          ///< log.lcm or a run's folder
  std::string folder;          ///< where the pictures go
  std::vector<double> times;   ///< s; empty: at `fps`
  std::optional<double> fps;
  int width = 0, height = 0;   ///< 0: as in the experiment
  std::string camera, quality;
};

/// Draws them and says what it wrote. Returns an exit code; throws with one clear line.
int render_log(const FromLog& job);

}  // namespace lab::renderer
