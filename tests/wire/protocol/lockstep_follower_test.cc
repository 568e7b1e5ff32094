// The controller in lockstep, alone with messages made by hand: what it answers, and when it answers again.
#include <gtest/gtest.h>

#include <lab/command_t.hpp>
#include <lab/need_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>

#include "tests/wire/protocol/message.h"
#include "wire/protocol/controller_role.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

constexpr int64_t kRun = 42;

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

  std::vector<int64_t> answered;  ///< steps of the COMMANDs, as they were sent
  ControllerRole controller{FollowerConfig{10'000'000, 10'000'000, {}},
                            [](const run_t&) {
                              RunSetup setup;
                              setup.nq = setup.nv = 1;
                              setup.dt = 1e-3;
                              setup.last_step = 10'000;
                              return setup;
                            },
                            [](const RobotState&, const Reference&, std::span<const Action>,
                               std::vector<Event>&) { return Command{Eigen::VectorXd::Zero(1)}; },
                            [this](Channel channel, std::span<const uint8_t> bytes) {
                              if (channel == Channel::Command)
                                answered.push_back(decode<command_t>(bytes).step);
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
