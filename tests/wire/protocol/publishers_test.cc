// Who may publish what: each rule of docs/safety.md, "Whose message", with addresses made of numbers.
#include "wire/protocol/publishers.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>

#include "wire/protocol/reply_cache.h"

namespace lab::test {
namespace {

constexpr int64_t kNonce = 42;
constexpr uint64_t kSim = 100, kPlan = 200, kCtrl = 300, kThief = 999;

/// The view of one process of the launch, to which the others are known.
Publishers known_to(const std::string& own) {
  Publishers publishers(own, kNonce, {});
  const std::pair<const char*, uint64_t> all[] = {
      {kSimulator, kSim}, {kPlanner, kPlan}, {kController, kCtrl}};
  for (const auto& [name, address] : all)
    if (name != own) {
      EXPECT_EQ(publishers.process(name, kNonce, address, 0), "");
    }
  return publishers;
}

TEST(Publishers, EveryChannelHasAnOwnerOrNamesOneOrIsForAll) {
  for (const ChannelRow& channel : kChannelTable) {
    const bool owned = !Publishers::owner_of(channel.id).empty();
    const bool named = channel.publisher != Publisher::Named && channel.publisher != Publisher::Anybody &&
                       channel.publisher != Publisher::Nobody;
    EXPECT_EQ(owned, named) << channel.name;
  }
  std::map<std::string_view, std::string> of;
  for (const ChannelRow& channel : kChannelTable) {
    const std::string_view owner = Publishers::owner_of(channel.id);
    const std::string_view who = channel.publisher == Publisher::Named     ? "named"
                                 : channel.publisher == Publisher::Anybody ? "anybody"
                                                                           : owner;
    of[who] += std::string(channel.name) + " ";
  }
  EXPECT_EQ(of,
            (std::map<std::string_view, std::string>{{kSimulator, "RUN TYPE ROBOT_STATE REPLY INPUT END "},
                                                     {kPlanner, "REFERENCE "},
                                                     {kController, "COMMAND "},
                                                     {kRenderer, "FRAME "},
                                                     {"named", "EVENT ACK NEED PROCESS "},
                                                     {"anybody", "REQUEST "},
                                                     {"", "CHECK "}}));
}

TEST(Publishers, OnlyThePinnedAddressCounts) {
  Publishers logger = known_to(kLogger);
  EXPECT_EQ(logger.message(Channel::RobotState, kSimulator, kSim, 1), "");
  EXPECT_EQ(logger.message(Channel::RobotState, kSimulator, kThief, 1),
            "0.0.0.0:999 is not this lab's simulator");
  EXPECT_EQ(logger.message(Channel::Command, kController, kCtrl, 1), "");
  EXPECT_NE(logger.message(Channel::Command, kController, kThief, 1), "");
  EXPECT_NE(logger.message(Channel::Command, kController, kPlan, 1), "") << "the planner is no controller";
  EXPECT_NE(logger.message(Channel::Event, "planner", kCtrl, 1), "") << "under its own name only";
  EXPECT_NE(logger.message(Channel::Ack, "logger", kCtrl, 1), "");
  Publishers nobody_yet(kLogger, kNonce, {});
  EXPECT_NE(nobody_yet.message(Channel::RobotState, kSimulator, kSim, 0), "") << "not before its PROCESS";
}

TEST(Publishers, TheSimulatorRepairsForOthersButTakesAnswersFromTheirOwnersAlone) {
  Publishers logger = known_to(kLogger), simulator = known_to(kSimulator);
  for (Channel channel : {Channel::Reference, Channel::Command, Channel::Event})
    EXPECT_EQ(logger.message(channel, kController, kSim, 1), "");
  EXPECT_NE(logger.message(Channel::Ack, kController, kSim, 1), "");
  EXPECT_NE(simulator.message(Channel::Command, kController, kSim, 1), "");
}

TEST(Publishers, AnotherLaunchsProcessesAreStrangers) {
  Publishers planner = known_to(kPlanner);
  EXPECT_EQ(planner.process(kLogger, kNonce + 1, kThief, 0), "0.0.0.0:999 is the logger of another lab");
  EXPECT_EQ(planner.process(kLogger, kNonce, 400, 0), "");
  EXPECT_NE(planner.process(kPlanner, kNonce, kThief, 0), "") << "our own name";
  planner.set_own_address(kPlan);
  EXPECT_EQ(planner.process(kPlanner, kNonce, kPlan, 0), "") << "our own words, where we hear ourselves";
  EXPECT_NE(planner.process(kPlanner, kNonce, kThief, 60'000'000), "");
}

TEST(Publishers, ARestartedProcessTakesItsNameOverWhenTheOldOneIsSilent) {
  static_assert(Publishers::kSilence == 300'000);
  Publishers simulator = known_to(kSimulator);
  EXPECT_EQ(simulator.message(Channel::Command, kController, kCtrl, 1'000'000), "");
  EXPECT_EQ(simulator.process(kController, kNonce, 301, 1'000'000 + Publishers::kSilence - 1),
            "0.0.0.0:301 is a second controller");
  EXPECT_EQ(simulator.process(kController, kNonce, 301, 1'000'000 + Publishers::kSilence), "");
  EXPECT_NE(simulator.message(Channel::Command, kController, kCtrl, 1'400'000), "") << "the old one is out";
  EXPECT_EQ(simulator.message(Channel::Command, kController, 301, 1'400'000), "");
  // the simulator is never replaced within a launch
  Publishers planner = known_to(kPlanner);
  EXPECT_NE(planner.process(kSimulator, kNonce, kThief, 60'000'000), "");
}

// The supervisor's record is believed before what a message says of itself: a stolen nonce is worth nothing.
TEST(Publishers, TheSupervisorsRecordDecidesWhereThereIsOne) {
  int asked = 0;
  Publishers planner(kPlanner, kNonce, {}, [&](const std::string& name, uint64_t address) {
    ++asked;
    if (name == "guest") return Claim::Unknown;
    return (name == kSimulator && address == kSim) || (name == kController && address == 301)
               ? Claim::Ours
               : Claim::Stranger;
  });
  EXPECT_EQ(planner.process(kSimulator, kNonce, kThief, 0),
            "0.0.0.0:999 is not the simulator that the supervisor started");
  EXPECT_EQ(asked, 1);
  for (int i = 0; i < 1000; ++i) EXPECT_NE(planner.process(kSimulator, kNonce, kThief, i), "");
  EXPECT_EQ(asked, 1) << "a flood is not looked up again and again";
  EXPECT_EQ(planner.process(kSimulator, kNonce, kSim, 1000), "");
  EXPECT_NE(planner.process(kController, kNonce, kCtrl, 1000), "") << "of an earlier start";
  EXPECT_EQ(planner.process(kController, kNonce, 301, 1001), "");
  EXPECT_NE(planner.process(kController, kNonce, kCtrl, 10'000'000), "");
  EXPECT_EQ(planner.process("guest", kNonce, 400, 10'000'000), "");
  EXPECT_NE(planner.process("guest", kNonce, 401, 10'000'001), "")
      << "silence counts where there is no record";
  const int before = asked;
  const Micros later = 20'000'000;
  for (Micros t = 0; t < Publishers::kAskAgain; t += 1000)
    EXPECT_NE(planner.process(kController, kNonce, kThief, later + t), "");
  EXPECT_EQ(asked, before + 1) << "a flood, at any time";
  EXPECT_NE(planner.process(kController, kNonce, kThief, later + Publishers::kAskAgain), "");
  EXPECT_EQ(asked, before + 2) << "the supervisor may have started it meanwhile";
}

TEST(Publishers, ARestartThatTheRecordShowsNeedsNoSilence) {
  uint64_t recorded = kCtrl;
  Publishers simulator(kSimulator, kNonce, {}, [&](const std::string&, uint64_t address) {
    return address == recorded ? Claim::Ours : Claim::Stranger;
  });
  EXPECT_EQ(simulator.process(kController, kNonce, kCtrl, 0), "");
  recorded = 301;
  EXPECT_EQ(simulator.process(kController, kNonce, 301, 1), "");
  EXPECT_NE(simulator.message(Channel::Command, kController, kCtrl, 2), "");
}

TEST(Publishers, AGuestNeedsNoNonceAndTheFirstOneIsPinned) {
  Publishers simulator(kSimulator, kNonce, {kController});
  EXPECT_NE(simulator.process(kPlanner, 0, kPlan, 0), "") << "not invited";
  EXPECT_EQ(simulator.process(kController, 0, kCtrl, 0), "");
  EXPECT_EQ(simulator.message(Channel::Command, kController, kCtrl, 1'000'000), "");
  EXPECT_NE(simulator.process(kController, 0, kThief, 1'000'000 + Publishers::kSilence - 1), "");
  EXPECT_EQ(simulator.message(Channel::Command, kController, kCtrl, 1'300'000), "");
}

TEST(Publishers, AGuestThatDiedIsReplacedByTheNextAndAProcessOfTheLabIsNot) {
  Publishers simulator(kSimulator, kNonce, {kController});
  EXPECT_EQ(simulator.process(kController, 0, kCtrl, 0), "");
  EXPECT_EQ(simulator.process(kController, 0, 301, Publishers::kSilence), "");
  EXPECT_NE(simulator.message(Channel::Command, kController, kCtrl, Publishers::kSilence), "");

  EXPECT_EQ(simulator.process(kController, kNonce, 302, 2 * Publishers::kSilence), "");
  EXPECT_NE(simulator.process(kController, 0, kThief, 60'000'000), "")
      << "it knows the nonce, and so does the next";
}

TEST(Publishers, WithoutAddressesOnlyTheNonceIsCompared) {
  Publishers simulator(kSimulator, kNonce, {});
  EXPECT_EQ(simulator.process(kController, kNonce, 0, 0), "");
  EXPECT_NE(simulator.process(kController, kNonce + 1, 0, 0), "");
  EXPECT_EQ(simulator.message(Channel::Command, kController, 0, 0), "");
}

TEST(Publishers, NamesAreBounded) {
  Publishers planner = known_to(kPlanner);
  size_t taken = 2;
  for (int i = 0; i < 1000; ++i)
    taken += planner.process("p" + std::to_string(i), kNonce, 1000 + static_cast<uint64_t>(i), 0).empty();
  EXPECT_EQ(taken, Publishers::kMaxNames);
}

TEST(ReplyCache, ARepeatedRequestGetsItsReplyAgainAndAnOlderOneIsStale) {
  ReplyCache cache;
  EXPECT_EQ(cache.look_up("a", 5, false, 0).refusal, "");
  cache.remember("a", 5, {1, 2}, 0);
  const auto again = cache.look_up("a", 5, false, 1);
  ASSERT_NE(again.reply, nullptr);
  EXPECT_EQ(*again.reply, (Bytes{1, 2}));
  EXPECT_EQ(cache.look_up("a", 4, false, 1).refusal, "request 4 is stale: 5 came before it");
  EXPECT_EQ(cache.look_up("a", 4, true, 1).refusal, "") << "an estop is never stale";
  EXPECT_EQ(cache.look_up("a", 6, false, 1).refusal, "");
  EXPECT_EQ(cache.look_up("b", 1, false, 1).refusal, "") << "each sender counts for itself";
}

TEST(ReplyCache, IsBoundedAndForgetsTheSilent) {
  static_assert(ReplyCache::kMaxSenders == 4096 && ReplyCache::kForget == 10'000'000);
  ReplyCache cache;
  const auto name = [](size_t i) { return "sender" + std::to_string(i); };
  for (size_t i = 0; i < ReplyCache::kMaxSenders; ++i) cache.remember(name(i), 1, {1}, 0);
  EXPECT_EQ(cache.look_up("late", 1, false, 1).refusal, "busy with 4096 other senders: try again");
  EXPECT_EQ(cache.look_up("late", 1, true, 1).refusal, "") << "an estop makes room";
  cache.remember("late", 1, {1}, 1);
  EXPECT_EQ(cache.size(), ReplyCache::kMaxSenders);
  cache.look_up(name(7), 1, false, 9'000'000);
  EXPECT_EQ(cache.look_up("new", 1, false, ReplyCache::kForget + 1'000'000).refusal, "");
  EXPECT_EQ(cache.size(), 1u) << "only the one that was heard lately";
}

}  // namespace
}  // namespace lab::test
