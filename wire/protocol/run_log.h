// The log of one run as the logger writes it, whatever the clock: RUN and TYPE first, END last, ACK for what is written.
#pragma once
#include <lab/end_t.hpp>
#include <lab/run_t.hpp>
#include <optional>
#include <vector>

#include "wire/protocol/follower.h"
#include "wire/protocol/log_hash.h"
#include "wire/protocol/role.h"

namespace lab {

struct LogKind {
  bool may_split = false;  ///< may be limited to its newest steps (in lockstep it is whole, or no log)
  bool checks = false;     ///< gets CHECK events: the digests in ROBOT_STATE do not prove its steps
};

/// The output of the logger. The caller owns the file.
class LogSink {
 public:
  virtual ~LogSink() = default;
  /// Opens the log of this run. If the process was restarted: calls `visit` for each message of the whole steps that
  /// are already in the log of the same run, and truncates the rest. Throws with one line.
  virtual void open(int64_t run, LogKind kind,
                    const std::function<void(Channel, std::span<const uint8_t>)>& visit) = 0;
  /// Adds one event. utime is the event's time.
  virtual void append(Channel channel, std::span<const uint8_t> bytes, int64_t utime) = 0;
  /// Hands everything appended to the kernel. Throws with one line, such as on a full disk.
  virtual void flush() = 0;
  /// Syncs the log and gives it its final name.
  virtual void close() = 0;
  /// Adds a message of the wall clock to the telemetry.
  virtual void telemetry(Channel channel, std::span<const uint8_t> bytes) = 0;
};

class RunLog {
 public:
  RunLog(LogSink& sink, const Publish& publish) : sink_(sink), publish_(publish) {}

  /// The encoded TYPE messages of a run, in the order of the log.
  using MakeTypes = std::function<std::vector<Bytes>(int64_t run)>;
  /// Opens the log, or continues what an earlier process wrote of the same run: then true. In lockstep it begins with
  /// RUN and TYPE at once, in real time with begin(). every_step: no step is left out.
  bool open(std::span<const uint8_t> run_bytes, const run_t& run, const RunSetup& setup, bool every_step,
            const MakeTypes& types);
  /// Writes RUN and TYPE with that time, unless they are there.
  void begin(int64_t utime);
  void append(Channel channel, std::span<const uint8_t> bytes, int64_t utime) {
    sink_.append(channel, bytes, utime);
  }
  void set_end(std::span<const uint8_t> bytes);
  /// Hands what was appended to the kernel, and acknowledges it.
  void flush();
  /// Writes END if it is known, and closes the log.
  void close();
  void send_ack();

  int64_t run() const { return run_; }
  const RunSetup& setup() const { return setup_; }
  const std::optional<end_t>& end() const { return end_; }
  bool closed() const { return closed_; }
  int64_t flushed() const { return flushed_; }

  int64_t written = kBeforeStart;      ///< last step appended
  int64_t input_seq = 0;               ///< of the last INPUT when the log was opened
  std::optional<int64_t> state_utime;  ///< of the last ROBOT_STATE when the log was opened

 private:
  LogSink& sink_;
  const Publish& publish_;
  RunSetup setup_;
  int64_t run_ = 0;
  int64_t flushed_ = kBeforeStart;  ///< last step that the kernel has
  std::optional<end_t> end_;
  std::vector<std::pair<Channel, Bytes>> to_begin_;  ///< RUN and TYPE, until they are written
  LogHash beginning_;                                ///< RUN and TYPE, as written
  bool closed_ = false;
};

}  // namespace lab
