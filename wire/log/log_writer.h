// Writes LCM event logs that stock tools read. The file is called PATH.part until finish(): a half-written log never
// carries the final name.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

class LogWriter {
 public:
  /// Starts PATH.part anew; throws std::runtime_error with the path and the reason.
  explicit LogWriter(std::string path);
  /// Goes on with an existing PATH.part, cut to `offset`; the next event gets number `next_number`.
  LogWriter(std::string path, uint64_t offset, int64_t next_number);
  ~LogWriter();  ///< closes; what was not flushed is lost, PATH.part stays
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// Appends one event to memory; returns its bytes, valid until the next call.
  std::span<const uint8_t> add(int64_t utime, std::string_view channel, std::span<const uint8_t> data);
  /// Hands everything added so far to the kernel with write(2). On failure (disk full) the file is cut back
  /// to what the last good flush left, so flush at the end of whole steps; throws with the path and the
  /// reason.
  void flush();
  /// flush, fsync, rename to PATH, fsync of the folder. No add() afterwards.
  void finish();

  uint64_t bytes() const { return written_; }  ///< flushed
  uint64_t waiting() const { return buffer_.size(); }
  int64_t events() const { return next_number_; }
  const std::string& part_path() const { return part_; }

 private:
  void open(int flags);
  std::string path_, part_;
  int fd_ = -1;
  uint64_t written_ = 0;
  int64_t next_number_ = 0;
  std::vector<uint8_t> buffer_;
};

/// PATH.part
std::string part_name(const std::string& path);
/// Syncs PATH.part, which the caller has written, and renames it to PATH; throws with path and reason.
void publish_file(const std::string& path);

}  // namespace lab
