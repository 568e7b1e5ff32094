// The guard before every decode and every publish: generated decoders get no message that it refuses (they allocate
// before they check), and no message that it would refuse is published.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wire/schema/channels.h"
#include "wire/schema/schema.h"

namespace lab {

/// The three numbers every message starts with.
struct Head {
  int64_t utime = 0;
  int64_t run = 0;
  int64_t step = 0;
};

struct Verdict {
  enum Kind : uint8_t { Accepted, Foreign, Refused } kind = Accepted;
  std::string reason;  ///< empty when accepted; else channel, field, value seen, value wanted
  Head head;           ///< unless refused
  explicit operator bool() const { return kind == Accepted; }
};

/// The types of lcmtypes/, parsed once from the embedded texts.
const Schema& lab_schema();

class Guard {
 public:
  explicit Guard(std::string prefix = "");
  /// The robot's sizes, from RUN or the model; until then (or with -1) vectors may have any length.
  void set_sizes(int nq, int nv);
  /// The run to accept; 0 = not known yet: every run is accepted.
  void set_run(int64_t run) { run_ = run; }
  int64_t run() const { return run_; }

  /// Checks length, fingerprint and content (Schema::check), the run, and the row's size rules. Foreign: of
  /// another run. No allocation when accepted.
  Verdict check(std::string_view channel, std::span<const uint8_t> bytes) const;
  Verdict check(Channel channel, std::span<const uint8_t> bytes) const;

 private:
  struct Rule {
    const Type* type = nullptr;
    int nq_offset = -1, nv_offset = -1;  // of the count fields in the message, bytes; -1 = no rule
  };
  std::string prefix_;
  std::vector<Rule> rules_;
  int nq_ = -1, nv_ = -1;
  int64_t run_ = 0;
};

}  // namespace lab
