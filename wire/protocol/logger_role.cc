#include "wire/protocol/logger_role.h"

#include <fmt/format.h>

#include <algorithm>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>

#include "wire/schema/codec.h"

namespace lab {
namespace {

/// What shows that the run goes on. Planner, controller and this process itself speak for as long as they are there.
bool is_from_simulator(Channel channel, std::span<const uint8_t> bytes) {
  if (channel == Channel::Process) return decode<process_t>(bytes).name == kSimulator;
  return row(channel).publisher == Publisher::Simulator;
}

}  // namespace

LoggerRole::LoggerRole(LoggerConfig config, BeginRun begin, RunLog::MakeTypes types, LogSink& sink,
                       Publish publish)
    : config_(config),
      begin_(std::move(begin)),
      types_(std::move(types)),
      sink_(sink),
      publish_(std::move(publish)) {}

std::string LoggerRole::state() const {
  if (outcome_.exit_code != kOk) return "FAULT";
  if (!policy_) return "STARTING";
  if (log_.closed()) return "STOPPING";
  return log_.written < 0 ? "READY" : "RUNNING";
}

void LoggerRole::fail(int exit_code, const std::string& reason) {
  if (!outcome_.ended) outcome_ = {true, exit_code, reason};
}

void LoggerRole::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) try {
  if (outcome_.ended) return;
  if (policy_ && is_from_simulator(channel, bytes)) idle_timer_.reset();
  if (channel == Channel::Run) {
    if (!policy_) on_run(bytes);
  } else if (channel == Channel::End) {
    on_end(bytes, now);
  } else if (row(channel).log_file == LogFile::Telemetry) {
    // RUN may have come before the simulator's address was known
    if (channel == Channel::Process && !policy_) retry_timer_.trigger(now);
    sink_.telemetry(channel, bytes);
  } else if (row(channel).log_file == LogFile::Log && channel != Channel::Type) {  // TYPE is written with RUN
    if (policy_ && !log_.closed()) policy_->receive(channel, bytes, now);
  }
} catch (const std::exception& error) {
  fail(kDied, error.what());
}

void LoggerRole::on_end(std::span<const uint8_t> bytes, Micros now) {
  if (!policy_) return;
  if (!log_.end()) {
    log_.set_end(bytes);
    policy_->on_end(now);
  } else if (log_.closed()) {
    log_.send_ack();
  }
}

void LoggerRole::on_run(std::span<const uint8_t> bytes) {
  const auto message = decode<run_t>(bytes);
  RunSetup setup;
  try {
    setup = begin_(message);
  } catch (const std::exception& error) {
    return fail(kBadConfig, error.what());
  }
  const bool resumed = log_.open(bytes, message, setup, config_.every == 1, types_);
  if (resumed && config_.every != 1 && !setup.realtime)
    return fail(kBadConfig, "cannot go on with a log of which only some steps were written");
  if (setup.realtime)
    policy_ = std::make_unique<RealtimeLogPolicy>(log_, config_.every);
  else
    policy_ = std::make_unique<LockstepLogPolicy>(log_, config_.every, retry_timer_, publish_);
  idle_timer_.reset();
  log_.send_ack();
}

void LoggerRole::tick(Micros now) try {
  if (outcome_.ended) return;
  idle_timer_.update(now);
  if (stop_deadline_ != 0 && (log_.closed() || now >= stop_deadline_)) return stop(now);
  if (now >= next_ack_) {
    next_ack_ = now + kRepeat;
    if (policy_ && !log_.closed()) log_.flush();
  }
  if (policy_) {
    policy_->tick(now);
  } else if (retry_timer_.expired(now)) {
    need_t need{};
    need.step = kBeforeStart;
    need.process = kSimulator;
    need.sender = kLogger;
    publish_(Channel::Need, encode(need));
  }
  if (!policy_ && idle_timer_.elapsed() > config_.ready_deadline) {
    fail(kNotReady, fmt::format("no RUN from the simulator in {:g} s", config_.ready_deadline * 1e-6));
  } else if (policy_ && idle_timer_.elapsed() > config_.deadline) {
    if (!log_.closed())
      fail(kTransport, fmt::format("nothing from the simulator in {:g} s after step {}",
                                   config_.deadline * 1e-6, log_.written));
    stop(now);
  }
} catch (const std::exception& error) {
  fail(kDied, error.what());
}

Micros LoggerRole::wake() const {
  return std::min(policy_ ? policy_->wake() : retry_timer_.due(), next_ack_);
}

void LoggerRole::stop(Micros now) try {
  // after END its last steps may still arrive
  if (log_.end() && !log_.closed() && stop_deadline_ == 0) {
    stop_deadline_ = now + kStopGrace;
    return;
  }
  if (policy_) log_.close();
  outcome_.ended = true;
} catch (const std::exception& error) {
  fail(kDied, error.what());
}

}  // namespace lab
