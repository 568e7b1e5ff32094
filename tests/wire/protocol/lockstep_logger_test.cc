// The logger in lockstep, alone with messages made by hand: which bytes it writes.
#include <gtest/gtest.h>

#include <lab/ack_t.hpp>
#include <lab/command_t.hpp>
#include <lab/need_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>

#include "tests/wire/protocol/lockstep_world.h"
#include "tests/wire/protocol/message.h"

namespace lab::test {
namespace {

constexpr int64_t kRun = 42;

Bytes state(int64_t step, int64_t digest) {
  auto m = message_of<robot_state_t>(kRun, step);
  m.digest = digest;
  return encode(m);
}
Bytes reference(int64_t step) { return encode(message_of<reference_t>(kRun, step)); }
Bytes command(int64_t step, double tau) {
  auto m = message_of<command_t>(kRun, step);
  m.nv = 1;
  m.tau = {tau};
  return encode(m);
}

/// Digest of step 0 as the simulator used it: with an effort of 2.5.
int64_t used_digest() {
  StepRecord used;
  used.clear(0);
  used.store(Channel::RobotState, state(0, 0), false);
  used.store(Channel::Reference, reference(0), false);
  used.store(Channel::Command, command(0, 2.5), false);
  return used.digest();
}

/// A logger that knows the run.
struct Bench {
  Bench() { logger.receive(Channel::Run, encode(message_of<run_t>(kRun, kBeforeStart)), 0); }
  std::vector<int64_t> steps_asked_for() const {
    std::vector<int64_t> steps;
    for (const auto& [channel, bytes] : sent)
      if (channel == Channel::Need) steps.push_back(decode<need_t>(bytes).step);
    return steps;
  }
  std::vector<Logged> written() {
    sink.flush();
    return log.kept;
  }

  /// Lets the clock go on from the last time, by ticks that are never far apart.
  void wait(Micros how_long) {
    for (const Micros end = now + how_long; now < end;) {
      now = std::min(end, now + kRepeat);
      logger.tick(now);
    }
  }

  /// Counts what a file would be asked for.
  struct Sink : MemorySink {
    using MemorySink::MemorySink;
    void flush() override {
      ++flushes;
      MemorySink::flush();
    }
    int flushes = 0;
  };

  Micros now = 0;
  std::vector<std::pair<Channel, Bytes>> sent;
  MemoryLog log;
  Sink sink{log};
  LoggerRole logger{LoggerConfig{}, toy_setup, [](int64_t) { return std::vector<Bytes>{}; }, sink,
                    [this](Channel channel, std::span<const uint8_t> bytes) {
                      sent.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
                    }};
};

// A COMMAND of which the logger heard another version than the simulator used must not get into the log, whatever else
// of its step is here: the step is asked for again, and written with the bytes that were used.
TEST(LockstepLogger, WritesAStepOnlyWithTheBytesThatTheSimulatorUsed) {
  Bench bench;
  bench.logger.receive(Channel::RobotState, state(0, 0), 0);
  bench.logger.receive(Channel::Reference, reference(0), 0);
  bench.logger.receive(Channel::Command, command(0, -2.5), 0);
  bench.logger.receive(Channel::RobotState, state(1, used_digest()), 0);
  EXPECT_EQ(bench.logger.step(), kBeforeStart);
  EXPECT_EQ(bench.written().size(), 1u) << "only RUN";
  bench.logger.tick(kFirstWait);
  EXPECT_EQ(bench.steps_asked_for(), std::vector<int64_t>{0});

  bench.logger.receive(Channel::Command, command(0, 2.5), kFirstWait);
  EXPECT_EQ(bench.logger.step(), 0);
  const std::vector<Logged> log = bench.written();
  ASSERT_EQ(log.size(), 4u);
  EXPECT_EQ(log[3], (Logged{Channel::Command, command(0, 2.5)}));
}

// The last step has no ROBOT_STATE after it: END carries its digest.
TEST(LockstepLogger, EndSaysTheBytesOfTheLastStep) {
  auto end = message_of<end_t>(kRun, 0);
  end.digest = used_digest();

  Bench bench;
  bench.logger.receive(Channel::RobotState, state(0, 0), 0);
  bench.logger.receive(Channel::Reference, reference(0), 0);
  bench.logger.receive(Channel::Command, command(0, -2.5), 0);
  bench.logger.receive(Channel::End, encode(end), 0);
  EXPECT_FALSE(bench.log.closed);
  bench.logger.receive(Channel::Command, command(0, 2.5), 0);
  EXPECT_TRUE(bench.log.closed);
  EXPECT_EQ(bench.log.kept.size(), 5u);
}

// The state of the next step is there before the answers to this one: only the one after that shows a loss at once.
TEST(LockstepLogger, AsksAtOnceWhenAStateIsTwoAhead) {
  Bench bench;
  bench.logger.receive(Channel::RobotState, state(0, 0), 0);
  bench.logger.tick(0);  // the request that is due after RUN
  const size_t before = bench.steps_asked_for().size();
  bench.logger.receive(Channel::RobotState, state(1, used_digest()), 1);
  bench.logger.tick(1);
  EXPECT_EQ(bench.steps_asked_for().size(), before);
  bench.logger.receive(Channel::RobotState, state(2, 7), 2);
  bench.logger.tick(2);
  EXPECT_GT(bench.steps_asked_for().size(), before);
}

TEST(LockstepLogger, FlushesOnlyALogThatIsOpen) {
  Bench bench;
  const int opened = bench.sink.flushes;
  bench.wait(3 * kRepeat);
  EXPECT_GE(bench.sink.flushes, opened + 2);
  auto end = message_of<end_t>(kRun, kBeforeStart);
  bench.logger.receive(Channel::End, encode(end), bench.now);
  ASSERT_TRUE(bench.log.closed);
  const int closed = bench.sink.flushes;
  bench.wait(3 * kRepeat);
  EXPECT_EQ(bench.sink.flushes, closed);

  MemoryLog none;
  Bench::Sink unopened{none};
  LoggerRole early{LoggerConfig{}, toy_setup, [](int64_t) { return std::vector<Bytes>{}; }, unopened,
                   [](Channel, std::span<const uint8_t>) {}};
  early.tick(kRepeat);
  EXPECT_EQ(unopened.flushes, 0);
}

// The simulator forgets what is acknowledged: it must be with the kernel, not in a buffer of ours.
TEST(LockstepLogger, AnAckMeansWritten) {
  static_assert(kRepeat == 100'000);
  Bench bench;
  bench.logger.tick(0);
  const auto acknowledged = [&] {
    int64_t last = kBeforeStart;
    for (const auto& [channel, bytes] : bench.sent)
      if (channel == Channel::Ack) last = decode<ack_t>(bytes).complete_to;
    return last;
  };
  bench.logger.receive(Channel::RobotState, state(0, 0), 0);
  bench.logger.receive(Channel::Reference, reference(0), 0);
  bench.logger.receive(Channel::Command, command(0, 2.5), 0);
  bench.logger.receive(Channel::RobotState, state(1, used_digest()), 0);
  EXPECT_EQ(bench.logger.step(), 0);
  EXPECT_EQ(bench.log.kept.size(), 1u) << "only RUN is with the kernel";
  EXPECT_EQ(acknowledged(), kBeforeStart);
  bench.wait(kRepeat);
  EXPECT_EQ(bench.log.kept.size(), 4u);
  EXPECT_EQ(acknowledged(), 0);
}

TEST(LockstepLogger, ItsLogIsNotSplitAndOnlyThatOfRealTimeIs) {
  struct Kind : MemorySink {
    using MemorySink::MemorySink;
    void open(int64_t, LogKind kind, const std::function<void(Channel, std::span<const uint8_t>)>&) override {
      split = kind.may_split;
    }
    bool split = false;
  };
  for (const bool realtime : {false, true}) {
    MemoryLog log;
    Kind sink{log};
    LoggerRole logger{LoggerConfig{},
                      [realtime](const run_t& run) {
                        RunSetup setup = toy_setup(run);
                        setup.realtime = realtime;
                        return setup;
                      },
                      [](int64_t) { return std::vector<Bytes>{}; }, sink,
                      [](Channel, std::span<const uint8_t>) {}};
    logger.receive(Channel::Run, encode(message_of<run_t>(kRun, kBeforeStart)), 0);
    EXPECT_EQ(sink.split, realtime);
  }
}

TEST(LockstepLogger, ARunThatItCannotReadEndsIt) {
  MemoryLog log;
  MemorySink sink{log};
  LoggerRole logger{LoggerConfig{}, [](const run_t&) -> RunSetup { throw std::runtime_error("no robot"); },
                    [](int64_t) { return std::vector<Bytes>{}; }, sink,
                    [](Channel, std::span<const uint8_t>) {}};
  logger.receive(Channel::Run, encode(message_of<run_t>(kRun, kBeforeStart)), 0);
  EXPECT_TRUE(logger.outcome().ended);
  EXPECT_EQ(logger.outcome().exit_code, kBadConfig);
  EXPECT_EQ(logger.outcome().reason, "no robot");
  EXPECT_EQ(logger.state(), "FAULT");
}

TEST(LockstepLogger, SilenceEndsItAndTheLogIsClosed) {
  Bench bench;
  bench.logger.tick(0);
  bench.wait(LoggerConfig{}.deadline);
  EXPECT_FALSE(bench.logger.outcome().ended);
  bench.wait(1);
  EXPECT_TRUE(bench.logger.outcome().ended);
  EXPECT_EQ(bench.logger.outcome().exit_code, kTransport);
  EXPECT_EQ(bench.logger.outcome().reason, "nothing from the simulator in 10 s after step -1");
  EXPECT_TRUE(bench.log.closed);
}

}  // namespace
}  // namespace lab::test
