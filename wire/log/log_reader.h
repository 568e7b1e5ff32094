// Reads LCM event logs, also damaged ones and ones that still grow.
// An event: 0xEDA1DA01, number (8), time in us (8), channel length (4), data length (4), channel, data; big endian.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

struct LogEvent {
  int64_t number = 0;
  int64_t utime = 0;
  std::string_view channel;        ///< valid until the next call
  std::span<const uint8_t> data;   ///< valid until the next call
  uint64_t offset = 0;             ///< of its first byte in the file
  std::span<const uint8_t> bytes;  ///< all of it as it is in the file; valid until the next call
};

class LogReader {
 public:
  /// Throws std::runtime_error with the path and the reason.
  explicit LogReader(const std::string& path);
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// The next whole event; false at the end of what is there now (ask again when the file may have grown).
  /// An event counts only when what follows proves its length: the next event or the end of the file. What
  /// does not fit is skipped up to the next event that does, and noted in skipped(). A bad event never ends
  /// the reading.
  bool next(LogEvent& event);

  struct Gap {
    uint64_t offset, bytes;
  };
  const std::vector<Gap>& skipped() const { return skipped_; }
  /// Offset behind the last event given: what a writer that resumes should cut to.
  uint64_t position() const { return position_; }
  /// Bytes behind position() when next() last returned false: an event that is cut off, or still being written.
  uint64_t tail() const { return tail_; }
  /// Goes on from that offset.
  void seek(uint64_t offset);

  static constexpr uint32_t kMaxData = 64 << 20;  ///< a longer claim is damage
  static constexpr uint32_t kMaxChannel = 255;    ///< more than kMaxChannelName: other writers may be laxer

 private:
  enum class Look { Good, Bad, Cut };
  Look look(uint64_t offset, LogEvent& event);
  Look header(uint64_t offset, bool magic_needed, uint32_t& channel_bytes, uint32_t& data_bytes);
  const uint8_t* bytes(uint64_t offset, uint64_t count);  // null when the file ends before
  bool chain_inside(uint64_t from);
  uint64_t find_magic(uint64_t from);

  std::string path_;
  int fd_ = -1;
  std::vector<uint8_t> buffer_;  // window of the file
  uint64_t start_ = 0;           // its offset
  size_t filled_ = 0;
  uint64_t position_ = 0, tail_ = 0;
  std::vector<Gap> skipped_;
};

}  // namespace lab
