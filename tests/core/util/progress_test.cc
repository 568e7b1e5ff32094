#include "core/util/progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>

namespace lab {
namespace {

// What a job writes when stderr is a terminal: the other end of a pseudo terminal.
template <class Job>
std::string on_a_terminal(Job job) {
  const int screen = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  EXPECT_TRUE(screen >= 0 && grantpt(screen) == 0 && unlockpt(screen) == 0);
  const int terminal = open(ptsname(screen), O_RDWR | O_NOCTTY);
  termios raw{};
  tcgetattr(terminal, &raw);
  cfmakeraw(&raw);
  tcsetattr(terminal, TCSANOW, &raw);
  std::fflush(stderr);
  const int kept = dup(STDERR_FILENO);
  dup2(terminal, STDERR_FILENO);
  job();
  std::fflush(stderr);
  dup2(kept, STDERR_FILENO);
  close(kept);
  std::string text;
  char block[256];
  for (ssize_t n; (n = read(screen, block, sizeof block)) > 0;) text.append(block, static_cast<size_t>(n));
  close(terminal);
  close(screen);
  return text;
}

TEST(Progress, IsABarOnATerminal) {
  const std::string bar = on_a_terminal([] {
    Progress progress(20, {.label = "parts ", .keep = true});
    progress.show(5);
    progress.show(6);  // too soon for another
    progress.show(20);
    EXPECT_TRUE(progress.on_terminal());
  });
  EXPECT_EQ(bar,
            "\r\x1b[Kparts [#######.......................] 5 of 20"
            "\r\x1b[Kparts [##############################] 20 of 20\n");
}

TEST(Progress, IsErasedUnlessKept) {
  EXPECT_EQ(on_a_terminal([] { Progress(3, {}).show(3); }),
            "\r\x1b[K[##############################] 3 of 3\r\x1b[K");
}

TEST(Progress, TellsTheTimeLeftFromWhatWasDoneNow) {
  const std::string bar = on_a_terminal([] {
    Progress progress(3, {.keep = true});
    usleep(200'000);
    progress.show(2, 1);  // one part in 0.2 s, one is left
  });
  EXPECT_NE(bar.find("] 2 of 3, 0 s left\n"), std::string::npos) << bar;
}

TEST(Progress, ShortAndQuietJobsShowNothing) {
  EXPECT_EQ(on_a_terminal([] { Progress(10, {.shown_above = 10}).show(10); }), "");
  EXPECT_EQ(on_a_terminal([] { Progress(10, {.quiet = true}).show(10); }), "");
}

TEST(Progress, NoBarWhereThereIsNoTerminal) {
  testing::internal::CaptureStderr();
  {
    Progress progress(20, {.label = "parts ", .line_name = "job"});
    progress.show(20);
    EXPECT_FALSE(progress.on_terminal());
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");  // the first line comes after ten seconds
}

}  // namespace
}  // namespace lab
