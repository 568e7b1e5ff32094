// The logger in real time, alone with messages made by hand: at which times it writes them, and when it gives up.
#include <gtest/gtest.h>

#include <lab/ack_t.hpp>
#include <lab/command_t.hpp>
#include <lab/event_t.hpp>
#include <lab/frame_t.hpp>
#include <lab/process_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/type_t.hpp>

#include "tests/wire/protocol/lockstep_world.h"
#include "tests/wire/protocol/message.h"

namespace lab::test {
namespace {

constexpr int64_t kRun = 42;
constexpr int64_t kStart = 1'700'000'000'000'000;  // us of the wall clock

template <class T>
Bytes message(int64_t step, int64_t utime) {
  auto m = message_of<T>(kRun, step);
  m.utime = utime;
  return encode(m);
}

Bytes process(const char* name) {
  auto m = message_of<process_t>(kRun, 0);
  m.name = name;
  return encode(m);
}

struct Bench {
  struct Sink : MemorySink {
    using MemorySink::MemorySink;
    void append(Channel channel, std::span<const uint8_t> bytes, int64_t utime) override {
      times.emplace_back(channel, utime);
      MemorySink::append(channel, bytes, utime);
    }
    std::vector<std::pair<Channel, int64_t>> times;
  };
  void hear_run() { hear(Channel::Run, encode(message_of<run_t>(kRun, kBeforeStart))); }
  void hear(Channel channel, const Bytes& bytes) { logger->receive(channel, bytes, now); }
  void start() {
    const auto setup = [](const run_t& run) {
      RunSetup setup = toy_setup(run);
      setup.realtime = true;
      return setup;
    };
    const auto types = [](int64_t) { return std::vector<Bytes>{message<type_t>(kBeforeStart, 0)}; };
    logger =
        std::make_unique<LoggerRole>(config, setup, types, sink, [](Channel, std::span<const uint8_t>) {});
  }
  /// Lets the clock go on; every 0.1 s the processes that still live say so.
  void wait(Micros how_long, const std::vector<const char*>& alive) {
    for (const Micros end = now + how_long; now < end;) {
      now = std::min(end, now + kRepeat);
      for (const char* name : alive) hear(Channel::Process, process(name));
      logger->tick(now);
    }
  }

  Bench() { start(); }
  Micros now = 0;
  LoggerConfig config{.deadline = 2'000'000, .ready_deadline = 1'000'000};
  MemoryLog log;
  Sink sink{log};
  std::unique_ptr<LoggerRole> logger;
};

// A plain controller may leave utime at 0, and REFERENCE is for the step to come: neither may turn the clock.
TEST(RealtimeLogger, TheLogHasTheClockOfTheStates) {
  Bench bench;
  bench.hear_run();
  bench.hear(Channel::Reference, message<reference_t>(0, kStart));
  EXPECT_TRUE(bench.sink.times.empty()) << "when it begins is not known before the first state";
  bench.hear(Channel::RobotState, message<robot_state_t>(0, kStart));
  bench.hear(Channel::Reference, message<reference_t>(1, kStart + 1000));
  bench.hear(Channel::Command, message<command_t>(0, 0));
  bench.hear(Channel::RobotState, message<robot_state_t>(1, kStart + 1000));
  bench.hear(Channel::Command, message<command_t>(1, kStart + 9'000'000));
  bench.hear(Channel::Event, message<event_t>(2, kStart + 2000));
  bench.hear(Channel::End, message<end_t>(1, kStart + 1000));
  using enum Channel;
  const std::vector<std::pair<Channel, int64_t>> wanted{
      {Run, kStart},          {Type, kStart},      {Reference, kStart},         {RobotState, kStart},
      {Reference, kStart},    {Command, kStart},   {RobotState, kStart + 1000}, {Command, kStart + 1000},
      {Event, kStart + 1000}, {End, kStart + 1000}};
  EXPECT_EQ(bench.sink.times, wanted);
  EXPECT_TRUE(bench.log.closed);
}

TEST(RealtimeLogger, ARestartedOneGoesOnAtTheTimeOfTheLastState) {
  Bench bench;
  bench.hear_run();
  bench.hear(Channel::RobotState, message<robot_state_t>(0, kStart));
  bench.sink.flush();
  bench.sink.times.clear();
  bench.start();
  bench.hear_run();
  bench.hear(Channel::Command, message<command_t>(0, 0));
  EXPECT_EQ(bench.sink.times, (std::vector<std::pair<Channel, int64_t>>{{Channel::Command, kStart}}));
}

TEST(RealtimeLogger, ARunWithoutAStateHasRunTypeAndEnd) {
  Bench bench;
  bench.hear_run();
  bench.hear(Channel::End, message<end_t>(kBeforeStart, kStart));
  using enum Channel;
  EXPECT_EQ(bench.sink.times,
            (std::vector<std::pair<lab::Channel, int64_t>>{{Run, kStart}, {Type, kStart}, {End, kStart}}));
  Bench stopped;
  stopped.hear_run();
  stopped.logger->stop(0);
  EXPECT_EQ(stopped.log.kept.size(), 2u) << "RUN and TYPE";
}

// What the simulator repeats for others is in the log once.
TEST(RealtimeLogger, RunAndTypeAreWrittenOnce) {
  Bench bench;
  for (int n = 0; n < 3; ++n) {
    bench.hear_run();
    bench.hear(Channel::Type, message<type_t>(kBeforeStart, 0));
    bench.hear(Channel::RobotState, message<robot_state_t>(n, kStart + n));
  }
  EXPECT_EQ(bench.sink.times.size(), 2u + 3u);
  EXPECT_EQ(bench.logger->late(), 0);
}

// The bus gives every process its own PROCESS back, too.
TEST(RealtimeLogger, OnlyTheSimulatorKeepsItBeyondItsDeadline) {
  Bench bench;
  bench.hear_run();
  bench.hear(Channel::RobotState, message<robot_state_t>(0, kStart));
  bench.wait(5'000'000, {kSimulator});  // paused, say
  EXPECT_FALSE(bench.logger->outcome().ended);
  bench.wait(bench.config.deadline - kRepeat, {kPlanner, kController, kRenderer, kLogger});
  bench.hear(Channel::Command, message<command_t>(0, kStart));
  EXPECT_FALSE(bench.logger->outcome().ended);
  bench.wait(kRepeat, {kPlanner, kController, kRenderer, kLogger});
  EXPECT_TRUE(bench.logger->outcome().ended);
  EXPECT_EQ(bench.logger->outcome().exit_code, kTransport);
  EXPECT_EQ(bench.logger->outcome().reason, "nothing from the simulator in 2 s after step 0");
  EXPECT_TRUE(bench.log.closed);
}

TEST(RealtimeLogger, TheTimeToBeReadyIsCountedFromTheStart) {
  Bench bench;
  bench.logger->tick(0);
  bench.wait(bench.config.ready_deadline, {kSimulator, kLogger});
  EXPECT_FALSE(bench.logger->outcome().ended);
  bench.wait(kRepeat, {kSimulator, kLogger});
  EXPECT_EQ(bench.logger->outcome().exit_code, kNotReady);
  EXPECT_EQ(bench.logger->outcome().reason, "no RUN from the simulator in 1 s");
}

}  // namespace
}  // namespace lab::test
