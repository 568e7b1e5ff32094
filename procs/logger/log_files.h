// log.lcm and telemetry.lcm in a run's folder.
#pragma once
#include <memory>
#include <string>

#include "wire/log/log_writer.h"
#include "wire/protocol/logger_role.h"

namespace lab::logger {

/// Both files are NAME.part until they are whole; log.lcm gets its name in
/// close(), telemetry.lcm when this object ends.
class LogFiles : public LogSink {
 public:
  /// Throws if the folder cannot be written or holds a finished log.
  explicit LogFiles(const std::string& run_dir);
  ~LogFiles() override;

  /// Continues log.lcm.part if it is of the same run, cut back to its whole steps; else starts a new one.
  void open(int64_t run, const std::function<void(Channel, std::span<const uint8_t>)>& visit) override;
  void append(Channel channel, std::span<const uint8_t> bytes, int64_t utime) override;
  void flush() override;
  void close() override;
  void telemetry(Channel channel, std::span<const uint8_t> bytes) override;

 private:
  const std::string log_path_;
  std::unique_ptr<LogWriter> log_, telemetry_;
};

}  // namespace lab::logger
