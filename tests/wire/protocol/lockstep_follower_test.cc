// Controller and planner in lockstep, alone with messages made by hand: what they answer, when they answer again, and when they ask.
#include <gtest/gtest.h>

#include <lab/command_t.hpp>
#include <lab/event_t.hpp>
#include <lab/need_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <numeric>

#include "tests/wire/protocol/message.h"
#include "wire/protocol/controller_role.h"
#include "wire/protocol/planner_role.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

constexpr int64_t kRun = 42;

RunSetup setup(const run_t&) {
  RunSetup s;
  s.nq = s.nv = 1;
  s.dt = 1e-3;
  s.last_step = 10'000;
  return s;
}

/// A controller that knows the run.
struct Bench {
  Bench() { controller.receive(Channel::Run, encode(message_of<run_t>(kRun, kBeforeStart)), 0); }

  void state(int64_t step, Micros now = 0) {
    auto m = message_of<robot_state_t>(kRun, step);
    m.nq = m.nv = 1;
    m.q = m.v = m.tau = {0};
    controller.receive(Channel::RobotState, encode(m), now);
  }
  void reference(int64_t step, Micros now = 0) {
    auto m = message_of<reference_t>(kRun, step);
    m.nq = m.nv = 1;
    m.q = m.v = m.a = {0};
    controller.receive(Channel::Reference, encode(m), now);
  }
  void need(int64_t step, Micros now) {
    auto m = message_of<need_t>(kRun, step);
    m.process = kController;
    m.sender = kSimulator;
    controller.receive(Channel::Need, encode(m), now);
  }

  /// When it asks for this step, if it is looked at every 0.1 ms.
  std::vector<Micros> asks(int64_t step, Micros until) {
    std::vector<Micros> times;
    for (Micros now = 0; now <= until; now += 100) {
      sent.clear();
      controller.tick(now);
      for (const auto& [channel, bytes] : sent) {
        const auto m = decode<need_t>(bytes);
        EXPECT_TRUE(channel == Channel::Need && m.process == kSimulator && m.sender == kController);
        if (m.step == step) times.push_back(now);
      }
    }
    return times;
  }

  std::vector<int64_t> answered;  ///< steps of the COMMANDs, as they were sent
  std::vector<std::pair<Channel, Bytes>> sent;
  std::vector<Event> events;  ///< of each answer
  int computed = 0;           ///< answers
  ControllerRole controller{
      FollowerConfig{10'000'000, 10'000'000, {}}, setup,
      [this](const RobotState&, const Reference&, std::span<const Action>, std::vector<Event>& out) {
        ++computed;
        out = events;
        return Command{Eigen::VectorXd::Zero(1)};
      },
      [this](Channel channel, std::span<const uint8_t> bytes) {
        sent.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
        if (channel == Channel::Command) answered.push_back(decode<command_t>(bytes).step);
      }};
};

// The simulator's NEED may come twice within the time that an answer takes.
TEST(LockstepFollower, AnswersAgainAfterHalfTheTimeOfAQuestion) {
  Bench bench;
  bench.state(0);
  bench.reference(0);
  EXPECT_EQ(bench.answered, std::vector<int64_t>{0});
  const Micros asked = 1'000'000;
  bench.need(0, asked);
  bench.need(0, asked + kFirstWait / 2 - 1);
  EXPECT_EQ(bench.answered, (std::vector<int64_t>{0, 0}));
  bench.need(0, asked + kFirstWait / 2);
  EXPECT_EQ(bench.answered, (std::vector<int64_t>{0, 0, 0}));
  bench.need(1, 2 * asked);
  EXPECT_EQ(bench.answered.size(), 3u) << "there is no answer to step 1";
  EXPECT_EQ(bench.computed, 1) << "the stored bytes were sent";
}

TEST(LockstepFollower, KeepsItsLastAnswers) {
  Bench bench;
  for (int64_t step = 0; step < 10; ++step) bench.state(step), bench.reference(step);
  bench.answered.clear();
  for (int64_t step = 0; step < 10; ++step) bench.need(step, 1'000'000);
  EXPECT_EQ(bench.answered, (std::vector<int64_t>{7, 8, 9})) << "max(lead 0, every 1) + 2";
}

TEST(LockstepFollower, AsksTheSimulatorAfter1MsThenAfterTwiceAsLong) {
  Bench bench;
  EXPECT_EQ(bench.asks(0, 400'000), (std::vector<Micros>{1'000, 2'000, 4'000, 8'000, 16'000, 32'000, 64'000,
                                                         128'000, 228'000, 328'000}));
  bench.state(0, 400'000);
  bench.reference(0, 400'000);
  bench.sent.clear();
  bench.controller.tick(400'999);
  EXPECT_TRUE(bench.sent.empty());
  bench.controller.tick(401'000);
  EXPECT_EQ(bench.sent.size(), 1u) << "an answer is progress: it begins with 1 ms again";
}

TEST(LockstepFollower, AsksAtOnceWhenALaterStateShowsTheGap) {
  Bench bench;
  bench.state(0, 10);
  bench.reference(0, 10);
  bench.sent.clear();
  bench.controller.tick(20);
  EXPECT_TRUE(bench.sent.empty());
  bench.state(2, 20);
  bench.controller.tick(20);
  ASSERT_EQ(bench.sent.size(), 1u);
  EXPECT_EQ(decode<need_t>(bench.sent[0].second).step, 1);
}

TEST(LockstepFollower, ExtrasAreSentBeforeTheMainMessageThatCountsThem) {
  Bench bench;
  bench.events = {{"one", "me", "why"}, {"two", "me", "why"}};
  bench.state(0);
  bench.sent.clear();
  bench.reference(0);
  ASSERT_EQ(bench.sent.size(), 3u);
  for (size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(bench.sent[i].first, Channel::Event);
    EXPECT_EQ(decode<event_t>(bench.sent[i].second).index, static_cast<int64_t>(i));
    EXPECT_EQ(decode<event_t>(bench.sent[i].second).step, 0);
  }
  EXPECT_EQ(decode<command_t>(bench.sent[2].second).extras, 2);
}

// So that its answers are there before they are needed.
TEST(LockstepPlanner, IsAheadByItsLead) {
  for (const int64_t lead : {0, 3, 15, 16}) {
    std::vector<int64_t> planned;
    PlannerRole planner(
        {10'000'000, 10'000'000, {}},
        [lead](const run_t& run) {
          RunSetup s = setup(run);
          s.lead = lead;
          return s;
        },
        [](int64_t step, const PlanInput&, std::vector<Event>&) {
          const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
          return Reference{step, zero, zero, zero};
        },
        [&](Channel channel, std::span<const uint8_t> bytes) {
          ASSERT_EQ(channel, Channel::Reference);
          planned.push_back(decode<reference_t>(bytes).step);
        });
    planner.receive(Channel::Run, encode(message_of<run_t>(kRun, kBeforeStart)), 0);
    EXPECT_EQ(static_cast<int64_t>(planned.size()), lead);
    for (int64_t step = 0; step < 3; ++step) {
      auto state = message_of<robot_state_t>(kRun, step);
      state.nq = state.nv = 1;
      state.q = state.v = state.tau = {0};
      planner.receive(Channel::RobotState, encode(state), 0);
    }
    std::vector<int64_t> all(static_cast<size_t>(lead + 3));
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(planned, all);
    EXPECT_EQ(planner.batch() > 0, lead >= 16);
  }
}

// A message from far ahead must not take the place of the one that is waited for, and is not late.
TEST(LockstepFollower, WhatIsFarAheadIsLeftOut) {
  Bench bench;
  bench.state(0);
  for (int64_t step = 2; step <= 10'000; ++step) bench.state(step);
  bench.reference(0);
  EXPECT_EQ(bench.answered, std::vector<int64_t>{0});
  EXPECT_EQ(bench.controller.late(), 0);
  bench.state(0);
  EXPECT_EQ(bench.controller.late(), 1);
}

}  // namespace
}  // namespace lab
