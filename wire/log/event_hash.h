// What CHECK says of a log: how many events there were since the one before, and the hash of their bytes.
#pragma once
#include <cstdint>
#include <lab/check_t.hpp>
#include <span>

#include "wire/protocol/log_hash.h"

namespace lab {

inline constexpr int64_t kCheckEvery = 1000;  ///< events between two CHECKs

/// The events since the last CHECK.
class EventHash {
 public:
  void reset() {
    hash_.reset();
    count_ = 0;
  }
  /// `event`: all its bytes in the file.
  void add(std::span<const uint8_t> event, int64_t utime) {
    hash_.add(event);
    ++count_;
    utime_ = utime;
  }
  int64_t count() const { return count_; }
  int64_t utime() const { return utime_; }  ///< of the last event
  /// The CHECK that proves them.
  check_t check(int64_t run) const {
    check_t check{};
    check.utime = utime_;
    check.run = run;
    check.step = -1;
    check.count = count_;
    check.hash = hash_.value();
    return check;
  }

 private:
  LogHash hash_;
  int64_t count_ = 0, utime_ = 0;
};

}  // namespace lab
