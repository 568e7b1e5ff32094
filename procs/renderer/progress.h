#pragma once
#include <cstdint>
#include <string>

namespace lab::renderer {

/// A bar on stderr, if that is a terminal and there is something to wait for.
class Progress {
 public:
  Progress(std::string what, int64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void at(int64_t done);
  bool shown() const { return shown_; }

 private:
  std::string what_;
  int64_t total_, drawn_ = -1;
  bool shown_;
};

}  // namespace lab::renderer
