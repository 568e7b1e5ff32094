#pragma once
#include <lab/end_t.hpp>
#include <lab/run_t.hpp>
#include <map>
#include <optional>
#include <string>

#include "wire/protocol/follower.h"
#include "wire/protocol/role.h"
#include "wire/protocol/step_record.h"

namespace lab {

/// Where the recorder puts what it keeps. The file behind it is the caller's.
class LogSink {
 public:
  virtual ~LogSink() = default;
  /// Opens the log of this run. Calls `visit` for each message of the whole steps that an earlier life of this
  /// process wrote for the same run, and drops what is beyond them. Throws with one clear line.
  virtual void open(int64_t run, const std::function<void(Channel, std::span<const uint8_t>)>& visit) = 0;
  /// Adds one event. utime is the event's time.
  virtual void append(Channel channel, std::span<const uint8_t> bytes, int64_t utime) = 0;
  /// Hands everything appended to the kernel. Throws with one clear line, such as on a full disk.
  virtual void flush() = 0;
  /// Syncs the log and gives it its final name.
  virtual void close() = 0;
  /// Adds a message of the wall clock to the telemetry.
  virtual void telemetry(Channel channel, std::span<const uint8_t> bytes) = 0;
};

struct LoggerConfig {
  int64_t every = 1;  ///< only steps that this divides, and the last, go into the log
  Micros deadline = 10'000'000, ready_deadline = 10'000'000;
};

/// The logger's side of lockstep: writes a step when, and only when, its bytes have the digest that the simulator
/// published for it; so the log is what the simulator used.
class LoggerRole : public Role {
 public:
  /// `begin` gives the sizes of the run; `types` are the encoded TYPE messages of a run, in the order of the log.
  LoggerRole(LoggerConfig config, BeginRun begin, std::function<std::vector<Bytes>(int64_t run)> types,
             LogSink& sink, Publish publish);

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void tick(Micros now) override;
  Micros wake() const override;
  Micros batch() const override { return 500; }  ///< far less than the window of credit lasts
  /// Closes with the whole steps there are, if END did not come first.
  void stop(Micros now) override;

  const Outcome& outcome() const override { return outcome_; }
  std::string state() const override;
  int64_t step() const override { return written_; }
  int64_t run() const override { return run_; }
  int64_t model_hash() const override { return setup_.model_hash; }
  int nq() const override { return setup_.nq; }
  int nv() const override { return setup_.nv; }

 private:
  void on_run(std::span<const uint8_t> bytes);
  void file(Channel channel, std::span<const uint8_t> bytes, Micros now);
  void write_matching_steps(Micros now);
  void write_as_it_comes(Channel channel, std::span<const uint8_t> bytes);
  std::optional<int64_t> digest_published_for(int64_t step);
  void flush();
  void send_ack();
  void finish();
  void fail(int exit_code, const std::string& reason);

  LoggerConfig config_;
  BeginRun begin_;
  std::function<std::vector<Bytes>(int64_t)> types_;
  LogSink& sink_;
  Publish publish_;
  Outcome outcome_;

  RunSetup setup_;
  int64_t run_ = 0;
  StepRing ring_{2 * kWindow};
  int64_t written_ = kBeforeStart;  ///< last step given to the sink
  int64_t flushed_ = kBeforeStart;  ///< last step that the kernel has
  int64_t highest_ = kBeforeStart;  ///< last step of which anything was seen
  int64_t gap_at_ = kBeforeStart - 1;
  int64_t input_seq_ = 0;  ///< real time: last INPUT written
  std::optional<end_t> end_;
  Bytes end_bytes_;
  bool closed_ = false;
  static constexpr Micros kStopGrace = 1'000'000;
  Micros stop_deadline_ = 0;  ///< asked to stop while the end is being written: until then; 0 = not asked
  RetryTimer retry_timer_;
  Micros next_ack_ = 0;
  IdleTimer idle_timer_;
};

}  // namespace lab
