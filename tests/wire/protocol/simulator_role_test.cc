// What both simulators do with messages that come at the wrong time.
#include "wire/protocol/simulator_role.h"

#include <gtest/gtest.h>

#include <lab/end_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <lab/request_t.hpp>
#include <lab/run_t.hpp>
#include <lab/type_t.hpp>

#include "tests/wire/protocol/message.h"
#include "wire/protocol/lockstep_simulator.h"
#include "wire/protocol/realtime_simulator.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

constexpr int64_t kRun = 77, kModel = 5;

/// A simulator of either clock whose robot stands still.
template <class RoleOfClock>
class EitherSimulator : public testing::Test {
 protected:
  EitherSimulator() {
    SimulatorConfig config;
    config.run = encode(message_of<run_t>(kRun, kBeforeStart));
    config.types = {type("lab.a_t"), type("lab.b_t")};
    config.run_id = kRun;
    config.model_hash = kModel;
    config.nq = config.nv = 1;
    config.dt = 1e-3;
    config.last_step = 1000;
    simulator_ = std::make_unique<RoleOfClock>(
        config,
        [](int64_t step, const Command*, std::span<const Action>) {
          const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
          return StepResult{{step, 0, zero, zero, zero}, {}, ""};
        },
        [this](Channel channel, std::span<const uint8_t> bytes) {
          sent_.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
        });
    simulator_->tick(0);
  }
  static Bytes type(const char* name) {
    auto m = message_of<type_t>(kRun, kBeforeStart);
    m.name = name;
    return encode(m);
  }
  void process(const char* name, int64_t model_hash = kModel) {
    auto m = message_of<process_t>(kRun, kBeforeStart);
    m.utime = ++said_;
    m.name = name;
    m.pid = 1;
    m.state = "READY";
    m.model_hash = model_hash;
    simulator_->receive(Channel::Process, encode(m), 0);
  }
  void start() {
    for (const char* name : {kPlanner, kController, kLogger}) process(name);
  }
  void need(int64_t step, Micros now) {
    auto m = message_of<need_t>(kRun, step);
    m.process = kSimulator;
    m.sender = kController;
    simulator_->receive(Channel::Need, encode(m), now);
  }
  int64_t count(Channel channel) const {
    return std::count_if(sent_.begin(), sent_.end(), [&](const auto& m) { return m.first == channel; });
  }

  std::unique_ptr<SimulatorRole> simulator_;
  std::vector<std::pair<Channel, Bytes>> sent_;
  int64_t said_ = 0;
};
using Clocks = testing::Types<LockstepSimulatorRole, RealtimeSimulatorRole>;
TYPED_TEST_SUITE(EitherSimulator, Clocks);

// A process may restart with another model while the run goes on.
TYPED_TEST(EitherSimulator, AnotherModelEndsARunThatGoesOn) {
  this->start();
  ASSERT_EQ(this->simulator_->state(), "RUNNING");
  this->process(kController, kModel + 1);
  EXPECT_EQ(this->simulator_->state(), "FAULT");
  ASSERT_EQ(this->sent_.back().first, Channel::End);
  EXPECT_EQ(decode<end_t>(this->sent_.back().second).reason,
            "controller has another model: hash 0000000000000006, the simulator's is 0000000000000005");
}

TYPED_TEST(EitherSimulator, SendsRunAgainToWhoAsksForItAlone) {
  this->start();
  const int64_t before = this->count(Channel::Run);
  this->need(0, 1'000'000);
  this->need(7, 1'000'000);
  EXPECT_EQ(this->count(Channel::Run), before);
  this->need(kBeforeStart, 1'000'000);
  this->need(kBeforeStart, 1'000'000 + SimulatorRole::kRunAgain - 1);
  EXPECT_EQ(this->count(Channel::Run), before + 1) << "not to a flood";
  this->need(kBeforeStart, 1'000'000 + SimulatorRole::kRunAgain);
  EXPECT_EQ(this->count(Channel::Run), before + 2);
}

// A program that joins at any time has RUN and every TYPE soon after; the run does not wait for that, and no tick has more to
// send than one message.
TYPED_TEST(EitherSimulator, RepeatsRunAndEveryTypeInTurn) {
  this->start();
  std::vector<Bytes> turn;
  for (Micros now = 0; now <= 20 * SimulatorRole::kIntroduce; now += SimulatorRole::kIntroduce / 3) {
    const int64_t before = this->count(Channel::Run) + this->count(Channel::Type);
    this->simulator_->tick(now);
    const int64_t more = this->count(Channel::Run) + this->count(Channel::Type) - before;
    ASSERT_LE(more, 1);
    for (const auto& [channel, bytes] : this->sent_)
      if (more == 1 && (channel == Channel::Run || channel == Channel::Type)) turn.push_back(bytes);
    this->sent_.clear();
  }
  ASSERT_EQ(turn.size(), 20u);
  const Bytes run = encode(message_of<run_t>(kRun, kBeforeStart));
  const std::vector<Bytes> wanted{run, this->type("lab.a_t"), this->type("lab.b_t")};
  for (size_t i = 0; i < turn.size(); ++i) EXPECT_EQ(turn[i], wanted[i % 3]) << i;
  this->process(kController, kModel + 1);  // which ends it
  this->sent_.clear();
  for (Micros now = 4'000'000; now < 6'000'000; now += kRepeat) this->simulator_->tick(now);
  EXPECT_EQ(this->count(Channel::Run) + this->count(Channel::Type), 0) << "the run is over";
}

TYPED_TEST(EitherSimulator, ARequestOfANameThatIsTooLongIsCountedAndNotAnswered) {
  this->start();
  auto request = message_of<request_t>(kRun, kBeforeStart);
  request.action.verb = "pause";
  for (const size_t length : {SimulatorRole::kMaxSender, SimulatorRole::kMaxSender + 1}) {
    request.sender = std::string(length, 'x');
    this->simulator_->receive(Channel::Request, encode(request), 0);
  }
  EXPECT_EQ(this->count(Channel::Reply), 1);
  EXPECT_EQ(this->simulator_->late(), 1);
}

// Processes that say every 0.1 s that they are at the same step do not make progress.
TYPED_TEST(EitherSimulator, ReadyAgainAndAgainIsNoProgress) {
  Micros now = 0;
  for (; now <= 10'000'000; now += kRepeat) {
    this->process(kPlanner);
    this->process(kController);
    this->simulator_->tick(now);
    ASSERT_EQ(this->simulator_->state(), "READY");
  }
  this->simulator_->tick(now);
  EXPECT_EQ(this->simulator_->state(), "FAULT");
}

// A plain LCM program does not know NEED: it hears the state once more.
using LockstepSimulator = EitherSimulator<LockstepSimulatorRole>;
TEST_F(LockstepSimulator, RepeatsTheStateWithEveryThirdQuestion) {
  start();
  std::vector<int64_t> states;
  for (int n = 1; n <= 7; ++n) {
    simulator_->tick(n * kLongestWait);
    EXPECT_EQ(count(Channel::Need), 2 * n) << "to planner and controller";
    states.push_back(count(Channel::RobotState));
  }
  EXPECT_EQ(states, (std::vector<int64_t>{1, 1, 2, 2, 2, 3, 3}));
}

}  // namespace
}  // namespace lab
