// What is wrong with a log: each damaged place, and what the log says of itself.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace lab {

struct LogDamage {
  uint64_t offset = 0;  ///< of its first byte in the file
  uint64_t bytes = 0;   ///< of the file that are concerned
  int64_t step = -1;    ///< that is concerned; -1 = none, or not known
  std::string channel;  ///< empty: several, or not known
  std::string what;
};

struct LogFindings {
  static constexpr size_t kMaxDamages = 1000;
  std::vector<LogDamage> damages;  ///< the first ones
  int64_t damage_count = 0;
  int64_t run = 0;         ///< 0: there is no RUN
  bool has_end = false;    ///< without END it was cut off, or is still being written
  bool checksums = false;  ///< END proves RUN, TYPE and itself; logs of earlier versions have no checksums

  /// Places that touch and have the same fault are one.
  void add(LogDamage damage);
  bool sound() const { return damage_count == 0; }
  /// Sound and whole.
  bool complete() const { return sound() && has_end; }
};

/// `offset 4711, step 12, COMMAND: what is wrong`
std::string text_of(const LogDamage& damage);
/// One line for each damage, at most `most`, then how many more there are; and one if END is missing.
std::vector<std::string> lines_of(const LogFindings& findings, size_t most = 10);

}  // namespace lab
