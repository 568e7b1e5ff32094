// The two timers of the roles: when to repeat a request, and for how long nothing has happened.
#pragma once
#include <algorithm>
#include <cstdint>

namespace lab {

using Micros = int64_t;  ///< us of some monotonic clock that the caller chooses

inline constexpr Micros kFirstWait = 1'000;      ///< T: wait before the first NEED
inline constexpr Micros kLongestWait = 100'000;  ///< T doubles up to this
inline constexpr Micros kRepeat = 100'000;       ///< period of ACK, END and PROCESS

/// When to repeat a request: after T, which doubles at each retry and returns to kFirstWait on progress.
class RetryTimer {
 public:
  void reset(Micros now) {
    wait_ = kFirstWait;
    due_ = now + wait_;
  }
  /// Makes the next retry due now.
  void trigger(Micros now) { due_ = now; }
  Micros due() const { return due_; }
  /// True when a retry is due; then the next one is scheduled.
  bool expired(Micros now) {
    if (now < due_) return false;
    due_ = now + wait_;
    wait_ = std::min(2 * wait_, kLongestWait);
    return true;
  }

 private:
  Micros wait_ = kFirstWait;
  Micros due_ = 0;
};

/// Time without progress, for a process that may itself have been suspended: the time between two updates counts as
/// at most 2 kRepeat.
class IdleTimer {
 public:
  void reset() { elapsed_ = 0; }
  void update(Micros now) {
    if (last_ >= 0) elapsed_ += std::min(now - last_, 2 * kRepeat);
    last_ = now;
  }
  Micros elapsed() const { return elapsed_; }

 private:
  Micros elapsed_ = 0;
  Micros last_ = -1;
};

}  // namespace lab
