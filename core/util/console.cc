#include "core/util/console.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>

#include "core/util/exit_code.h"
#include "core/util/printable.h"

namespace lab {
namespace {

/// A closed descriptor would be given to the next file that is opened, and messages would be written into that. In its place
/// comes one that cannot be used either.
void hold_closed_descriptors() {
  constexpr std::array kUnusable = {O_WRONLY, O_RDONLY, O_RDONLY};
  for (int fd = 0; fd < 3; ++fd)
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", kUnusable[static_cast<size_t>(fd)]) < 0) return;
}

int run_guarded(const std::string& program, const std::function<int()>& work) {
  int code = kCheckFailed;
  try {
    code = work();
    flush_output();
    return code;
  } catch (const OutputError& failure) {
    say("{}: cannot write to standard output ({})", program, std::strerror(failure.error));
  } catch (const std::exception& error) {
    say("{}: {}", program, error.what());
  }
  return code == kOk ? int{kCheckFailed} : code;
}

}  // namespace

int run_program(const std::string& program, const std::function<int()>& work) {
  hold_closed_descriptors();
  const int code = run_guarded(program, work);
  return code == kOk && std::ferror(stderr) ? int{kCheckFailed} : code;
}

void emit_bytes(std::string_view bytes) {
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size()) throw OutputError{errno};
}

void emit_text(std::string_view text) { emit_bytes(printable_lines(text)); }

void flush_output() {
  errno = 0;
  if (std::fflush(stdout) != 0 || std::ferror(stdout)) throw OutputError{errno ? errno : EIO};
}

void say_text(std::string_view message) {
  const std::string whole = printable_lines(message) + "\n";
  std::fwrite(whole.data(), 1, whole.size(), stderr);
}

}  // namespace lab
