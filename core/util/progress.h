// How far a long job is, on stderr.
#pragma once
#include <cstdint>
#include <string>

namespace lab {

/// On a terminal a bar that stays on its line; elsewhere a line every ten seconds, if it has a name for them.
class Progress {
 public:
  struct Style {
    std::string label{};      ///< before the bar
    std::string line_name{};  ///< elsewhere: "NAME: 3 of 10"; empty = nothing
    bool keep = false;        ///< the bar stays when the job ends, else it is erased
    int64_t shown_above = 0;  ///< jobs of at most so many parts show nothing
    bool quiet = false;       ///< nothing at all
  };

  Progress(int64_t total, Style);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` parts of all; `fresh` of them were done in this invocation, which gives the time left.
  void show(int64_t done, int64_t fresh = 0);
  /// Whether there is a bar.
  bool on_terminal() const { return shown_ && terminal_; }

 private:
  const int64_t total_;
  const Style style_;
  const bool terminal_;
  const bool shown_;
  const double start_;
  double next_;
  bool drawn_ = false;
};

}  // namespace lab
