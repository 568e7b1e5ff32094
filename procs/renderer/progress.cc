#include "procs/renderer/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace lab::renderer {

constexpr int64_t kWorthIt = 10, kWide = 30;

Progress::Progress(std::string what, int64_t total)
    : what_(std::move(what)), total_(total), shown_(isatty(STDERR_FILENO) && total > kWorthIt) {}

Progress::~Progress() {
  if (shown_ && drawn_ >= 0) fmt::print(stderr, "\n");
}

void Progress::at(int64_t done) {
  if (!shown_ || done == drawn_) return;
  drawn_ = std::min(done, total_);
  const auto full = static_cast<size_t>(kWide * drawn_ / total_);
  fmt::print(stderr, "\r{} [{}{}] {} of {} ", what_, std::string(full, '#'), std::string(kWide - full, '.'),
             drawn_, total_);
  std::fflush(stderr);
}

}  // namespace lab::renderer
