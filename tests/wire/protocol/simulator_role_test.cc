// What both simulators do with messages that come at the wrong time.
#include "wire/protocol/simulator_role.h"

#include <gtest/gtest.h>

#include <lab/ack_t.hpp>
#include <lab/command_t.hpp>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/request_t.hpp>
#include <lab/robot_state_t.hpp>
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
    config_.run = encode(message_of<run_t>(kRun, kBeforeStart));
    config_.types = {type("lab.a_t"), type("lab.b_t")};
    config_.run_id = kRun;
    config_.model_hash = kModel;
    config_.nq = config_.nv = 1;
    config_.dt = 1e-3;
    config_.last_step = 1000;
    config_.why_not = [this](const Action&, const Reference* newest) {
      goal_from_ = newest ? newest->step : kBeforeStart;
      return std::string();
    };
    make();
  }
  /// A simulator anew, as config_ says.
  void make() {
    simulator_ = std::make_unique<RoleOfClock>(
        config_,
        [this](int64_t step, const Command* command, std::span<const Action>) {
          if (command) tau_ = command->tau[0];
          const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
          return StepResult{{step, 0, zero, zero, zero}, events_, ""};
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
  void request(const char* verb, int64_t id, Micros now = 0) {
    auto m = message_of<request_t>(kRun, kBeforeStart);
    m.sender = "me";
    m.id = id;
    m.action.verb = verb;
    simulator_->receive(Channel::Request, encode(m), now);
  }
  void reference(int64_t step) {
    auto m = message_of<reference_t>(kRun, step);
    m.nq = m.nv = 1;
    m.q = m.v = m.a = {0};
    simulator_->receive(Channel::Reference, encode(m), 0);
  }
  void command(int64_t step, double tau = 0) {
    auto m = message_of<command_t>(kRun, step);
    m.state_step = step;
    m.nv = 1;
    m.tau = {tau};
    simulator_->receive(Channel::Command, encode(m), 0);
  }
  int64_t count(Channel channel) const {
    return std::count_if(sent_.begin(), sent_.end(), [&](const auto& m) { return m.first == channel; });
  }

  SimulatorConfig config_;
  std::unique_ptr<SimulatorRole> simulator_;
  std::vector<std::pair<Channel, Bytes>> sent_;
  int64_t said_ = 0, goal_from_ = -2;
  double tau_ = 0;             ///< of the last command that was used
  std::vector<Event> events_;  ///< of each step
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
  static_assert(SimulatorRole::kIntroduce == 150'000);
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

// What a goal's way begins with is not known better: the reference that reaches farthest ahead.
TYPED_TEST(EitherSimulator, AGoalIsCheckedFromTheNewestReference) {
  this->start();
  this->request("goal", 1);
  EXPECT_EQ(this->goal_from_, kBeforeStart) << "there is none yet";
  this->reference(0);
  this->request("goal", 2);
  EXPECT_EQ(this->goal_from_, 0);
  this->command(0);
  this->simulator_->tick(1000);
  ASSERT_EQ(this->simulator_->step(), 1);
  this->reference(1);
  this->reference(0);  // comes late
  this->request("goal", 3);
  EXPECT_EQ(this->goal_from_, 1);
}

// Processes that say every 0.1 s that they are at the same step do not make progress, nor does who asks for something.
TYPED_TEST(EitherSimulator, ReadyAgainAndAgainIsNoProgress) {
  Micros now = 0;
  for (; now <= 10'000'000; now += kRepeat) {
    this->process(kPlanner);
    this->process(kController);
    this->request("goal", now, now);
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

TEST_F(LockstepSimulator, TheFirstAnswerCounts) {
  start();
  command(0, 1.5);
  command(0, 2.5);
  reference(0);
  EXPECT_EQ(simulator_->step(), 1);
  EXPECT_EQ(tau_, 1.5);
  EXPECT_EQ(simulator_->late(), 0);
  command(0, 2.5);
  EXPECT_EQ(simulator_->late(), 1);
}

TEST_F(LockstepSimulator, AsksPlannerAndControllerForTheirAnswers) {
  start();
  sent_.clear();
  simulator_->tick(kFirstWait);
  std::vector<std::string> asked;
  for (const auto& [channel, bytes] : sent_) {
    ASSERT_EQ(channel, Channel::Need);
    const auto m = decode<need_t>(bytes);
    EXPECT_EQ(m.step, 0);
    asked.push_back(m.process);
  }
  EXPECT_EQ(asked, (std::vector<std::string>{kPlanner, kController}));
  reference(0);
  sent_.clear();
  simulator_->tick(kLongestWait);
  ASSERT_EQ(sent_.size(), 1u);
  EXPECT_EQ(decode<need_t>(sent_[0].second).process, kController);
}

TEST_F(LockstepSimulator, ExtrasAreSentBeforeTheMainMessageThatCountsThem) {
  events_ = {{"one", "me", "why"}, {"two", "me", "why"}};
  start();
  request("goal", 1);
  sent_.clear();
  reference(0);
  command(0);
  events_.clear();
  ASSERT_EQ(sent_.size(), 3u) << "INPUT was sent when it was accepted";
  EXPECT_EQ(sent_[0].first, Channel::Event);
  EXPECT_EQ(decode<event_t>(sent_[0].second).index, 0);
  EXPECT_EQ(decode<event_t>(sent_[1].second).index, 1);
  EXPECT_EQ(decode<event_t>(sent_[1].second).step, 1);
  ASSERT_EQ(sent_[2].first, Channel::RobotState);
  EXPECT_EQ(decode<robot_state_t>(sent_[2].second).extras, 3);
  sent_.clear();
  need(1, 1'000'000);  // sent again, in the same order
  ASSERT_EQ(sent_.size(), 4u);
  EXPECT_EQ(sent_[0].first, Channel::Input);
  EXPECT_EQ(sent_[3].first, Channel::RobotState);
}

// Counted from the newest REFERENCE, here two steps ahead of the state.
TEST_F(LockstepSimulator, KeepsTheBytesOf512Steps) {
  static_assert(kWindow == 256);
  config_.lead = 2;
  make();
  start();
  for (int64_t step = 0; step < 600; ++step) {
    if (step == 0) reference(0), reference(1);
    reference(step + 2);
    command(step);
    auto ack = message_of<ack_t>(kRun, step);
    ack.process = kLogger;
    ack.complete_to = step;
    simulator_->receive(Channel::Ack, encode(ack), 0);
  }
  ASSERT_EQ(simulator_->step(), 600);
  for (const int64_t step : {599, 601 - 511}) {
    sent_.clear();
    need(step, 1'000'000);
    EXPECT_EQ(sent_.size(), 3u) << step;
  }
  sent_.clear();
  need(601 - 512, 1'000'000);
  EXPECT_TRUE(sent_.empty());
}

// The missed ticks of a standstill are skipped, those of a shorter one made up for.
using RealtimeSimulator = EitherSimulator<RealtimeSimulatorRole>;
TEST_F(RealtimeSimulator, MoreThan100MsLateIsAStandstill) {
  EXPECT_GT(simulator_->urgency(), 0);
  for (const Micros late : {100'000, 100'001}) {
    make();
    start();
    Micros now = 1000 + late;  // the tick of step 1 is due at 1000
    for (int n = 0; n < 20; ++n) simulator_->tick(now);
    EXPECT_EQ(simulator_->step(), late > 100'000 ? 1 : 101) << late;
  }
}

}  // namespace
}  // namespace lab
