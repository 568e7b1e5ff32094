#include "wire/protocol/log_policy.h"

#include <algorithm>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {

void LockstepLogPolicy::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  file(channel, bytes, now);
  write_matching_steps(now);
}

void LockstepLogPolicy::file(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  const int64_t step = peek_step(bytes);
  if (step <= log_.written || step > log_.written + ring_.size()) {
    late_ += step <= log_.written;
    return;
  }
  ring_.at(step).store(channel, bytes, true);
  if (channel == Channel::RobotState && step > log_.written + 2 && gap_at_ != log_.written) {
    gap_at_ = log_.written;
    retry_timer_.trigger(now);
  }
}

/// STATE k+1 carries the digest of step k, END that of the last.
std::optional<int64_t> LockstepLogPolicy::published_digest(int64_t step) {
  const std::optional<end_t>& end = log_.end();
  if (end && end->step == step) return end->digest;
  const StepRecord* next = ring_.find(step + 1);
  if (!next || next->state.empty()) return std::nullopt;
  return peek_digest(next->state);
}

void LockstepLogPolicy::write_matching_steps(Micros now) {
  const RunSetup& setup = log_.setup();
  const std::optional<end_t>& end = log_.end();
  for (;;) {
    const int64_t step = log_.written + 1;
    if (end && step > end->step) return log_.close();
    StepRecord* record = ring_.find(step);
    if (!record || !record->complete(step % setup.every == 0)) break;
    const auto digest = published_digest(step);
    if (!digest) break;
    record->trim();
    if (record->digest() != *digest) break;
    if (step % every_ == 0 || (end && end->step == step))
      record->in_order([&](Channel channel, const Bytes& bytes) {
        log_.append(channel, bytes, step_utime(step, setup.dt));
      });
    log_.written = step;
    retry_timer_.reset(now);
    if (log_.written - log_.flushed() >= kWindow / 4) log_.flush();
  }
  if (end && end->aborted && end->digest == 0 && log_.written + 1 >= end->step) log_.close();
}

void LockstepLogPolicy::on_end(Micros now) {
  retry_timer_.trigger(now);
  write_matching_steps(now);
}

void LockstepLogPolicy::tick(Micros now) {
  if (log_.closed() || !retry_timer_.expired(now)) return;
  const int64_t missing = log_.written + 1;
  request(missing);
  if (!published_digest(missing)) request(missing + 1);
}

void LockstepLogPolicy::request(int64_t step) const {
  need_t need{};
  need.run = log_.run();
  need.step = step;
  need.process = kSimulator;
  need.sender = kLogger;
  publish_(Channel::Need, encode(need));
}

void RealtimeLogPolicy::receive(Channel channel, std::span<const uint8_t> bytes, Micros) {
  if (channel == Channel::RobotState) set_time(peek_utime(bytes));
  if (utime_ != kNone)
    write(channel, bytes);
  else if (early_.size() < static_cast<size_t>(kWindow))
    early_.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
  else
    ++late_;
}

void RealtimeLogPolicy::on_end(Micros) {
  if (const auto& end = log_.end()) set_time(end->utime);
  log_.close();
}

void RealtimeLogPolicy::set_time(int64_t utime) {
  utime_ = std::max(utime_, utime);
  log_.begin(utime_);
  for (const auto& [channel, bytes] : early_) write(channel, bytes);
  early_.clear();
}

void RealtimeLogPolicy::write(Channel channel, std::span<const uint8_t> bytes) {
  if (channel == Channel::Input) {
    const int64_t seq = decode<input_t>(bytes).input_seq;
    if (seq <= input_seq_) return;  // re-sent for another process
    input_seq_ = seq;
  }
  const int64_t step = peek_step(bytes);
  if (step % every_ == 0 || channel == Channel::Input || channel == Channel::Event)
    log_.append(channel, bytes, utime_);
  if (channel == Channel::RobotState) log_.written = std::max(log_.written, step);
}

}  // namespace lab
