// Real time with a clock made of numbers: ticks on an absolute grid, newest commands, requests, the end.
#include "wire/protocol/realtime_simulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <lab/ack_t.hpp>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/reply_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>

#include "wire/protocol/loop_bins.h"
#include "wire/schema/codec.h"
#include "wire/schema/guard.h"

namespace lab::test {
namespace {

constexpr Micros kDt = 1000;

struct World {
  explicit World(const std::string& no_reset = "") {
    run_t run{};
    run.run = 77;
    run.step = -1;
    run.nq = run.nv = run.njoints = 1;
    run.joint_names = {"a"};
    SimulatorConfig config;
    config.run = encode(run);
    config.run_id = 77;
    config.model_hash = 5;
    config.nq = config.nv = 1;
    config.dt = 1e-3;
    config.last_step = 100'000;
    config.wall_offset = 5'000'000;
    config.no_reset = no_reset;
    config.why_not = [](const Action& action, const Reference*) {
      return action.verb == "set" || action.verb == "estop" ? std::string() : "no such action" + action.text;
    };
    simulator = std::make_unique<RealtimeSimulatorRole>(
        config,
        [this](int64_t step, const Command* command, std::span<const Action>) {
          used.push_back(command ? command->state_step : -1);
          const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
          return StepResult{{step, 0, zero, zero, zero}, {}, ""};
        },
        [this](Channel channel, std::span<const uint8_t> bytes) {
          sent.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
        });
    for (int pid = 1; const char* name : {kPlanner, kController, kLogger}) {
      process_t process{};
      process.run = 77;
      process.name = name;
      process.pid = pid++;
      process.state = "READY";
      process.model_hash = 5;
      process.utime = 1;
      simulator->receive(Channel::Process, encode(process), now);
    }
  }
  void run_to(Micros time) {
    while (now < time) {
      now = std::min(time, std::max(simulator->wake(), now + 1));
      simulator->tick(now);
    }
  }
  void command(int64_t state_step) {
    command_t command{};
    command.run = 77;
    command.step = command.state_step = state_step;
    command.nv = 1;
    command.tau = {0};
    simulator->receive(Channel::Command, encode(command), now);
  }
  reply_t request(const std::string& verb, int64_t id, std::vector<double> values = {}) {
    request_t request{};
    request.sender = "me";
    request.utime = now + 5'000'000;
    request.id = id;
    request.action.verb = verb;
    request.action.n = static_cast<int32_t>(values.size());
    request.action.values = values;
    simulator->receive(Channel::Request, encode(request), now);
    return decode<reply_t>(last(Channel::Reply));
  }
  Bytes last(Channel channel) {
    for (auto it = sent.rbegin(); it != sent.rend(); ++it)
      if (it->first == channel) return it->second;
    ADD_FAILURE() << "nothing on " << row(channel).name;
    return {};
  }
  int64_t count(Channel channel) const {
    return std::count_if(sent.begin(), sent.end(), [&](const auto& m) { return m.first == channel; });
  }

  Micros now = 1'000'000;
  std::vector<std::pair<Channel, Bytes>> sent;
  std::vector<int64_t> used;
  std::unique_ptr<RealtimeSimulatorRole> simulator;
};

TEST(RealtimeSimulatorRole, StepsAreOnAnAbsoluteGridOfTheWallClock) {
  World w;
  EXPECT_EQ(w.simulator->step(), 0);
  w.run_to(1'000'000 + 250 * kDt);
  EXPECT_EQ(w.simulator->step(), 250);
  EXPECT_EQ(decode<robot_state_t>(w.last(Channel::RobotState)).utime, 6'000'000 + 250 * kDt);
}

TEST(RealtimeSimulatorRole, LateTicksAreMadeUpForAndCounted) {
  World w;
  w.run_to(1'000'000 + 10 * kDt);
  w.now += 5 * kDt + 300;
  w.simulator->tick(w.now);
  EXPECT_EQ(w.simulator->step(), 15);
  EXPECT_EQ(w.simulator->overruns(), 4);  // late by 4.3, 3.3, 2.3, 1.3 and 0.3 steps
  EXPECT_EQ(w.simulator->lateness()->longest(), 4 * kDt + 300);
  EXPECT_EQ(w.simulator->wake(), 1'000'000 + 16 * kDt) << "the grid has not moved";
}

TEST(RealtimeSimulatorRole, ALongStandstillMovesTheGridAndIsSaid) {
  World w;
  w.run_to(1'000'000 + 10 * kDt);
  w.now += 3'000'000;
  w.simulator->tick(w.now);
  EXPECT_EQ(w.simulator->step(), 11);
  EXPECT_EQ(decode<event_t>(w.last(Channel::Event)).what, "clock_slipped");
  EXPECT_EQ(w.simulator->wake(), w.now + kDt);
}

TEST(RealtimeSimulatorRole, TheNewestCommandIsUsedOnceAndOldOnesNever) {
  World w;
  w.run_to(1'000'000 + 10 * kDt);
  w.command(9);
  w.command(10);
  w.command(8);
  w.command(11);  // 11 is of the future
  w.command(10);  // doubled on the way
  EXPECT_EQ(w.simulator->late(), 3);
  w.run_to(w.now + 3 * kDt);
  EXPECT_EQ((std::vector<int64_t>(w.used.end() - 3, w.used.end())), (std::vector<int64_t>{10, -1, -1}));
}

TEST(RealtimeSimulatorRole, PauseStepResume) {
  World w;
  w.run_to(1'000'000 + 10 * kDt);
  EXPECT_FALSE(w.request("step", 1).ok);
  EXPECT_TRUE(w.request("pause", 2).ok);
  w.run_to(w.now + 500 * kDt);
  EXPECT_EQ(w.simulator->step(), 10);
  EXPECT_TRUE(w.request("step", 3, {5}).ok);
  w.run_to(w.now + 300 * kDt);
  EXPECT_EQ(w.simulator->step(), 15);
  EXPECT_TRUE(w.request("resume", 4).ok);
  w.run_to(w.now + 20 * kDt);
  EXPECT_NEAR(static_cast<double>(w.simulator->step()), 35, 1);
  EXPECT_EQ(w.simulator->overruns(), 0) << "a pause is no lateness";
}

TEST(RealtimeSimulatorRole, RequestsAreExecutedOnceAndInputsCanBeAskedForAgain) {
  World w;
  w.run_to(1'000'000 + 3 * kDt);
  EXPECT_TRUE(w.request("set", 1, {1}).ok);
  EXPECT_TRUE(w.request("set", 1, {1}).ok);  // repeated until answered
  EXPECT_EQ(w.count(Channel::Input), 1);
  EXPECT_FALSE(w.request("fly", 2).ok);
  w.simulator->receive(
      Channel::Need,
      [] {
        need_t need{};
        need.step = -1;
        need.process = kSimulator;
        need.sender = kController;
        return encode(need);
      }(),
      w.now);
  w.run_to(w.now + kDt);
  EXPECT_EQ(w.count(Channel::Input), 2);
  EXPECT_EQ(w.count(Channel::Run), 2);
}

// What is kept for processes that restart: the last value of each gain, sent a few at a tick.
TEST(RealtimeSimulatorRole, LaterInputsReplaceEarlierOnesOfTheirKey) {
  World w;
  w.run_to(1'000'000 + 3 * kDt);
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_TRUE(w.request("set", i, {static_cast<double>(i)}).ok) << i;
    w.run_to(w.now + kDt);
  }
  const int64_t before = w.count(Channel::Input);
  need_t need{};
  need.step = kBeforeStart;
  need.process = kSimulator;
  w.simulator->receive(Channel::Need, encode(need), w.now);
  w.run_to(w.now + 50 * kDt);
  EXPECT_EQ(w.count(Channel::Input), before + 1);
  EXPECT_EQ(decode<input_t>(w.last(Channel::Input)).action.values, (std::vector<double>{1000}));
}

TEST(RealtimeSimulatorRole, RequestsAreBoundedPerStepInAgeAndInLength) {
  World w;
  w.run_to(1'000'000 + 3 * kDt);
  size_t accepted = 0;
  reply_t reply;
  for (size_t i = 1; i <= 2 * SimulatorRole::kMaxInputs; ++i) {
    reply = w.request("set", static_cast<int64_t>(i), {1});
    accepted += reply.ok;
  }
  EXPECT_EQ(accepted, SimulatorRole::kMaxInputs);
  EXPECT_EQ(reply.reason, "busy: 64 requests wait for the next step, try again");
  w.run_to(w.now + kDt);
  request_t old{};
  old.sender = "old";
  old.utime = w.now + 5'000'000 - 11'000'000;
  old.action.verb = "set";
  w.simulator->receive(Channel::Request, encode(old), w.now);
  EXPECT_EQ(decode<reply_t>(w.last(Channel::Reply)).reason,
            "its utime is 11.0 s behind this host's clock, at most 10 s are allowed");
  old.action.verb = "estop";
  old.id = 1;
  w.simulator->receive(Channel::Request, encode(old), w.now);
  EXPECT_TRUE(decode<reply_t>(w.last(Channel::Reply)).ok) << "an estop counts, however old";
  const int64_t replies = w.count(Channel::Reply);
  old.sender = std::string(1000, 'x');
  w.simulator->receive(Channel::Request, encode(old), w.now);
  EXPECT_EQ(w.count(Channel::Reply), replies);
}

TEST(RealtimeSimulatorRole, Run0MeansThisLabOnlyWhileItIsAlone) {
  World w;
  w.run_to(1'000'000 + 3 * kDt);
  EXPECT_TRUE(w.request("set", 1, {1}).ok);
  w.simulator->neighbour(w.now);
  EXPECT_EQ(w.request("set", 2, {1}).reason,
            "another lab is on this bus: say which run is meant (this one is 000000000000004d)");
  EXPECT_TRUE(w.request("estop", 3).ok) << "of every lab that hears it";
  request_t named{};
  named.run = 77;
  named.sender = "me";
  named.utime = w.now + 5'000'000;
  named.id = 4;
  named.action.verb = "set";
  w.simulator->receive(Channel::Request, encode(named), w.now);
  EXPECT_TRUE(decode<reply_t>(w.last(Channel::Reply)).ok);
  w.run_to(w.now + SimulatorRole::kNeighbourStays);
  EXPECT_TRUE(w.request("set", 5, {1}).ok) << "the other has gone";
}

TEST(RealtimeSimulatorRole, AnEstopIsTakenWhenTheStepIsFullAndAFloodOfThemIsOne) {
  World w;
  w.run_to(1'000'000 + 3 * kDt);
  for (size_t i = 1; i <= 2 * SimulatorRole::kMaxInputs; ++i) w.request("set", static_cast<int64_t>(i), {1});
  const int64_t before = w.count(Channel::Input);
  for (int i = 0; i < 10'000; ++i) {
    request_t stop{};
    stop.sender = std::to_string(i);
    stop.action.verb = "estop";
    w.simulator->receive(Channel::Request, encode(stop), w.now);
    ASSERT_TRUE(decode<reply_t>(w.last(Channel::Reply)).ok);
  }
  EXPECT_EQ(w.count(Channel::Input), before + 1);
}

// the longest REQUEST that the guard lets through, refused and accepted: REPLY and INPUT must pass the guard too
TEST(RealtimeSimulatorRole, AnswersToTheLongestRequestCanBeSent) {
  World w;
  w.run_to(1'000'000 + 3 * kDt);
  const Guard guard;
  int64_t id = 0;
  for (const char* verb : {"set", "fly"}) {
    request_t request{};
    request.sender = std::string(SimulatorRole::kMaxSender, 's');
    request.utime = w.now + 5'000'000;
    request.id = ++id;
    request.action.verb = verb;
    Bytes bytes = encode(request);
    request.action.text = std::string(row(Channel::Request).max_bytes - bytes.size(), 't');
    bytes = encode(request);
    ASSERT_TRUE(guard.check(Channel::Request, bytes));
    w.simulator->receive(Channel::Request, bytes, w.now);
    EXPECT_TRUE(guard.check(Channel::Reply, w.last(Channel::Reply)));
  }
  EXPECT_TRUE(guard.check(Channel::Input, w.last(Channel::Input)));
}

TEST(RealtimeSimulatorRole, ManySingleStepsLeaveTimeToListen) {
  World w;
  w.run_to(1'000'000 + 10 * kDt);
  EXPECT_TRUE(w.request("pause", 1).ok);
  EXPECT_TRUE(w.request("step", 2, {1e300}).ok);
  EXPECT_LE(w.simulator->step(), 10 + 2 * RealtimeSimulatorRole::kStepsPerTick);
  EXPECT_LT(w.simulator->wake(), w.now) << "the rest is due at once, after the waiting messages";
}

TEST(RealtimeSimulatorRole, StrangersBecomeAtMostTenEventsASecond) {
  World w;
  w.run_to(1'000'000 + 10 * kDt);
  for (int i = 0; i < 5000; ++i) {
    w.run_to(w.now + kDt);
    w.simulator->stranger(Channel::Command, i % 2 ? "a" : "b", w.now);
  }
  EXPECT_NEAR(static_cast<double>(w.count(Channel::Event)), 2 * 5, 2) << "two strangers, one a second each";
  for (int i = 0; i < 5000; ++i) {
    w.run_to(w.now + kDt);
    w.simulator->stranger(Channel::Command, std::to_string(i), w.now);
  }
  EXPECT_NEAR(static_cast<double>(w.count(Channel::Event)), 10 + 10 * 5, 12);
}

TEST(RealtimeSimulatorRole, AResetEndsTheRunWithAWordAboutIt) {
  World w;
  w.run_to(1'000'000 + 10 * kDt);
  EXPECT_TRUE(w.request("pause", 1).ok);
  const reply_t reply = w.request("reset", 2);
  EXPECT_TRUE(reply.ok);
  EXPECT_EQ(reply.step, 11);
  EXPECT_TRUE(w.simulator->restart_requested());
  w.run_to(w.now + 200 * kDt);
  const auto event = decode<event_t>(w.last(Channel::Event));
  EXPECT_EQ(event.what, "reset");
  EXPECT_EQ(event.who, "me");
  const auto end = decode<end_t>(w.last(Channel::End));
  EXPECT_EQ(end.step, 11);
  EXPECT_FALSE(end.aborted);
  EXPECT_TRUE(w.request("reset", 2).ok) << "asked again, answered again";
  EXPECT_FALSE(w.request("goal", 3).ok) << "the run is ending";
}

TEST(RealtimeSimulatorRole, AResetThatNobodyWouldFollowIsRefused) {
  World w("no supervisor");
  w.run_to(1'000'000 + 10 * kDt);
  const reply_t reply = w.request("reset", 1);
  EXPECT_FALSE(reply.ok);
  EXPECT_EQ(reply.reason, "no supervisor");
  w.run_to(w.now + 20 * kDt);
  EXPECT_EQ(w.simulator->step(), 30) << "the run goes on";
  EXPECT_FALSE(w.simulator->restart_requested());
}

TEST(RealtimeSimulatorRole, AFloodOfBadCommandsGetsOneEventInAHundredSteps) {
  World w;
  for (int i = 0; i < 1000; ++i) {
    w.run_to(w.now + kDt);
    w.simulator->refused({Channel::Command, 0, true, "COMMAND: tau[0] is nan"}, w.now);
  }
  EXPECT_NEAR(static_cast<double>(w.count(Channel::Event)), 10, 1);
  EXPECT_FALSE(w.simulator->outcome().ended);
}

TEST(RealtimeSimulatorRole, EndsWithALastWordThatTheLoggerConfirms) {
  World w;
  w.run_to(1'000'000 + 10 * kDt);
  w.simulator->stop(w.now);
  EXPECT_EQ(w.simulator->state(), "STOPPING");
  EXPECT_FALSE(w.simulator->outcome().ended);
  ack_t ack{};
  ack.run = 77;
  ack.process = kLogger;
  ack.closed = true;
  w.simulator->receive(Channel::Ack, encode(ack), w.now);
  w.simulator->tick(w.now);
  EXPECT_TRUE(w.simulator->outcome().ended);
  EXPECT_EQ(w.simulator->outcome().exit_code, kOk);
  EXPECT_EQ(decode<end_t>(w.last(Channel::End)).step, 10);
}

// every time is in the bin that says so, and no bin is wider than a quarter of its time
TEST(LoopBins, EachTimeHasItsBin) {
  for (int64_t us = 0; us < loop_bin_start(kLoopBins); us += 1 + us / 50) {
    const int bin = loop_bin(us);
    ASSERT_LE(loop_bin_start(bin), us);
    ASSERT_GT(loop_bin_start(bin + 1), us);
  }
  for (int bin = 1; bin < kLoopBins; ++bin) {
    EXPECT_EQ(loop_bin(loop_bin_start(bin)), bin);
    EXPECT_EQ(loop_bin(loop_bin_start(bin) - 1), bin - 1);
    EXPECT_LE(loop_bin_start(bin + 1) - loop_bin_start(bin), std::max<int64_t>(1, loop_bin_start(bin) / 4));
  }
  EXPECT_EQ(loop_bin(-5), 0);
  EXPECT_EQ(loop_bin(int64_t{1} << 60), kLoopBins - 1);
}

TEST(Lateness, QuantilesOfAKnownSample) {
  Lateness late;
  EXPECT_EQ(late.quantile(0.5), 0);
  for (int us = 0; us < 1000; ++us) late.add(us);
  late.add(50'000);
  EXPECT_EQ(late.quantile(0.5), 500);
  EXPECT_EQ(late.quantile(0.99), 990);
  EXPECT_EQ(late.longest(), 50'000);
  EXPECT_EQ(late.ticks(), 1001);
}

}  // namespace
}  // namespace lab::test
