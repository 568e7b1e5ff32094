// Which messages of a run the logger writes, and when: one policy per clock.
#pragma once
#include <limits>
#include <optional>

#include "wire/protocol/run_log.h"
#include "wire/protocol/step_record.h"

namespace lab {

class LogPolicy {
 public:
  virtual ~LogPolicy() = default;
  /// Takes a message of a step.
  virtual void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) = 0;
  /// END is known: RunLog::end.
  virtual void on_end(Micros now) = 0;
  virtual void tick(Micros) {}
  virtual Micros wake() const { return INT64_MAX; }
  int64_t late() const { return late_; }

 protected:
  int64_t late_ = 0;  ///< messages for steps already written
};

/// Writes a step when, and only when, its bytes have the digest that the simulator published for it: so the log holds
/// exactly what the simulator used.
class LockstepLogPolicy : public LogPolicy {
 public:
  /// Writes the steps that are multiples of `every`, and the last one.
  LockstepLogPolicy(RunLog& log, int64_t every, const RetryTimer& retry_timer, const Publish& publish)
      : log_(log), every_(every), publish_(publish), retry_timer_(retry_timer) {}

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void on_end(Micros now) override;
  void tick(Micros now) override;
  Micros wake() const override { return log_.closed() ? INT64_MAX : retry_timer_.due(); }

 private:
  void file(Channel channel, std::span<const uint8_t> bytes, Micros now);
  void write_matching_steps(Micros now);
  std::optional<int64_t> published_digest(int64_t step);
  void request(int64_t step) const;

  RunLog& log_;
  const int64_t every_;
  const Publish& publish_;
  RetryTimer retry_timer_;
  StepRing ring_{2 * kWindow};
  int64_t gap_at_ = kBeforeStart - 1;  ///< last step written when a gap was last noticed
};

/// Writes what arrives, in that order. The log has one clock: an event's time is that of the newest ROBOT_STATE, so that it
/// never goes back, and RUN and TYPE have that of the first.
class RealtimeLogPolicy : public LogPolicy {
 public:
  RealtimeLogPolicy(RunLog& log, int64_t every)
      : log_(log), every_(every), input_seq_(log.input_seq), utime_(log.state_utime.value_or(kNone)) {}

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void on_end(Micros) override;

 private:
  void set_time(int64_t utime);
  void write(Channel channel, std::span<const uint8_t> bytes);

  RunLog& log_;
  const int64_t every_;
  int64_t input_seq_;  ///< of the last INPUT written
  static constexpr int64_t kNone = std::numeric_limits<int64_t>::min();
  int64_t utime_ = kNone;                         ///< of the newest ROBOT_STATE
  std::vector<std::pair<Channel, Bytes>> early_;  ///< what came before the first, at most kWindow
};

}  // namespace lab
