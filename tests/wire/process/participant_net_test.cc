// The shell around the simulator on a real bus, where it is told who sends: what a program that is no part of the run may say.
// Runs in a private network namespace (tests/support/netns.sh).
#include <gtest/gtest.h>

#include <cstdlib>
#include <lab/command_t.hpp>
#include <lab/event_t.hpp>
#include <lab/need_t.hpp>
#include <lab/request_t.hpp>

#include "tests/wire/bus/bus_user.h"
#include "tests/wire/process/script.h"
#include "tests/wire/protocol/message.h"
#include "wire/process/participant.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

TEST(ParticipantOnABus, AStrangerMayAskAndNothingElse) {
  setenv("LAB_LAUNCH", "42", 1);
  for (const char* name : {"LAB_RUN_DIR", "LAB_GUESTS", "LAB_BUS", "LAB_FAULT_DROP"}) unsetenv(name);
  const std::string url = lab::url(next_port());
  Participant participant(ParticipantOptions{.name = kSimulator, .url = url, .prefix = "", .channels = {}});
  const auto stranger = open_bus(url);
  const auto say = [&](Channel channel, const Bytes& bytes) {
    stranger->publish(wire_name(channel, ""), bytes);
  };
  const auto need = [](int64_t step) {
    auto m = message_of<need_t>(kRun, step);
    m.process = kSimulator;
    m.sender = kController;
    return encode(m);
  };
  Script role;
  role.send = [&] {
    auto event = message_of<event_t>(kRun, kStep);
    event.process = kPlanner;
    say(Channel::Event, encode(event));
    auto command = message_of<command_t>(kRun, kStep);
    command.nv = 1;
    command.tau = {0};
    say(Channel::Command, encode(command));
    say(Channel::Need, need(kStep));
    say(Channel::Need, need(kBeforeStart));
    say(Channel::Request, encode(message_of<request_t>(kRun, kBeforeStart)));
  };
  const auto heard = [&] {
    std::vector<Channel> channels;
    for (const auto& [channel, bytes] : role.heard)
      if (channel != Channel::Process) channels.push_back(channel);
    return channels;
  };
  role.done = [&] { return heard().size() >= 2 && role.strangers.size() >= 3; };
  EXPECT_EQ(participant.run(role), kOk);
  EXPECT_EQ(heard(), (std::vector<Channel>{Channel::Need, Channel::Request}));
  ASSERT_EQ(role.strangers.size(), 3u);
  EXPECT_NE(role.strangers[0].find("is not this lab's planner"), std::string::npos) << role.strangers[0];
  EXPECT_NE(role.strangers[1].find("is not this lab's controller"), std::string::npos) << role.strangers[1];
  EXPECT_NE(role.strangers[2].find("is not this lab's controller"), std::string::npos) << role.strangers[2];
}

}  // namespace
}  // namespace lab
