// What programs write on stdout and stderr, and the frame around every main: output that cannot be written is never lost in
// silence and never an abort. tests/structure refuses other ways to write, and a main without this frame.
#pragma once
#include <fmt/format.h>

#include <functional>
#include <string>
#include <string_view>

namespace lab {

/// stdout cannot be written. Not a std::exception, so that no handler of other faults stops it on its way to run_program.
struct OutputError {
  int error = 0;  ///< an errno
};

/// Runs the work of a program and returns its exit code. What it throws becomes the line "PROGRAM: WHAT" and exit code 1.
/// If stdout or stderr could not be written (disk full, closed, /dev/full), 0 becomes 1, and stderr says so. A
/// broken pipe ends a program by SIGPIPE, as `cat`. If stdin, stdout or stderr are closed, no file of the work gets their
/// number.
int run_program(const std::string& program, const std::function<int()>& work);

/// Bytes for stdout, as they are: files that programs read. Throws OutputError.
void emit_bytes(std::string_view bytes);
/// Sends what emit has kept back. Throws OutputError.
void flush_output();
/// A message on stderr, with a line feed at its end; hidden characters but line feeds are made visible. Never throws: a message
/// that cannot be written does not end a process that drives a robot.
void say_text(std::string_view message);

/// Text for people, or JSON, on stdout; hidden characters but line feeds are made visible. Throws OutputError.
void emit_text(std::string_view text);
template <class... T>
void emit(fmt::format_string<T...> form, T&&... values) {
  emit_text(fmt::format(form, std::forward<T>(values)...));
}

/// A message on stderr: say("lab-spy: {}", reason).
template <class... T>
void say(fmt::format_string<T...> form, T&&... values) {
  say_text(fmt::format(form, std::forward<T>(values)...));
}

}  // namespace lab
