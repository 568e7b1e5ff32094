// Planner, controller and logger in real time, each alone with messages made by hand.
#include <gtest/gtest.h>

#include <lab/ack_t.hpp>
#include <lab/command_t.hpp>
#include <lab/end_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <lab/type_t.hpp>
#include <stdexcept>

#include "tests/wire/protocol/message.h"
#include "wire/protocol/controller_role.h"
#include "wire/protocol/logger_role.h"
#include "wire/protocol/planner_role.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

constexpr int64_t kRun = 42;

Bytes run() { return encode(message_of<run_t>(kRun, kBeforeStart)); }

Bytes state(int64_t step, int64_t input_seq = 0) {
  auto m = message_of<robot_state_t>(kRun, step);
  m.utime = 1000 * step;
  m.nq = m.nv = 1;
  m.q = m.v = m.tau = {0};
  m.input_seq = input_seq;
  return encode(m);
}

Bytes reference(int64_t step) {
  auto m = message_of<reference_t>(kRun, step);
  m.nq = m.nv = 1;
  m.q = m.v = m.a = {0};
  return encode(m);
}

Bytes input(int64_t seq, int64_t step) {
  auto m = message_of<input_t>(kRun, step);
  m.input_seq = seq;
  m.action.verb = "set";
  return encode(m);
}

RunSetup setup(const run_t&) {
  RunSetup s;
  s.nq = s.nv = 1;
  s.dt = 1e-3;
  s.last_step = 1000;
  s.realtime = true;
  s.timeout = 20;
  return s;
}

struct Sent {
  template <class T>
  std::vector<T> all(Channel channel) const {
    std::vector<T> out;
    for (const auto& [c, bytes] : messages)
      if (c == channel) out.push_back(decode<T>(bytes));
    return out;
  }
  Publish publish() {
    return [this](Channel channel, std::span<const uint8_t> bytes) {
      messages.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
    };
  }
  std::vector<std::pair<Channel, Bytes>> messages;
};

class RealtimeController : public testing::Test {
 protected:
  ControllerRole make() {
    return {
        {},
        setup,
        [this](const RobotState&, const Reference&, std::span<const Action> actions, std::vector<Event>&) {
          actions_ += static_cast<int>(actions.size());
          return Command{Eigen::VectorXd::Constant(1, 3.5)};
        },
        sent.publish()};
  }
  Sent sent;
  int actions_ = 0;
};

TEST_F(RealtimeController, AnswersTheNewestStateWithAFreshReferenceOnly) {
  ControllerRole role = make();
  role.receive(Channel::Run, run(), 0);
  ASSERT_EQ(sent.all<need_t>(Channel::Need).size(), 1u) << "asks for the INPUTs so far";
  EXPECT_EQ(role.state(), "READY");
  role.receive(Channel::RobotState, state(0), 0);
  role.tick(0);
  EXPECT_TRUE(sent.all<command_t>(Channel::Command).empty());
  EXPECT_EQ(role.state(), "HOLDING");

  role.receive(Channel::Reference, reference(3), 1000);
  role.receive(Channel::Reference, reference(1), 1000);  // late: the newer one stays
  for (int64_t step : {1, 3, 2}) role.receive(Channel::RobotState, state(step), 1000);
  role.tick(1000);
  const auto commands = sent.all<command_t>(Channel::Command);
  ASSERT_EQ(commands.size(), 1u);
  EXPECT_EQ(commands[0].state_step, 3);
  EXPECT_EQ(commands[0].reference_step, 3);
  EXPECT_EQ(commands[0].tau, std::vector<double>{3.5});
  EXPECT_EQ(role.state(), "RUNNING");
  EXPECT_EQ(role.step(), 3);
  EXPECT_GT(role.urgency(), 0);
  role.receive(Channel::RobotState, state(2), 1500);
  EXPECT_EQ(role.late(), 1);
  role.receive(Channel::RobotState, state(3), 1500);
  role.receive(Channel::Reference, reference(4), 1500);
  role.tick(1500);
  EXPECT_EQ(sent.all<command_t>(Channel::Command).size(), 1u) << "no new state";

  role.receive(Channel::RobotState, state(23), 23'000);  // the reference is 19 steps old
  role.tick(23'000);
  EXPECT_EQ(sent.all<command_t>(Channel::Command).size(), 2u);
  role.receive(Channel::RobotState, state(24), 24'000);  // 20 steps: safety.timeout
  role.tick(24'000);
  EXPECT_EQ(sent.all<command_t>(Channel::Command).size(), 2u);
  EXPECT_EQ(role.state(), "HOLDING");
}

TEST_F(RealtimeController, WaitsForTheInputsThatAStateCounts) {
  ControllerRole role = make();
  role.receive(Channel::Run, run(), 0);
  role.receive(Channel::Reference, reference(1), 0);
  role.receive(Channel::RobotState, state(0, 2), 0);
  role.receive(Channel::Input, input(2, 0), 0);
  role.tick(kFirstWait);
  EXPECT_TRUE(sent.all<command_t>(Channel::Command).empty());
  ASSERT_EQ(sent.all<need_t>(Channel::Need).size(), 2u);
  role.receive(Channel::Input, input(1, 0), kFirstWait);
  role.tick(kFirstWait);
  ASSERT_EQ(sent.all<command_t>(Channel::Command).size(), 1u);
  EXPECT_EQ(sent.all<command_t>(Channel::Command)[0].input_seq, 2);
  EXPECT_EQ(actions_, 2);
}

TEST_F(RealtimeController, EndsTenSecondsAfterTheSimulator) {
  ControllerRole role = make();
  role.receive(Channel::Run, run(), 0);
  Micros now = 0;
  for (; now <= 10'000'000; now += kRepeat) {
    role.receive(Channel::Reference, reference(now / kRepeat), now);  // the planner lives
    role.tick(now);
    ASSERT_FALSE(role.outcome().ended) << now;
  }
  role.tick(now);
  EXPECT_EQ(role.outcome().exit_code, kTransport);
  EXPECT_EQ(role.outcome().reason, "nothing from the simulator in 10 s after step -1");
}

// A simulator that speaks but has no RUN for us is none.
TEST_F(RealtimeController, TheTimeToBeReadyIsCountedFromTheStart) {
  ControllerRole role = make();
  process_t process{};
  process.name = kSimulator;
  Micros now = 0;
  for (; now <= FollowerConfig{}.ready_deadline; now += kRepeat) {
    role.receive(Channel::Process, encode(process), now);
    role.tick(now);
    ASSERT_FALSE(role.outcome().ended) << now;
  }
  role.tick(now);
  EXPECT_EQ(role.outcome().exit_code, kNotReady);
}

TEST(RealtimePlanner, PlansForTheStepAfterTheNewestState) {
  Sent sent;
  bool held = false;
  PlannerRole role(
      {}, setup,
      [&](int64_t step, const PlanInput& input, std::vector<Event>&) {
        held = input.held;
        const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
        return Reference{step, zero, zero, zero};
      },
      sent.publish());
  role.receive(Channel::Run, run(), 0);
  EXPECT_TRUE(sent.all<reference_t>(Channel::Reference).empty());
  EXPECT_GT(role.urgency(), 0);
  role.receive(Channel::RobotState, state(7), 0);
  role.tick(0);
  ASSERT_EQ(sent.all<reference_t>(Channel::Reference).size(), 1u);
  EXPECT_EQ(sent.all<reference_t>(Channel::Reference)[0].step, 8);
  EXPECT_EQ(sent.all<reference_t>(Channel::Reference)[0].utime, 8000);
  EXPECT_TRUE(held) << "until the simulator's PROCESS is RUNNING";
  process_t process{};
  process.name = kSimulator;
  process.state = "RUNNING";
  role.receive(Channel::Process, encode(process), 1000);
  role.receive(Channel::RobotState, state(8), 1000);
  role.tick(1000);
  EXPECT_FALSE(held);
  role.receive(Channel::End, encode(message_of<end_t>(kRun, 8)), 2000);
  EXPECT_TRUE(role.outcome().ended);
}

class Memory : public LogSink {
 public:
  void open(int64_t, LogKind, const std::function<void(Channel, std::span<const uint8_t>)>&) override {}
  void append(Channel channel, std::span<const uint8_t> bytes, int64_t) override {
    text += std::string(row(channel).name) + " " + std::to_string(decode_step(bytes)) + "\n";
  }
  void flush() override {}
  void close() override { closed = true; }
  void telemetry(Channel, std::span<const uint8_t>) override {}
  std::string text;
  bool closed = false;

 private:
  static int64_t decode_step(std::span<const uint8_t> bytes) { return static_cast<int8_t>(bytes[31]); }
};

TEST(RealtimeLogger, WritesWhatArrivesAndEachInputOnce) {
  Sent sent;
  Memory memory;
  LoggerRole role({}, setup, [](int64_t) { return std::vector<Bytes>{}; }, memory, sent.publish());
  role.receive(Channel::Run, run(), 0);
  role.receive(Channel::RobotState, state(1), 0);
  role.receive(Channel::Reference, reference(5), 0);
  role.receive(Channel::Input, input(1, 2), 0);
  role.receive(Channel::Input, input(1, 2), 0);
  role.receive(Channel::Type, encode(message_of<type_t>(kRun, 1)), 0);  // it was written with RUN
  role.receive(Channel::Need, encode(message_of<need_t>(kRun, 1)), 0);  // what is no part of a log
  role.receive(Channel::RobotState, state(0), 0);
  EXPECT_EQ(role.step(), 1);
  EXPECT_FALSE(memory.closed);
  role.receive(Channel::End, encode(message_of<end_t>(kRun, 1)), 0);
  EXPECT_EQ(memory.text, "RUN -1\nROBOT_STATE 1\nREFERENCE 5\nINPUT 2\nROBOT_STATE 0\nEND 1\n");
  EXPECT_TRUE(memory.closed);
  const auto acks = sent.all<ack_t>(Channel::Ack);
  ASSERT_EQ(acks.size(), 2u);
  EXPECT_FALSE(acks[0].closed);
  EXPECT_TRUE(acks[1].closed);
  EXPECT_EQ(acks[1].complete_to, 1);
}

// A disk that does not take the log: the simulator, which waits for the last ACK, must not hear that all is well.
TEST(RealtimeLogger, TheLastAckComesAfterTheLogIsClosed) {
  struct FullDisk : Memory {
    void close() override { throw std::runtime_error("no space left"); }
  };
  Sent sent;
  FullDisk memory;
  LoggerRole role({}, setup, [](int64_t) { return std::vector<Bytes>{}; }, memory, sent.publish());
  role.receive(Channel::Run, run(), 0);
  role.receive(Channel::RobotState, state(0), 0);
  role.receive(Channel::End, encode(message_of<end_t>(kRun, 0)), 0);
  EXPECT_EQ(role.outcome().reason, "no space left");
  for (const ack_t& ack : sent.all<ack_t>(Channel::Ack)) EXPECT_FALSE(ack.closed);
}

}  // namespace
}  // namespace lab
