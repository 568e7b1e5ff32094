#include "wire/protocol/run_log.h"

#include <algorithm>
#include <lab/ack_t.hpp>
#include <lab/input_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab {

bool RunLog::open(std::span<const uint8_t> run_bytes, const run_t& run, const RunSetup& setup,
                  bool every_step, const MakeTypes& types) {
  run_ = run.run;
  setup_ = setup;
  bool resumed = false;
  const LogKind kind{.may_split = setup.realtime, .checks = setup.realtime || !every_step};
  sink_.open(run_, kind, [&](Channel channel, std::span<const uint8_t> logged) {
    resumed = true;
    if (channel == Channel::Run || channel == Channel::Type) beginning_.add(channel, logged);
    if (channel == Channel::RobotState) {
      written = peek_step(logged);
      state_utime = peek_utime(logged);
    }
    if (channel == Channel::Input) input_seq = decode<input_t>(logged).input_seq;
  });
  flushed_ = written;
  if (resumed) return true;
  to_begin_.emplace_back(Channel::Run, Bytes(run_bytes.begin(), run_bytes.end()));
  for (Bytes& type : types(run_)) to_begin_.emplace_back(Channel::Type, std::move(type));
  if (!setup.realtime) {
    begin(run.utime);
    sink_.flush();
  }
  return false;
}

void RunLog::begin(int64_t utime) {
  for (const auto& [channel, bytes] : to_begin_) {
    sink_.append(channel, bytes, utime);
    beginning_.add(channel, bytes);
  }
  to_begin_.clear();
}

void RunLog::set_end(std::span<const uint8_t> bytes) { end_ = decode<end_t>(bytes); }

void RunLog::flush() {
  sink_.flush();
  flushed_ = written;
  send_ack();
}

void RunLog::close() {
  if (closed_) return;
  begin(end_ ? end_->utime : 0);
  if (end_) {
    end_->check = 0;
    beginning_.add(Channel::End, encode(*end_));
    end_->check = beginning_.value();
    sink_.append(Channel::End, encode(*end_), end_->utime);
  }
  sink_.close();
  flushed_ = written;
  closed_ = true;
  send_ack();
}

void RunLog::send_ack() {
  ack_t ack{};
  ack.run = run_;
  ack.step = flushed_;
  ack.complete_to = flushed_;
  ack.utime = step_utime(std::max<int64_t>(flushed_, 0), setup_.dt);
  ack.process = kLogger;
  ack.closed = closed_;
  publish_(Channel::Ack, encode(ack));
}

}  // namespace lab
