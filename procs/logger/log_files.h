// log.lcm and telemetry.lcm in a run's folder.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "wire/log/event_hash.h"
#include "wire/log/log_writer.h"
#include "wire/protocol/logger_role.h"

namespace lab::logger {

/// Both files are NAME.part until they are whole; log.lcm gets its name in
/// close(), telemetry.lcm when this object ends.
///
/// With a quota each file is split at half of it: what was written becomes NAME.earlier.lcm, in place of the one
/// before, and the file begins anew (log.lcm with RUN and TYPE, at the time at which the one before ends, so that it is a log by itself). So the newest half at least
/// is kept, and the disk holds no more than the quota of each.
class LogFiles : public LogSink {
 public:
  /// quota: bytes, of log.lcm of runs in real time and of telemetry.lcm; 0 = none. Throws if the folder cannot be
  /// written or holds a finished log.
  explicit LogFiles(const std::string& run_dir, uint64_t quota = 0);
  ~LogFiles() override;

  /// Continues log.lcm.part if it is of the same run, cut back to its whole steps; else starts a new one.
  void open(int64_t run, LogKind kind,
            const std::function<void(Channel, std::span<const uint8_t>)>& visit) override;
  void append(Channel channel, std::span<const uint8_t> bytes, int64_t utime) override;
  void flush() override;
  void close() override;
  void telemetry(Channel channel, std::span<const uint8_t> bytes) override;

 private:
  struct Begin {
    Channel channel;
    std::vector<uint8_t> bytes;
  };
  void add_to_log(Channel channel, std::span<const uint8_t> bytes, int64_t utime);
  void add_check();

  const std::string log_path_, telemetry_path_;
  const uint64_t split_;      ///< bytes of a piece; 0 = never
  int64_t run_ = 0;           ///< of log.lcm
  LogKind kind_;              ///< of log.lcm
  int64_t utime_ = 0;         ///< of its last event
  EventHash unchecked_;       ///< the events that no CHECK covers yet
  std::vector<Begin> begin_;  ///< what each piece of log.lcm begins with: RUN and TYPE
  std::unique_ptr<LogWriter> log_, telemetry_;
};

}  // namespace lab::logger
