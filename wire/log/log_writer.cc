#include "wire/log/log_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "core/util/big_endian.h"
#include "wire/schema/channel_name.h"

namespace lab {
namespace {

constexpr uint32_t kMagic = 0xEDA1DA01;

[[noreturn]] void fail(const std::string& path, const char* what) {
  const std::string reason = std::strerror(errno);
  throw std::runtime_error(path + ": " + what + ": " + reason);
}

void sync_folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int fd = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);  // some file systems cannot; the rename itself has happened
  ::close(fd);
}

void rename_part(const std::string& path) {
  const std::string part = part_name(path);
  if (std::rename(part.c_str(), path.c_str()) < 0) fail(part, "renaming to its final name");
  sync_folder_of(path);
}

}  // namespace

std::string part_name(const std::string& path) { return path + ".part"; }

void publish_file(const std::string& path) {
  const std::string part = part_name(path);
  const int fd = ::open(part.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) fail(part, "opening");
  const int result = ::fsync(fd);
  const int reason = errno;
  ::close(fd);
  errno = reason;
  if (result < 0) fail(part, "syncing");
  rename_part(path);
}

LogWriter::LogWriter(std::string path) : path_(std::move(path)), part_(part_name(path_)) {
  open(O_CREAT | O_TRUNC);
}

LogWriter::LogWriter(std::string path, uint64_t offset, int64_t next_number)
    : path_(std::move(path)), part_(part_name(path_)), written_(offset), next_number_(next_number) {
  open(0);
  const off_t end = ::lseek(fd_, 0, SEEK_END);
  if (end < 0 || static_cast<uint64_t>(end) < offset) {
    ::close(fd_);
    throw std::runtime_error(part_ + ": has " + std::to_string(end) + " bytes, cannot go on at " +
                             std::to_string(offset));
  }
  if (::ftruncate(fd_, static_cast<off_t>(offset)) < 0) {
    ::close(fd_);
    fail(part_, "cutting");
  }
}

LogWriter::~LogWriter() {
  if (fd_ >= 0) ::close(fd_);
}

void LogWriter::open(int flags) {
  fd_ = ::open(part_.c_str(), O_WRONLY | O_CLOEXEC | O_APPEND | flags, 0644);
  if (fd_ < 0) fail(part_, "opening");
}

std::span<const uint8_t> LogWriter::add(int64_t utime, std::string_view channel,
                                        std::span<const uint8_t> data) {
  const size_t begin = buffer_.size();
  if (channel.empty() || channel.size() > kMaxChannelName)
    throw std::invalid_argument(part_ + ": channel name must have 1 to " + std::to_string(kMaxChannelName) +
                                " bytes");
  append_big_endian(buffer_, kMagic);
  append_big_endian(buffer_, next_number_++);
  append_big_endian(buffer_, utime);
  append_big_endian(buffer_, static_cast<uint32_t>(channel.size()));
  append_big_endian(buffer_, static_cast<uint32_t>(data.size()));
  buffer_.insert(buffer_.end(), channel.begin(), channel.end());
  buffer_.insert(buffer_.end(), data.begin(), data.end());
  return std::span(buffer_).subspan(begin);
}

void LogWriter::flush() {
  if (fd_ < 0) throw std::logic_error(part_ + ": is finished");
  size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t n = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int reason = errno;
      // a torn event would be damage; what was whole before stays
      const int cut = ::ftruncate(fd_, static_cast<off_t>(written_));
      errno = reason;
      fail(part_, cut == 0 ? "writing" : "writing (and the torn end could not be cut off)");
    }
    done += static_cast<size_t>(n);
  }
  written_ += buffer_.size();
  buffer_.clear();
}

void LogWriter::finish() {
  flush();
  if (::fsync(fd_) < 0) fail(part_, "syncing");
  const int fd = fd_;
  fd_ = -1;
  if (::close(fd) < 0) fail(part_, "closing");
  rename_part(path_);
}

}  // namespace lab
