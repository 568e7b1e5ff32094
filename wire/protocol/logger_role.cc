#include "wire/protocol/logger_role.h"

#include <fmt/format.h>

#include <lab/ack_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {

LoggerRole::LoggerRole(LoggerConfig config, BeginRun begin, std::function<std::vector<Bytes>(int64_t)> types,
                       LogSink& sink, Publish publish)
    : config_(std::move(config)),
      begin_(std::move(begin)),
      types_(std::move(types)),
      sink_(sink),
      publish_(std::move(publish)) {}

std::string LoggerRole::state() const {
  if (outcome_.exit_code != kOk) return "FAULT";
  if (run_ == 0) return "STARTING";
  if (closed_) return "STOPPING";
  return written_ < 0 ? "READY" : "RUNNING";
}

void LoggerRole::fail(int exit_code, const std::string& reason) {
  if (!outcome_.ended) outcome_ = {true, exit_code, reason};
}

void LoggerRole::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) try {
  if (outcome_.ended) return;
  idle_timer_.reset();
  switch (channel) {
    case Channel::Run:
      if (run_ == 0) on_run(bytes);
      break;
    case Channel::Process:
    case Channel::Frame:
      sink_.telemetry(channel, bytes);
      break;
    case Channel::RobotState:
    case Channel::Reference:
    case Channel::Command:
    case Channel::Input:
    case Channel::Event:
      if (run_ == 0 || closed_) break;
      if (setup_.realtime) return write_as_it_comes(channel, bytes);
      file(channel, bytes, now);
      write_matching_steps(now);
      break;
    case Channel::End:
      if (run_ == 0) break;
      if (!end_) {
        end_ = decode<end_t>(bytes);
        end_bytes_.assign(bytes.begin(), bytes.end());
        if (setup_.realtime) return finish();
        retry_timer_.trigger(now);
        write_matching_steps(now);
      } else if (closed_) {
        send_ack();
      }
      break;
    default:
      break;
  }
} catch (const std::exception& error) {
  fail(kDied, error.what());
}

void LoggerRole::on_run(std::span<const uint8_t> bytes) {
  const auto message = decode<run_t>(bytes);
  try {
    setup_ = begin_(message);
  } catch (const std::exception& error) {
    return fail(kBadConfig, error.what());
  }
  bool begun = false;
  sink_.open(message.run, [&](Channel channel, std::span<const uint8_t> logged) {
    begun = true;
    if (channel == Channel::RobotState) written_ = highest_ = peek_step(logged);
    if (channel == Channel::Input) input_seq_ = decode<input_t>(logged).input_seq;
  });
  if (!begun) {
    sink_.append(Channel::Run, bytes, message.utime);
    for (const Bytes& type : types_(message.run)) sink_.append(Channel::Type, type, 0);
    sink_.flush();
  }
  if (begun && config_.every != 1)
    return fail(kBadConfig, "cannot go on with a log of which only some steps were written");
  flushed_ = written_;
  run_ = message.run;
  send_ack();
}

/// Real time: the log is what the logger heard, in that order.
void LoggerRole::write_as_it_comes(Channel channel, std::span<const uint8_t> bytes) {
  if (channel == Channel::Input) {
    const int64_t seq = decode<input_t>(bytes).input_seq;
    if (seq <= input_seq_) return;  // sent again for somebody else
    input_seq_ = seq;
  }
  const int64_t step = peek_step(bytes);
  if (step % config_.every == 0 || channel == Channel::Input || channel == Channel::Event)
    sink_.append(channel, bytes, peek_utime(bytes));
  if (channel == Channel::RobotState) written_ = std::max(written_, step);
}

void LoggerRole::file(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  const int64_t step = peek_step(bytes);
  if (step <= written_ || step > written_ + ring_.size()) {
    late_ += step <= written_;
    return;
  }
  ring_.at(step).file(channel, bytes, true);
  highest_ = std::max(highest_, step);
  const bool gap = channel == Channel::RobotState && step > written_ + 2 && gap_at_ != written_;
  if (gap) {
    gap_at_ = written_;
    retry_timer_.trigger(now);
  }
}

/// STATE k+1 carries the digest of step k, END that of the last.
std::optional<int64_t> LoggerRole::digest_published_for(int64_t step) {
  if (end_ && end_->step == step) return end_->digest;
  const StepRecord* next = ring_.find(step + 1);
  if (!next || next->state.empty()) return std::nullopt;
  return peek_digest(next->state);
}

void LoggerRole::write_matching_steps(Micros now) {
  for (;;) {
    const int64_t step = written_ + 1;
    if (end_ && step > end_->step) return finish();
    StepRecord* record = ring_.find(step);
    if (!record || !record->complete(step % setup_.every == 0)) break;
    const auto wanted = digest_published_for(step);
    if (!wanted) break;
    record->trim();
    if (record->digest() != *wanted) break;
    if (step % config_.every == 0 || (end_ && end_->step == step))
      record->in_order([&](Channel channel, const Bytes& bytes) {
        sink_.append(channel, bytes, step_utime(step, setup_.dt));
      });
    written_ = step;
    retry_timer_.reset(now);
    if (written_ - flushed_ >= kWindow / 4) flush();
  }
  if (end_ && end_->aborted && end_->digest == 0 && written_ + 1 >= end_->step) finish();
}

void LoggerRole::flush() {
  sink_.flush();
  flushed_ = written_;
  send_ack();
}

void LoggerRole::send_ack() {
  ack_t ack{};
  ack.run = run_;
  ack.step = ack.complete_to = flushed_;
  ack.utime = step_utime(std::max<int64_t>(flushed_, 0), setup_.dt);
  ack.process = kLogger;
  ack.closed = closed_;
  publish_(Channel::Ack, encode(ack));
}

/// Writes END if it is known, and closes the log.
void LoggerRole::finish() {
  if (closed_) return;
  if (end_) sink_.append(Channel::End, end_bytes_, end_->utime);
  sink_.close();
  flushed_ = written_;
  closed_ = true;
  send_ack();
}

void LoggerRole::tick(Micros now) try {
  if (outcome_.ended) return;
  idle_timer_.update(now);
  if (stop_deadline_ != 0 && (closed_ || now >= stop_deadline_)) return stop(now);
  if (now >= next_ack_) {
    next_ack_ = now + kRepeat;
    if (run_ != 0 && !closed_) flush();
  }
  if (retry_timer_.expired(now) && !closed_ && !(run_ != 0 && setup_.realtime)) {
    const int64_t missing = run_ == 0 ? kBeforeStart : written_ + 1;
    const auto ask = [&](int64_t step) {
      need_t need{};
      need.run = run_;
      need.step = step;
      need.process = kSimulator;
      need.sender = kLogger;
      publish_(Channel::Need, encode(need));
    };
    ask(missing);
    if (run_ != 0 && !digest_published_for(missing)) ask(missing + 1);
  }
  if (run_ == 0 && idle_timer_.elapsed() > config_.ready_deadline)
    fail(kNotReady, fmt::format("no RUN from the simulator in {:g} s", config_.ready_deadline * 1e-6));
  else if (run_ != 0 && idle_timer_.elapsed() > config_.deadline) {
    if (!closed_)
      fail(kTransport,
           fmt::format("nothing heard in {:g} s after step {}", config_.deadline * 1e-6, written_));
    stop(now);
  }
} catch (const std::exception& error) {
  fail(kDied, error.what());
}

Micros LoggerRole::wake() const {
  return closed_ || (run_ != 0 && setup_.realtime) ? next_ack_ : std::min(retry_timer_.due(), next_ack_);
}

void LoggerRole::stop(Micros now) try {
  if (end_ && !closed_ &&
      stop_deadline_ == 0) {  // the end has been said: what is missing of it may still come
    stop_deadline_ = now + kStopGrace;
    return;
  }
  if (run_ != 0) finish();
  outcome_.ended = true;
} catch (const std::exception& error) {
  fail(kDied, error.what());
}

}  // namespace lab
