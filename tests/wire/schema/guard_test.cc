// The guard, row by row of the channel table, and the codec's check of counts.
#include "wire/schema/guard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <lab/ack_t.hpp>
#include <lab/check_t.hpp>
#include <lab/command_t.hpp>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/frame_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/reply_t.hpp>
#include <lab/request_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <lab/type_t.hpp>

#include "wire/schema/codec.h"

namespace lab {
namespace {

using Bytes = std::vector<uint8_t>;

// A message for each channel: nq 7, nv 6.
Bytes sample(Channel channel, int64_t run) {
  const auto make = [&](auto m) {
    m.utime = 11;
    m.run = run;
    m.step = 33;
    if constexpr (requires { m.nq; }) m.nq = 7;
    if constexpr (requires { m.nv; }) m.nv = 6;
    if constexpr (requires { m.q; }) m.q.assign(7, 0.5);
    if constexpr (requires { m.v; }) m.v.assign(6, 0.5);
    if constexpr (requires { m.a; }) m.a.assign(6, 0.5);
    if constexpr (requires { m.tau; }) m.tau.assign(6, 0.5);
    return encode(m);
  };
  switch (channel) {
    case Channel::Run:
      return make(run_t{});
    case Channel::Type:
      return make(type_t{});
    case Channel::RobotState:
      return make(robot_state_t{});
    case Channel::Reference:
      return make(reference_t{});
    case Channel::Command:
      return make(command_t{});
    case Channel::Request:
      return make(request_t{});
    case Channel::Reply:
      return make(reply_t{});
    case Channel::Input:
      return make(input_t{});
    case Channel::Event:
      return make(event_t{});
    case Channel::End:
      return make(end_t{});
    case Channel::Ack:
      return make(ack_t{});
    case Channel::Need:
      return make(need_t{});
    case Channel::Process:
      return make(process_t{});
    case Channel::Frame:
      return make(frame_t{});
    case Channel::Check:
      return make(check_t{});
  }
  return {};
}

TEST(Channels, NamesRoundTripAndPrefixesSeparateRobots) {
  for (const ChannelRow& r : kChannelTable) {
    EXPECT_EQ(channel_of(r.name), r.id);
    EXPECT_EQ(channel_of(wire_name(r.id, "left/"), "left/"), r.id);
    EXPECT_EQ(channel_of(r.name, "left/"), std::nullopt);
    EXPECT_EQ(channel_of(wire_name(r.id, "right/"), "left/"), std::nullopt);
    EXPECT_EQ(channel_of(wire_name(r.id, "left/")), std::nullopt);
  }
  EXPECT_EQ(channel_of("ROBOT_STAT"), std::nullopt);
  EXPECT_EQ(channel_of(""), std::nullopt);
}

TEST(Channels, KeptAsTheContractSays) {
  std::string log, telemetry;
  for (const ChannelRow& r : kChannelTable) {
    if (r.log_file == LogFile::Log) log += std::string(r.name) + " ";
    if (r.log_file == LogFile::Telemetry) telemetry += std::string(r.name) + " ";
  }
  EXPECT_EQ(log, "RUN TYPE ROBOT_STATE REFERENCE COMMAND INPUT EVENT END CHECK ");
  EXPECT_EQ(telemetry, "PROCESS FRAME ");
}

TEST(Channels, WhichStepsMustBeNearTheState) {
  std::string near;
  for (const ChannelRow& r : kChannelTable)
    if (r.near_state) near += std::string(r.name) + " ";
  EXPECT_EQ(near, "REFERENCE COMMAND INPUT EVENT ACK NEED ");
}

class GuardTable : public testing::TestWithParam<Channel> {};

TEST_P(GuardTable, AcceptsItsOwnAndNamesWhatItRefuses) {
  const Channel channel = GetParam();
  const ChannelRow& r = row(channel);
  Guard guard;
  const Bytes good = sample(channel, 5);
  // nothing known yet: any run, any size
  Verdict v = guard.check(r.name, good);
  ASSERT_EQ(v.kind, Verdict::Accepted) << v.reason;
  EXPECT_EQ(v.reason, "");
  EXPECT_EQ(v.head.utime, 11);
  EXPECT_EQ(v.head.run, 5);
  EXPECT_EQ(v.head.step, 33);
  // the run
  guard.set_run(5);
  guard.set_sizes(7, 6);
  EXPECT_TRUE(guard.check(channel, good));
  EXPECT_EQ(guard.check(channel, sample(channel, 6)).kind, Verdict::Foreign);
  EXPECT_EQ(guard.check(channel, sample(channel, 6)).head.run, 6);
  const bool anyone = channel == Channel::Request || channel == Channel::Need || channel == Channel::Process;
  EXPECT_EQ(guard.check(channel, sample(channel, 0)).kind, anyone ? Verdict::Accepted : Verdict::Foreign);
  // cut, longer, another type's fingerprint
  for (const Bytes& bad : {Bytes(good.begin(), good.end() - 1), Bytes(good.size() + 1), Bytes{}}) {
    v = guard.check(channel, bad);
    EXPECT_EQ(v.kind, Verdict::Refused);
    EXPECT_TRUE(v.reason.starts_with(std::string(r.name) + ": ")) << v.reason;
  }
  const Channel other = channel == Channel::Ack ? Channel::End : Channel::Ack;
  EXPECT_NE(guard.check(channel, sample(other, 5)).reason.find("fingerprint"), std::string::npos);
  // longer than the row allows, however well formed
  EXPECT_NE(guard.check(channel, Bytes(r.max_bytes + 1)).reason.find("at most"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(AllChannels, GuardTable, testing::ValuesIn([] {
                           std::vector<Channel> all;
                           for (const ChannelRow& r : kChannelTable) all.push_back(r.id);
                           return all;
                         }()),
                         [](const auto& info) { return std::string(row(info.param).name); });

TEST(Guard, SizesOfTheRobot) {
  Guard guard;
  guard.set_sizes(6, 6);
  EXPECT_EQ(guard.check("ROBOT_STATE", sample(Channel::RobotState, 1)).reason,
            "ROBOT_STATE: nq is 7, this robot has 6");
  guard.set_sizes(7, 7);
  EXPECT_EQ(guard.check("REFERENCE", sample(Channel::Reference, 1)).reason,
            "REFERENCE: nv is 6, this robot has 7");
  EXPECT_EQ(guard.check("COMMAND", sample(Channel::Command, 1)).reason, "COMMAND: nv is 6, this robot has 7");
  guard.set_sizes(-1, -1);
  EXPECT_TRUE(guard.check("COMMAND", sample(Channel::Command, 1)));
}

TEST(Guard, NumbersAndStrangers) {
  Guard guard("left/");
  command_t m{};
  m.nv = 2;
  m.tau = {1, std::nan("")};
  EXPECT_EQ(guard.check("left/COMMAND", encode(m)).reason, "COMMAND: tau[1] is nan");
  m.tau[1] = INFINITY;
  EXPECT_EQ(guard.check("left/COMMAND", encode(m)).reason, "COMMAND: tau[1] is inf");
  EXPECT_EQ(guard.check("COMMAND", encode(m)).reason, "COMMAND: not a channel of the lab");
  process_t p{};
  p.loop_p99 = std::nanf("");
  EXPECT_EQ(guard.check(Channel::Process, encode(p)).reason, "PROCESS: loop_p99 is nan");
}

TEST(Codec, CountsMustBeLengths) {
  const auto reason = [](const auto& m) -> std::string {
    try {
      encode(m);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  robot_state_t state{};
  EXPECT_EQ(reason(state), "");
  state.nv = 2;
  state.v = {1, 2};
  state.tau = {1};
  EXPECT_EQ(reason(state), "encode lab.robot_state_t: tau has 1 elements, nv is 2");
  state.tau = {1, 2, 3};
  EXPECT_EQ(reason(state), "encode lab.robot_state_t: tau has 3 elements, nv is 2");
  state.nv = -1;
  EXPECT_EQ(reason(state), "encode lab.robot_state_t: v has 2 elements, nv is -1");
  run_t run{};
  run.njoints = 1;
  EXPECT_EQ(reason(run), "encode lab.run_t: joint_names has 0 elements, njoints is 1");
  input_t input{};  // inside a nested struct
  input.action.values = {1};
  EXPECT_EQ(reason(input), "encode lab.action_t: values has 1 elements, n is 0");
  event_t event{};
  event.why = std::string("a\0b", 3);
  EXPECT_NE(reason(event), "");
}

TEST(Codec, RoundTrip) {
  Bytes bytes;
  request_t m{};
  m.sender = "someone";
  m.action.n = 2;
  m.action.values = {1.5, -2.5};
  encode(m, bytes);
  const auto back = decode<request_t>(bytes);
  EXPECT_EQ(back.sender, m.sender);
  EXPECT_EQ(back.action.values, m.action.values);
  bytes.pop_back();
  EXPECT_THROW(decode<request_t>(bytes), std::invalid_argument);
}

}  // namespace
}  // namespace lab
