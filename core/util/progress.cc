#include "core/util/progress.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace lab {
namespace {

constexpr int64_t kWidth = 30;
constexpr double kRedraw = 0.1, kLinePeriod = 10;  // s

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string duration(double seconds) {
  const auto s = std::llround(seconds);
  if (s < 120) return std::to_string(s) + " s";
  if (s < 7200) return std::to_string(s / 60) + " min";
  return std::to_string(s / 3600) + " h " + std::to_string(s / 60 % 60) + " min";
}

}  // namespace

Progress::Progress(int64_t total, Style style)
    : total_(total),
      style_(std::move(style)),
      terminal_(isatty(STDERR_FILENO)),
      shown_(!style_.quiet && total > style_.shown_above && (terminal_ || !style_.line_name.empty())),
      start_(now()),
      next_(terminal_ ? 0 : start_ + kLinePeriod) {}

Progress::~Progress() {
  if (drawn_ && terminal_) std::fputs(style_.keep ? "\n" : "\r\x1b[K", stderr);
}

void Progress::show(int64_t done, int64_t fresh) {
  const double time = now();
  const bool last = terminal_ && done >= total_;
  if (!shown_ || (time < next_ && !last)) return;
  next_ = time + (terminal_ ? kRedraw : kLinePeriod);
  std::string text = std::to_string(done) + " of " + std::to_string(total_);
  if (fresh > 0) {
    const double left = (time - start_) / static_cast<double>(fresh) * static_cast<double>(total_ - done);
    text += ", " + duration(left) + " left";
  }
  if (terminal_) {
    const auto full = static_cast<size_t>(kWidth * std::min(done, total_) / std::max<int64_t>(total_, 1));
    const std::string bar = std::string(full, '#') + std::string(kWidth - full, '.');
    std::fprintf(stderr, "\r\x1b[K%s[%s] %s", style_.label.c_str(), bar.c_str(), text.c_str());
  } else {
    std::fprintf(stderr, "%s: %s\n", style_.line_name.c_str(), text.c_str());
  }
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace lab
