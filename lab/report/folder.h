// The content of a run folder; any part of it may be missing.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "lab/evaluation/read_run.h"

namespace lab::report {

/// An EVENT, or an INPUT from outside.
struct Note {
  double time = 0;  ///< s
  std::string who, what, about, why;
};

inline constexpr size_t kMaxNotes = 60;

/// How long a process took for a loop: a wake-up and all that followed from it. By the wall clock, from telemetry.lcm.
struct Loops {
  std::string process;
  std::vector<int64_t> counts;  ///< by bin of wire/protocol/loop_bins.h; summed over its restarts
  int64_t overruns = 0;
  double late_p50 = 0, late_p99 = 0, late_max = 0;  ///< us, of ticks in real time; 0 if it has none
};

struct Folder {
  std::string name;                      ///< of the folder
  std::optional<LoggedRun> logged;       ///< nothing: see no_log
  std::string no_log;                    ///< why not, in one line
  std::optional<Experiment> experiment;  ///< every key: experiment.yaml, or what the log has of it
  nlohmann::json metrics;                ///< evaluate() of the log; null without one
  std::vector<Note> notes;               ///< in the order of the log, the first kMaxNotes
  size_t note_count = 0;                 ///< all of them
  std::vector<Loops> loops;              ///< by name
  nlohmann::json manifest;               ///< null if there is none
  std::string experiment_text;           ///< experiment.yaml; empty if there is none
  std::vector<std::string> pictures;     ///< PNG files' bytes: the contact sheet, or some frames, of this run
  bool other_pictures = false;           ///< those in the folder show another run, and are left out
  size_t frames = 0;                     ///< in frames/
  /// Of processes that failed: name, and the last lines of their output.
  std::vector<std::pair<std::string, std::string>> last_lines;

  /// From a Procfile, with no simulator of ours: nothing is missing if there is no log.
  bool is_plain_group() const { return experiment_text.empty() && !logged; }
  /// What is logged, where it is known to be there. Throws std::logic_error if it is not.
  const LoggedRun& log() const {
    if (!logged) throw std::logic_error(name + ": has no log");
    return *logged;
  }
};

/// Throws std::runtime_error if this is not a run folder. What is missing in it is not an error.
Folder read_folder(const std::string& dir);

}  // namespace lab::report
