#include "core/util/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace lab {

void write_atomically(const std::string& path, const std::string& text) {
  const std::string part = path + ".part";
  const auto refuse = [&](const char* what) {
    const std::string why = std::strerror(errno);
    unlink(part.c_str());
    throw std::runtime_error(path + ": cannot be " + what + " (" + why + ")");
  };
  const int fd = open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) refuse("created");
  for (size_t done = 0; done < text.size();) {
    const ssize_t n = write(fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int reason = errno;
      close(fd);
      errno = reason;
      refuse("written");
    }
    done += static_cast<size_t>(n);
  }
  if (fsync(fd) != 0 || close(fd) != 0 || rename(part.c_str(), path.c_str()) != 0) refuse("written");
}

}  // namespace lab
