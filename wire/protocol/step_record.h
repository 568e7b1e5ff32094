// The bytes of one step as they go into log.lcm, and a ring of them.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "wire/protocol/role.h"

namespace lab {

/// The bytes of one step, as they go into log.lcm: INPUT by number, STATE, REFERENCE, COMMAND, EVENT by (process, index).
struct StepRecord {
  int64_t step = kBeforeStart;
  std::map<int64_t, Bytes> inputs;
  Bytes state, reference, command;
  std::map<std::pair<std::string, int64_t>, Bytes> events;

  /// Empties the record for another step; keeps the memory.
  void clear(int64_t new_step);
  /// Stores a message of this step. An earlier one with the same key stays, unless `replace`.
  /// Returns false if a step has no such message or the key is taken.
  bool store(Channel channel, std::span<const uint8_t> bytes, bool replace);
  /// True when the process' main message is here with all the extras that it counts.
  bool closed_by(const std::string& process) const;
  /// True when state, reference and the command (if `with_command`) are here, each with all its extras.
  bool complete(bool with_command) const;
  /// Drops the EVENTs that no main message counts, so that a stray one cannot get into the digest.
  void trim();
  /// Calls visit(channel, bytes) in the order of the log.
  template <class Visit>
  void in_order(Visit visit) const {
    for (const auto& [seq, bytes] : inputs) visit(Channel::Input, bytes);
    if (!state.empty()) visit(Channel::RobotState, state);
    if (!reference.empty()) visit(Channel::Reference, reference);
    if (!command.empty()) visit(Channel::Command, command);
    for (const auto& [key, bytes] : events) visit(Channel::Event, bytes);
  }
  /// XXH3 over channel, size and bytes of all that is here, in the order of the log. Never 0.
  int64_t digest() const;

 private:
  const Bytes* main_of(const std::string& process) const;
  int64_t extras_of(const std::string& process) const;
};

/// The records of the last `size` steps.
class StepRing {
 public:
  explicit StepRing(int64_t size) : records_(size) {}
  /// The record of a step; emptied first if its slot held another step. Steps must be asked for within a span of size().
  StepRecord& at(int64_t step) {
    StepRecord& record = records_[step % size()];
    if (record.step != step) record.clear(step);
    return record;
  }
  /// The record of a step, or null if it is gone or never was.
  StepRecord* find(int64_t step) {
    if (step < 0) return nullptr;
    StepRecord& record = records_[step % size()];
    return record.step == step ? &record : nullptr;
  }
  int64_t size() const { return static_cast<int64_t>(records_.size()); }

 private:
  std::vector<StepRecord> records_;
};

/// Single fields without decoding the rest: every message starts with fingerprint, utime, run, step, the three
/// main messages end with extras, and in ROBOT_STATE the digest stands before them.
int64_t peek_utime(std::span<const uint8_t> message);
int64_t peek_step(std::span<const uint8_t> message);
int64_t peek_run(std::span<const uint8_t> message);
/// The digest of the step before, in a ROBOT_STATE.
int64_t peek_digest(std::span<const uint8_t> robot_state);
int32_t peek_extras(std::span<const uint8_t> main_message);

}  // namespace lab
