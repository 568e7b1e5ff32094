// Pictures and films from a log, complete or truncated.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace lab::renderer {

/// What to draw. What is not set comes from the run's experiment.yaml, if the log lies
/// beside one, or from the defaults.
struct FromLog {
  std::string source;  ///< log.lcm or a run folder
  std::string folder;  ///< where the pictures go; may be empty if there is only a video
  // what to make; without any of it: pictures at the experiment's rate
  std::vector<double> times;        ///< s: pictures then
  std::optional<double> fps;        ///< pictures at this rate
  std::string video;                ///< file: a film of them
  int64_t contact = 0;              ///< contact.png of this many pictures
  std::optional<int64_t> ghost;     ///< ghost.png of this many poses
  bool depth = false, ids = false;  ///< beside each picture
  // appearance
  int width = 0, height = 0;  ///< 0: as in the experiment
  std::string camera, quality;
  bool orthographic = false;
  std::optional<double> orbit;               ///< rad/s
  std::optional<std::string> follow, trace;  ///< frames
  bool reference = false;
  std::string trace_by = "time";
  std::vector<std::string> arrows;
  int workers = 0;      ///< 0: chosen by the number of pictures and cores
  bool strict = false;  ///< a missing or broken mesh or texture is an error
};

/// Draws them and prints the names of what it wrote. Returns an exit code; throws an error of one line.
int render_log(const FromLog& job);

}  // namespace lab::renderer
