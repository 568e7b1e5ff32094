// The logger in the protocol, what lockstep and real time share: RUN, END, telemetry, deadlines.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "wire/protocol/log_policy.h"
#include "wire/protocol/run_log.h"

namespace lab {

struct LoggerConfig {
  int64_t every = 1;  ///< the log gets the steps that are multiples of this, and the last one
  Micros deadline = 10'000'000, ready_deadline = 10'000'000;
};

/// Waits for RUN, then writes by the LogPolicy of the run's clock until END or stop.
class LoggerRole : public Role {
 public:
  LoggerRole(LoggerConfig config, BeginRun begin, RunLog::MakeTypes types, LogSink& sink, Publish publish);
  LoggerRole(const LoggerRole&) = delete;
  LoggerRole& operator=(const LoggerRole&) = delete;

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void tick(Micros now) override;
  Micros wake() const override;
  Micros batch() const override { return 500; }  ///< much shorter than kWindow steps take
  /// Closes the log after its last complete step, if END has not come.
  void stop(Micros now) override;

  const Outcome& outcome() const override { return outcome_; }
  std::string state() const override;
  int64_t step() const override { return log_.written; }
  int64_t run() const override { return policy_ ? log_.run() : 0; }
  int64_t model_hash() const override { return log_.setup().model_hash; }
  int nq() const override { return log_.setup().nq; }
  int nv() const override { return log_.setup().nv; }
  int64_t late() const override { return policy_ ? policy_->late() : 0; }

 private:
  void on_run(std::span<const uint8_t> bytes);
  void on_end(std::span<const uint8_t> bytes, Micros now);
  void fail(int exit_code, const std::string& reason);

  LoggerConfig config_;
  BeginRun begin_;
  RunLog::MakeTypes types_;
  LogSink& sink_;
  Publish publish_;
  Outcome outcome_;

  RunLog log_{sink_, publish_};
  std::unique_ptr<LogPolicy> policy_;  ///< null until RUN
  static constexpr Micros kStopGrace = 1'000'000;
  Micros stop_deadline_ = 0;  ///< asked to stop while the end is being written: until then; 0 = not asked
  RetryTimer retry_timer_;    ///< for RUN
  Micros next_ack_ = 0;
  IdleTimer idle_timer_;
};

}  // namespace lab
