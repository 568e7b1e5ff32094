// The files of the logger: a restarted one goes on where the one before ended, and nothing that is whole is lost.
#include "procs/logger/log_files.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <lab/type_t.hpp>

#include "wire/log/log_reader.h"
#include "wire/log/log_writer.h"
#include "wire/schema/codec.h"

namespace lab::logger {
namespace {

namespace fs = std::filesystem;

std::vector<uint8_t> state(int64_t run, int64_t step) {
  robot_state_t message{};
  message.run = run;
  message.step = step;
  return encode(message);
}

/// RUN or TYPE
template <class Message>
std::vector<uint8_t> beginning(int64_t run) {
  Message message{};
  message.run = run;
  message.step = -1;
  return encode(message);
}

class LogFilesTest : public testing::Test {
 protected:
  LogFilesTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~LogFilesTest() override { fs::remove_all(folder_); }

  /// A logger that does this and is killed: nothing is closed, no destructor runs.
  static void killed(const std::function<void()>& work) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      work();
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
  }
  void die_after(int64_t run, int64_t first, int64_t last) const {
    killed([&] {
      LogFiles files(folder_);
      files.open(run, {.may_split = true}, [](Channel, std::span<const uint8_t>) {});
      for (int64_t step = first; step <= last; ++step)
        files.append(Channel::RobotState, state(run, step), step);
      files.flush();
      _exit(0);
    });
  }
  /// The steps that a new logger finds of this run.
  std::vector<int64_t> steps_of(int64_t run) {
    LogFiles files(folder_);
    std::vector<int64_t> steps;
    files.open(run, {.may_split = true}, [&](Channel, std::span<const uint8_t> bytes) {
      steps.push_back(decode<robot_state_t>(bytes).step);
    });
    return steps;
  }
  const std::string folder_ = testing::TempDir() + "log_files_" + std::to_string(getpid());
};

TEST_F(LogFilesTest, AFinishedLogIsNeverOverwritten) {
  std::ofstream(folder_ + "/log.lcm") << "a finished log";
  EXPECT_THROW(LogFiles files(folder_), std::runtime_error);
  std::ifstream in(folder_ + "/log.lcm");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "a finished log");
}

// the last step may be cut off: only what follows a step proves it whole
TEST_F(LogFilesTest, ALogOfTheSameRunGoesOnAfterItsWholeSteps) {
  die_after(7, 0, 5);
  EXPECT_EQ(steps_of(7), (std::vector<int64_t>{0, 1, 2, 3, 4}));
}

TEST_F(LogFilesTest, ALogOfAnotherRunIsNotContinued) {
  die_after(7, 0, 5);
  EXPECT_TRUE(steps_of(8).empty());
  EXPECT_EQ(fs::file_size(folder_ + "/log.lcm.part"), 0u) << "the new run begins with an empty log";
}

TEST_F(LogFilesTest, TelemetryGoesOnAfterAKillAndAfterAnEnd) {
  killed([&] {
    LogFiles files(folder_);
    files.telemetry(Channel::RobotState, std::vector<uint8_t>(5000, 1));  // enough to be written at once
    _exit(0);
  });
  for (uint8_t byte : {2, 3})
    LogFiles(folder_).telemetry(Channel::RobotState, std::vector<uint8_t>(10, byte));
  LogReader reader(folder_ + "/telemetry.lcm");
  std::vector<uint8_t> seen;
  std::vector<int64_t> numbers;
  for (LogEvent event; reader.next(event);) {
    seen.push_back(event.data[0]);
    numbers.push_back(event.number);
  }
  EXPECT_EQ(seen, (std::vector<uint8_t>{1, 2, 3}));
  EXPECT_EQ(numbers, (std::vector<int64_t>{0, 1, 2}));
}

/// The events of a log, as CHANNEL or, of a state, its step.
std::vector<std::string> events_of(const std::string& path) {
  std::vector<std::string> out;
  LogReader reader(path);
  for (LogEvent event; reader.next(event);)
    out.push_back(event.channel == "ROBOT_STATE" ? std::to_string(decode<robot_state_t>(event.data).step)
                                                 : std::string(event.channel));
  return out;
}

TEST_F(LogFilesTest, WithAQuotaTheNewestPiecesStayAndEachBeginsWithRunAndType) {
  const uint64_t quota = 4000;
  const auto write = [&](LogFiles& files, int64_t first, int64_t last) {
    for (int64_t step = first; step <= last; ++step) {
      files.append(Channel::RobotState, state(7, step), step);
      files.flush();
      uint64_t size = fs::file_size(folder_ + "/log.lcm.part");
      if (fs::exists(folder_ + "/log.earlier.lcm")) size += fs::file_size(folder_ + "/log.earlier.lcm");
      ASSERT_LE(size, quota + 2 * (state(7, step).size() + 100)) << "an event more than half, in each";
    }
  };
  killed([&] {
    LogFiles files(folder_, quota);
    files.open(7, {.may_split = true}, [](Channel, std::span<const uint8_t>) {});
    files.append(Channel::Run, beginning<run_t>(7), 1);
    files.append(Channel::Type, beginning<type_t>(7), 2);
    write(files, 0, 29);
    _exit(testing::Test::HasFailure());
  });
  LogFiles files(folder_, quota);
  files.open(7, {.may_split = true},
             [](Channel, std::span<const uint8_t>) {});  // the one after goes on alike
  write(files, 29, 99);
  files.close();
  const auto earlier = events_of(folder_ + "/log.earlier.lcm"), last = events_of(folder_ + "/log.lcm");
  for (const auto& piece : {earlier, last}) {
    ASSERT_GT(piece.size(), 2u);
    EXPECT_EQ(piece[0], "RUN");
    EXPECT_EQ(piece[1], "TYPE");
  }
  EXPECT_EQ(last.back(), "99");
  EXPECT_EQ(std::stoi(earlier.back()) + 1, std::stoi(last[2])) << "nothing is lost between them";
}

/// The times of a log's events.
std::vector<int64_t> times_of(const std::string& path) {
  std::vector<int64_t> out;
  LogReader reader(path);
  for (LogEvent event; reader.next(event);) out.push_back(event.utime);
  return out;
}

// stock lcm-logplayer would wait for the hours between the start of a lab and the piece
TEST_F(LogFilesTest, APieceBeginsAtTheTimeAtWhichTheOneBeforeEnds) {
  const int64_t hour = 3'600'000'000;
  const auto write = [&](LogFiles& files, int64_t first, int64_t last) {
    for (int64_t step = first; step <= last; ++step) {
      files.append(Channel::RobotState, state(7, step), hour + step);
      files.flush();
    }
  };
  killed([&] {
    LogFiles files(folder_, 4000);
    files.open(7, {.may_split = true, .checks = true}, [](Channel, std::span<const uint8_t>) {});
    files.append(Channel::Run, beginning<run_t>(7), 1);
    files.append(Channel::Type, beginning<type_t>(7), 1);
    write(files, 0, 2);
    _exit(0);
  });
  LogFiles files(folder_, 4000);
  files.open(7, {.may_split = true, .checks = true}, [](Channel, std::span<const uint8_t>) {});
  write(files, 2, 99);
  files.close();
  const auto earlier = times_of(folder_ + "/log.earlier.lcm"), last = times_of(folder_ + "/log.lcm");
  EXPECT_EQ(last[0], earlier.back());
  EXPECT_EQ(last[1], earlier.back());
  EXPECT_TRUE(std::is_sorted(last.begin(), last.end()));
  EXPECT_TRUE(std::is_sorted(earlier.begin(), earlier.end()));
}

TEST_F(LogFilesTest, ALockstepLogIsNeverSplit) {
  LogFiles files(folder_, 1000);
  files.open(7, {}, [](Channel, std::span<const uint8_t>) {});
  for (int64_t step = 0; step < 100; ++step) {
    files.append(Channel::RobotState, state(7, step), step);
    files.flush();
  }
  files.close();
  EXPECT_EQ(events_of(folder_ + "/log.lcm").size(), 100u);
  EXPECT_FALSE(fs::exists(folder_ + "/log.earlier.lcm"));
}

TEST_F(LogFilesTest, TelemetryHasTheSameQuota) {
  LogFiles files(folder_, 20000);
  for (int i = 0; i < 100; ++i) files.telemetry(Channel::RobotState, std::vector<uint8_t>(1000, 1));
  EXPECT_LE(
      fs::file_size(folder_ + "/telemetry.earlier.lcm") + fs::file_size(folder_ + "/telemetry.lcm.part"),
      30000u);
  EXPECT_GE(fs::file_size(folder_ + "/telemetry.earlier.lcm"), 10000u);
}

}  // namespace
}  // namespace lab::logger
