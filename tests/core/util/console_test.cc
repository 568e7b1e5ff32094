#include "core/util/console.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iostream>
#include <stdexcept>

#include "core/util/exit_code.h"

namespace lab {
namespace {

enum class Stream { Kept, Full, Closed, Pipe };

/// What fd becomes, in the child.
void become(int fd, Stream stream) {
  int ends[2];
  switch (stream) {
    case Stream::Kept:
      return;
    case Stream::Full:
      dup2(open("/dev/full", O_WRONLY), fd);
      return;
    case Stream::Closed:
      close(fd);
      return;
    case Stream::Pipe:
      if (pipe(ends) == 0) {
        close(ends[0]);
        dup2(ends[1], fd);
      }
  }
}

struct End {
  int code = -1;  ///< 128 + n for signal n, as a shell says it
  std::string said;
};

/// A program with these streams; `said` is what it wrote on stderr, if that is kept.
End run(Stream out, Stream err, const std::function<int()>& work) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDERR_FILENO);
    const int quiet = open("/dev/null", O_WRONLY);
    dup2(quiet, STDOUT_FILENO);
    for (int fd = 3; fd < 20; ++fd) close(fd);
    become(STDERR_FILENO, err);
    become(STDOUT_FILENO, out);
    _exit(run_program("lab-x", work));
  }
  close(ends[1]);
  End end;
  char text[4096];
  for (ssize_t n = 0; (n = read(ends[0], text, sizeof text)) > 0;)
    end.said.append(text, static_cast<size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  end.code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return end;
}

int prints() {
  emit("{} rows\n", 3);
  return kOk;
}

TEST(RunProgram, OutputThatCannotBeWrittenIsSaidAndFails) {
  EXPECT_EQ(run(Stream::Kept, Stream::Kept, prints).code, kOk);
  const End full = run(Stream::Full, Stream::Kept, prints);
  EXPECT_EQ(full.code, kCheckFailed);
  EXPECT_EQ(full.said, "lab-x: cannot write to standard output (No space left on device)\n");
  const End closed = run(Stream::Closed, Stream::Kept, prints);
  EXPECT_EQ(closed.code, kCheckFailed);
  EXPECT_EQ(closed.said, "lab-x: cannot write to standard output (Bad file descriptor)\n");
  EXPECT_EQ(run(Stream::Pipe, Stream::Kept, prints).code, 128 + SIGPIPE);
  EXPECT_EQ(run(Stream::Full, Stream::Full, prints).code, kCheckFailed);
  EXPECT_EQ(run(Stream::Closed, Stream::Closed, prints).code, kCheckFailed);
}

TEST(RunProgram, EndsAtTheFirstRowThatIsLost) {
  EXPECT_EQ(run(Stream::Full, Stream::Kept,
                [] {
                  for (int i = 0; i < 100; ++i) {
                    emit("row {}\n", i);
                    flush_output();
                    if (i > 0) return int{kUsage};
                  }
                  return int{kOk};
                })
                .code,
            kCheckFailed);
}

TEST(RunProgram, SeesWhatLibrariesPrint) {
  EXPECT_EQ(run(Stream::Full, Stream::Kept,
                [] {
                  std::cout << "help\n";
                  return int{kOk};
                })
                .code,
            kCheckFailed);
  EXPECT_EQ(run(Stream::Kept, Stream::Full,
                [] {
                  std::cerr << "warning\n";
                  return int{kOk};
                })
                .code,
            kCheckFailed);
}

TEST(RunProgram, KeepsTheCodeOfAnotherFailure) {
  EXPECT_EQ(run(Stream::Full, Stream::Kept,
                [] {
                  emit("table\n");
                  return int{kBadConfig};
                })
                .code,
            kBadConfig);
  EXPECT_EQ(run(Stream::Kept, Stream::Full,
                [] {
                  say("lab-x: bad");
                  return int{kBadConfig};
                })
                .code,
            kBadConfig);
}

TEST(RunProgram, ALostMessageEndsNothingButIsNoSuccess) {
  for (const Stream stream : {Stream::Full, Stream::Closed})
    EXPECT_EQ(run(Stream::Kept, stream,
                  [] {
                    say("lab-x: warning");
                    say("lab-x: warning");
                    return int{kOk};
                  })
                  .code,
              kCheckFailed);
}

TEST(RunProgram, WhatIsThrownBecomesOneLine) {
  const End end =
      run(Stream::Kept, Stream::Kept, []() -> int { throw std::runtime_error("link 'Ger\xe4t\x1b': no"); });
  EXPECT_EQ(end.code, kCheckFailed);
  EXPECT_EQ(end.said, "lab-x: link 'Ger\\xe4t\\u001b': no\n");
  EXPECT_EQ(run(Stream::Kept, Stream::Full, []() -> int { throw std::runtime_error("no"); }).code,
            kCheckFailed);
}

// A file that is opened while stdout is closed would get its number, and everything that is printed.
TEST(RunProgram, NoFileGetsTheNumberOfAClosedStream) {
  const std::string path = testing::TempDir() + "console_test." + std::to_string(getpid());
  EXPECT_EQ(run(Stream::Closed, Stream::Closed,
                [&] {
                  const int fd = open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
                  return fd > STDERR_FILENO ? int{kBadConfig} : int{kOk};
                })
                .code,
            kBadConfig);
  unlink(path.c_str());
}

TEST(Emit, ShowsHiddenCharacters) {
  testing::internal::CaptureStdout();
  emit("{}\n{}\n", "Ger\xe4t", "\x1b[2J");
  flush_output();
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "Ger\\xe4t\n\\u001b[2J\n");
}

}  // namespace
}  // namespace lab
