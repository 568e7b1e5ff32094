// The shell around the simulator on a real bus, where it is told who sends: what a program that is no part of the run may say.
// Runs in a private network namespace (tests/support/netns.sh).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <lab/command_t.hpp>
#include <lab/event_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <lab/request_t.hpp>

#include "tests/wire/bus/bus_user.h"
#include "tests/wire/process/script.h"
#include "tests/wire/protocol/message.h"
#include "wire/process/participant.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

void launch() {
  setenv("LAB_LAUNCH", "42", 1);
  for (const char* name : {"LAB_RUN_DIR", "LAB_GUESTS", "LAB_BUS", "LAB_FAULT_DROP"}) unsetenv(name);
}

TEST(ParticipantOnABus, AStrangerMayAskAndNothingElse) {
  launch();
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

// From the controller itself: a NaN, one effort too many, another run.
TEST(ParticipantOnABus, WhatTheGuardRefusesDoesNotReachTheRole) {
  launch();
  const std::string url = lab::url(next_port());
  Participant participant(ParticipantOptions{.name = kSimulator, .url = url, .prefix = "", .channels = {}});
  const auto controller = open_bus(url);
  const auto say = [&](Channel channel, const Bytes& bytes) {
    controller->publish(wire_name(channel, ""), bytes);
  };
  const auto command = [](int64_t run, std::vector<double> tau) {
    auto m = message_of<command_t>(run, kStep);
    m.nv = static_cast<int32_t>(tau.size());
    m.tau = std::move(tau);
    return encode(m);
  };
  process_t newest{};
  Script role;
  role.send = [&] {
    auto ready = message_of<process_t>(kRun, kBeforeStart);
    ready.name = kController;
    ready.nonce = 42;
    ready.state = "READY";
    say(Channel::Process, encode(ready));
    say(Channel::Command, command(kRun, {std::nan("")}));
    say(Channel::Command, command(kRun, {1, 1}));
    say(Channel::Command, command(kRun + 1, {1}));
    say(Channel::Command, command(kRun, {1}));
  };
  const auto commands = [&] {
    return std::count_if(role.heard.begin(), role.heard.end(),
                         [](const auto& m) { return m.first == Channel::Command; });
  };
  role.done = [&] {
    for (const auto& [channel, bytes] : role.heard)
      if (channel == Channel::Process && decode<process_t>(bytes).name == kSimulator) decode(bytes, newest);
    return newest.rejected >= 2 && newest.foreign >= 1 && commands() >= 1;
  };
  EXPECT_EQ(participant.run(role), kOk);
  EXPECT_EQ(newest.rejected, 2);
  EXPECT_EQ(newest.foreign, 1);
  ASSERT_EQ(role.refusals.size(), 2u) << "another run is none of its business";
  EXPECT_TRUE(role.refusals[0].non_finite && !role.refusals[1].non_finite);
  EXPECT_EQ(role.refusals[0].reason, "COMMAND: tau[0] is nan");
  EXPECT_EQ(role.refusals[1].reason, "COMMAND: nv is 2, this robot has 1");
  EXPECT_EQ(commands(), 1);
}

}  // namespace
}  // namespace lab
