#include "core/util/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace lab {
namespace {

/// All bytes into the open file, or an errno.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n >= 0) {
      bytes.remove_prefix(static_cast<size_t>(n));
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

}  // namespace

void write_atomically(const std::string& path, const std::string& text) {
  const WriteOutcome outcome = write_and_rename(path, path + ".part", text, true);
  if (outcome.error == 0) return;
  throw std::runtime_error(path + ": cannot be " + (outcome.created ? "written" : "created") + " (" +
                           std::strerror(outcome.error) + ")");
}

std::string hidden_part(const std::string& path) {
  const std::filesystem::path target(path);
  return (target.parent_path() / ("." + target.filename().string() + ".part")).string();
}

WriteOutcome write_and_rename(const std::string& path, const std::string& part, std::string_view bytes,
                              bool sync) {
  const int fd = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) {
    const int error = errno;
    ::unlink(part.c_str());
    return {error, false};
  }
  int error = write_all(fd, bytes);
  if (error == 0 && sync && ::fsync(fd) != 0) error = errno;
  if (::close(fd) != 0 && error == 0) error = errno;
  if (error == 0 && std::rename(part.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) ::unlink(part.c_str());
  return {error, true};
}

}  // namespace lab
