// The logger in lockstep, alone with messages made by hand: which bytes it writes.
#include <gtest/gtest.h>

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

  std::vector<std::pair<Channel, Bytes>> sent;
  MemoryLog log;
  MemorySink sink{log};
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

}  // namespace
}  // namespace lab::test
