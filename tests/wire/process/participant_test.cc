// The shell around a role, on a bus inside this process (memq://), on which it hears what it says itself.
#include "wire/process/participant.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <lab/command_t.hpp>
#include <lab/process_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>

#include "tests/wire/process/script.h"
#include "tests/wire/protocol/message.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

constexpr int64_t kNonce = 42;

class ParticipantTest : public testing::Test {
 protected:
  ParticipantTest() {
    setenv("LAB_LAUNCH", std::to_string(kNonce).c_str(), 1);
    for (const char* name : {"LAB_RUN_DIR", "LAB_GUESTS", "LAB_BUS", "LAB_FAULT_DROP"}) unsetenv(name);
    become(kSimulator);
  }
  void become(const char* name, std::vector<Channel> channels = {}) {
    participant_ = std::make_unique<Participant>(
        ParticipantOptions{.name = name, .url = "memq://", .prefix = "", .channels = std::move(channels)});
    publish_ = participant_->publish();
  }
  static Bytes command(int64_t step, double tau, int64_t run = kRun) {
    auto m = message_of<command_t>(run, step);
    m.state_step = step;
    m.nv = 1;
    m.tau = {tau};
    return encode(m);
  }

  static Bytes reference(int64_t step) {
    auto m = message_of<reference_t>(kRun, step);
    m.nq = m.nv = 1;
    m.q = m.v = m.a = {0};
    return encode(m);
  }
  static Bytes state(int64_t step) {
    auto m = message_of<robot_state_t>(kRun, step);
    m.nq = m.nv = 1;
    m.q = m.v = m.tau = {0};
    return encode(m);
  }
  static Bytes process(const char* name, int64_t nonce, const char* its_state = "READY") {
    auto m = message_of<process_t>(kRun, kBeforeStart);
    m.name = name;
    m.nonce = nonce;
    m.state = its_state;
    return encode(m);
  }
  /// The newest PROCESS of this name that the role was given.
  process_t newest(const std::string& name) const {
    process_t found{};
    for (const auto& [channel, bytes] : role_.heard)
      if (channel == Channel::Process && decode<process_t>(bytes).name == name) decode(bytes, found);
    return found;
  }
  /// The steps of the messages on a channel that the role was given.
  std::vector<int64_t> steps(Channel of) const {
    std::vector<int64_t> found;
    for (const auto& [channel, bytes] : role_.heard)
      if (channel == of) found.push_back(peek_step(bytes));
    return found;
  }

  std::unique_ptr<Participant> participant_;
  Publish publish_;
  Script role_;
};

// What the guard would refuse from others is not sent either: the process ends instead.
TEST_F(ParticipantTest, RefusesToSendAnInvalidMessage) {
  EXPECT_NO_THROW(publish_(Channel::Command, command(kStep, 1)));
  EXPECT_THROW(publish_(Channel::Command, command(kStep, NAN)), PublishRefused);
  EXPECT_THROW(publish_(Channel::Reference, command(kStep, 1)), PublishRefused)
      << "of another channel's type";
  role_.send = [&] { publish_(Channel::Command, command(kStep, INFINITY)); };
  EXPECT_EQ(participant_->run(role_), kSafety);
}

// The role knows its robot from the start, as the simulator does.
TEST_F(ParticipantTest, RefusesToSendTheSizesOfAnotherRobot) {
  role_.send = [&] {
    command_t two = decode<command_t>(command(kStep, 1));
    two.nv = 2;
    two.tau = {1, 1};
    publish_(Channel::Command, encode(two));
  };
  EXPECT_EQ(participant_->run(role_), kSafety);
}

// Another run's message and another launch's process are dropped, and PROCESS says how many.
TEST_F(ParticipantTest, CountsForeignMessagesInItsProcess) {
  role_.send = [&] {
    publish_(Channel::Command, command(kStep, 1, kRun + 1));
    publish_(Channel::Process, process(kLogger, kNonce + 1));
    publish_(Channel::Process, process(kLogger, kNonce + 2));
  };
  role_.done = [&] { return newest(kSimulator).foreign >= 3; };
  EXPECT_EQ(participant_->run(role_), kOk);
  EXPECT_EQ(newest(kSimulator).foreign, 3);
  EXPECT_EQ(newest(kSimulator).rejected, 0);
  EXPECT_EQ(newest(kSimulator).last_rejected, "PROCESS: a logger of another lab");
}

// The logger of another launch is READY, which is no news for this one.
TEST_F(ParticipantTest, OnlyProcessesOfThisLaunchReachTheRole) {
  role_.send = [&] {
    publish_(Channel::Process, process(kLogger, kNonce + 1));
    publish_(Channel::Process, process(kController, 0));
    publish_(Channel::Process, process(kPlanner, kNonce));
  };
  role_.done = [&] { return newest(kPlanner).state == "READY"; };
  EXPECT_EQ(participant_->run(role_), kOk);
  EXPECT_EQ(newest(kPlanner).state, "READY");
  EXPECT_EQ(newest(kLogger).state, "");
  EXPECT_EQ(newest(kController).state, "") << "no nonce is another nonce, except a guest's";
}

// Whatever channels a process has asked for: PROCESS says whose the messages on them are. Its role is given only these.
TEST_F(ParticipantTest, ListensToProcessesWithAnyListOfChannels) {
  become(kController, {Channel::RobotState});
  role_.send = [&] {
    publish_(Channel::Process, process(kPlanner, kNonce));
    publish_(Channel::Process, process(kLogger, kNonce + 1));
    publish_(Channel::Reference, reference(kStep));
    publish_(Channel::RobotState, state(kStep));
  };
  role_.done = [&] { return !steps(Channel::RobotState).empty(); };
  EXPECT_EQ(participant_->run(role_), kOk);
  EXPECT_EQ(role_.strangers, std::vector<std::string>{"PROCESS: a logger of another lab"});
  EXPECT_EQ(role_.heard.size(), 1u);
}

// The simulator knows the last ROBOT_STATE as its own step.
TEST_F(ParticipantTest, AnswersMoreThanAWindowAheadAreRefused) {
  role_.send = [&] {
    for (const int64_t step : {kStep + kWindow + 1, int64_t{1} << 62, kStep + kWindow}) {
      publish_(Channel::Command, command(step, 1));
      publish_(Channel::Reference, reference(step));
    }
  };
  role_.done = [&] { return newest(kSimulator).rejected >= 4; };
  EXPECT_EQ(participant_->run(role_), kOk);
  EXPECT_EQ(steps(Channel::Command), std::vector<int64_t>{kStep + kWindow});
  EXPECT_EQ(steps(Channel::Reference), std::vector<int64_t>{kStep + kWindow});
  EXPECT_EQ(newest(kSimulator).rejected, 4);
  EXPECT_EQ(newest(kSimulator).last_rejected, "REFERENCE: step 4611686018427387904, ROBOT_STATE is at 10");
}

// The others know it from what they hear; before the first one nothing is too far ahead.
TEST_F(ParticipantTest, TheWindowOfTheOthersFollowsRobotState) {
  become(kController);
  role_.send = [&] {
    publish_(Channel::Reference, reference(5000));
    for (const int64_t step : {100, 90}) publish_(Channel::RobotState, state(step));  // 90 comes late
    publish_(Channel::Reference, reference(100 + kWindow));
    publish_(Channel::Reference, reference(100 + kWindow + 1));
  };
  role_.done = [&] { return newest(kController).rejected >= 1; };
  EXPECT_EQ(participant_->run(role_), kOk);
  EXPECT_EQ(steps(Channel::Reference), (std::vector<int64_t>{5000, 100 + kWindow}));
  EXPECT_EQ(newest(kController).rejected, 1);
}

// A REQUEST that names no run may be meant for it. One that is ending is none, and no other process speaks for its lab.
TEST_F(ParticipantTest, NoticesTheSimulatorOfAnotherLab) {
  const std::pair<const char*, const char*> others[] = {
      {kLogger, "RUNNING"}, {kSimulator, "STOPPING"}, {kSimulator, "FAULT"}, {kSimulator, "RUNNING"}};
  role_.send = [&] {
    for (const auto& [name, its_state] : others)
      publish_(Channel::Process, process(name, kNonce + 1, its_state));
    publish_(Channel::Process, process(kPlanner, kNonce));
  };
  role_.done = [&] { return newest(kPlanner).state == "READY"; };
  EXPECT_EQ(participant_->run(role_), kOk);
  EXPECT_EQ(role_.neighbours, 1);
}

// Before the first step even a process of the lab may be unknown for a moment.
TEST_F(ParticipantTest, SaysAtMostOnceASecondWhatItIgnores) {
  for (const int64_t step : {int64_t{-1}, kStep}) {
    role_ = Script();
    become(kSimulator);
    role_.at = step;
    role_.send = [&] {
      for (int n = 0; n < 50; ++n) publish_(Channel::Process, process(kLogger, kNonce + 1));
    };
    role_.done = [&] { return role_.strangers.size() >= 50; };
    testing::internal::CaptureStderr();
    EXPECT_EQ(participant_->run(role_), kOk);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), step < 0 ? 0 : 1) << said;
    EXPECT_EQ(said.find("lab-simulator: ignored PROCESS: a logger of another lab"),
              step < 0 ? std::string::npos : 0);
  }
}

TEST_F(ParticipantTest, SaysHowLateItsTicksAre) {
  role_.late.emplace();
  for (int us = 0; us < 1000; ++us) role_.late->add(us);
  role_.late->add(50'000);
  role_.done = [&] { return newest(kSimulator).lateness_max > 0; };
  EXPECT_EQ(participant_->run(role_), kOk);
  const process_t process = newest(kSimulator);
  EXPECT_EQ(process.overruns, 3);
  EXPECT_EQ(process.lateness_p50, 500);
  EXPECT_EQ(process.lateness_p99, 990);
  EXPECT_EQ(process.lateness_max, 50'000);
}

TEST_F(ParticipantTest, IsAwakeBeforeATick) {
  role_.due = 10'000;
  EXPECT_EQ(time_to_sleep(role_, 1'000'000, 7'000), 3'000) << "for a role without ticks";
  role_.late.emplace();
  EXPECT_EQ(time_to_sleep(role_, 1'000'000, 7'000), 2'950);
  EXPECT_EQ(time_to_sleep(role_, 1'000'000, 9'949), 1);
  for (const Micros now : {9'950, 9'999, 10'000, 11'000}) EXPECT_EQ(time_to_sleep(role_, 1'000'000, now), 0);
  EXPECT_EQ(time_to_sleep(role_, 8'000, 7'000), 1'000) << "PROCESS is due";
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // their memory cannot be locked
TEST_F(ParticipantTest, AsksForRealTimeOrSaysThatItMayNot) {
  role_.rank = 2;
  testing::internal::CaptureStderr();
  EXPECT_EQ(participant_->run(role_), kOk);
  const std::string said = testing::internal::GetCapturedStderr();
  sched_param got{};
  sched_getparam(0, &got);
  const bool is_fifo = sched_getscheduler(0) == SCHED_FIFO && got.sched_priority == 42;
  EXPECT_EQ(is_fifo, said.find("not permitted to use SCHED_FIFO") == std::string::npos) << said;
  std::ifstream status("/proc/self/status");
  int64_t locked = 0;
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmLck:")) locked = std::stoll(line.substr(6));
  EXPECT_EQ(locked > 0, said.find("mlockall") == std::string::npos) << said;
  const sched_param ordinary{};
  sched_setscheduler(0, SCHED_OTHER, &ordinary);
  munlockall();
}
#endif

}  // namespace
}  // namespace lab
