#include "wire/log/log_reader.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "core/util/big_endian.h"

namespace lab {
namespace {

constexpr uint8_t kMagicBytes[4] = {0xED, 0xA1, 0xDA, 0x01};
constexpr uint64_t kHeader = 28;
constexpr size_t kReadAhead = 1 << 18;

bool is_magic(const uint8_t* p) { return std::memcmp(p, kMagicBytes, sizeof kMagicBytes) == 0; }

}  // namespace

LogReader::LogReader(const std::string& path) : path_(path) {
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd_ < 0) throw std::runtime_error(path + ": " + std::strerror(errno));
}

LogReader::~LogReader() { ::close(fd_); }

void LogReader::seek(uint64_t offset) {
  position_ = offset;
  tail_ = 0;
}

// A view of that part of the file; null when the file ends before. Valid until the next call.
const uint8_t* LogReader::bytes(uint64_t offset, uint64_t count) {
  if (offset >= start_ && offset + count <= start_ + filled_) return &buffer_[offset - start_];
  const uint64_t want = std::max<uint64_t>(count, kReadAhead);
  if (buffer_.size() < want) buffer_.resize(want);
  start_ = offset;
  filled_ = 0;
  while (filled_ < want) {
    const ssize_t n = ::pread(fd_, &buffer_[filled_], want - filled_, static_cast<off_t>(offset + filled_));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::runtime_error(path_ + ": reading: " + std::strerror(errno));
    if (n == 0) break;
    filled_ += static_cast<size_t>(n);
  }
  return count <= filled_ ? buffer_.data() : nullptr;
}

// Whether an event's header stands there, with lengths that can be. Cut: the file ends within it.
LogReader::Look LogReader::header(uint64_t offset, bool magic_needed, uint32_t& channel_bytes,
                                  uint32_t& data_bytes) {
  const uint8_t* p = bytes(offset, kHeader);
  if (!p) {
    const uint8_t* start = bytes(offset, sizeof kMagicBytes);
    return start && !is_magic(start) && magic_needed ? Look::Bad : Look::Cut;
  }
  channel_bytes = load_big_endian<uint32_t>(p + 20);
  data_bytes = load_big_endian<uint32_t>(p + 24);
  if (magic_needed && !is_magic(p)) return Look::Bad;
  if (channel_bytes == 0 || channel_bytes > kMaxChannel || data_bytes > kMaxData) return Look::Bad;
  return Look::Good;
}

// Good: a whole event whose length is proven by what follows. Cut: it may be one, but the file ends too
// early.
LogReader::Look LogReader::look(uint64_t offset, LogEvent& event) {
  uint32_t channel = 0, data = 0;
  if (const Look h = header(offset, true, channel, data); h != Look::Good) return h;
  const uint64_t end = offset + kHeader + channel + data;
  const uint8_t* p = bytes(offset, end - offset);
  if (!p) return chain_inside(offset + 1) ? Look::Bad : Look::Cut;
  const uint8_t* next = bytes(end, sizeof kMagicBytes);
  if (next && !is_magic(next)) {
    // Either this event's length is damaged, or only the next one's sync word is: then a header that leads on
    // to another event stands there all the same.
    uint32_t c = 0, d = 0;
    if (header(end, false, c, d) != Look::Good) return Look::Bad;
    const uint8_t* beyond = bytes(end + kHeader + c + d, sizeof kMagicBytes);
    if (!beyond || !is_magic(beyond)) return Look::Bad;
  }
  p = bytes(offset, end - offset);
  event.number = load_big_endian<int64_t>(p + 4);
  event.utime = load_big_endian<int64_t>(p + 12);
  event.channel = {reinterpret_cast<const char*>(p + kHeader), channel};
  event.data = {p + kHeader + channel, data};
  event.offset = offset;
  event.bytes = {p, static_cast<size_t>(end - offset)};
  return Look::Good;
}

// Whether an event that leads on to another stands at or after `from`: proof that something claims too much.
bool LogReader::chain_inside(uint64_t from) {
  for (uint64_t at = find_magic(from); at != UINT64_MAX; at = find_magic(at + 1)) {
    uint32_t channel = 0, data = 0;
    if (header(at, true, channel, data) != Look::Good) continue;
    const uint64_t end = at + kHeader + channel + data;
    if (!bytes(at, end - at)) continue;
    const uint8_t* next = bytes(end, sizeof kMagicBytes);
    if (!next || is_magic(next)) return true;
  }
  return false;
}

// Offset of the next sync word at or after `from`; UINT64_MAX if there is none.
uint64_t LogReader::find_magic(uint64_t from) {
  for (;;) {
    if (!bytes(from, sizeof kMagicBytes)) return UINT64_MAX;
    const uint8_t* begin = &buffer_[from - start_];
    const uint8_t* end = buffer_.data() + filled_;
    const uint8_t* at = std::search(begin, end, kMagicBytes, kMagicBytes + sizeof kMagicBytes);
    if (at != end) return start_ + static_cast<uint64_t>(at - buffer_.data());
    from = start_ + filled_ - (sizeof kMagicBytes - 1);
  }
}

bool LogReader::next(LogEvent& event) {
  uint64_t at = position_;
  for (;;) {
    const Look seen = look(at, event);
    if (seen == Look::Good) {
      if (at > position_) skipped_.push_back({position_, at - position_});
      position_ = at + event.bytes.size();
      tail_ = 0;
      return true;
    }
    const uint64_t next = find_magic(at + 1);
    if (seen == Look::Cut || next == UINT64_MAX) {
      // all that is left may be an event that is still being written
      uint64_t end = position_;
      while (bytes(end, 1)) end = start_ + filled_;
      tail_ = end - position_;
      return false;
    }
    at = next;
  }
}

}  // namespace lab
