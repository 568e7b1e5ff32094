// The table of channels: what each carries and what may be in it. A new message is one .lcm file and,
// here, a value of Channel, kChannels and a row; the guard and TYPE follow this table, roles handle channels by name.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lab {

enum class Channel : uint8_t {
  Run,
  Type,
  RobotState,
  Reference,
  Command,
  Request,
  Reply,
  Input,
  Event,
  End,
  Ack,
  Need,
  Process,
  Frame,
  Check
};
inline constexpr int kChannels = 15;

/// Which file of a run's folder keeps the channel.
enum class LogFile : uint8_t { None, Log, Telemetry };

/// Which process may publish on a channel.
enum class Publisher : uint8_t {
  Simulator,
  Planner,
  Controller,
  Renderer,
  Named,    ///< the process that the message names
  Anybody,  ///< people and tools too
  Nobody,   ///< only in logs; on the bus it is ignored
};

struct ChannelRow {
  Channel id;
  std::string_view name;  ///< on the wire, without prefix
  std::string_view type;  ///< package and struct of the message
  uint32_t max_bytes;     ///< of an encoded message
  LogFile log_file;
  Publisher publisher;
  bool near_state;            ///< its step is at most kWindow ahead of the last ROBOT_STATE
  bool any_run;               ///< run 0 = "any lab on this bus" is accepted
  std::string_view nq_field;  ///< field that must equal the robot's nq; empty = no rule
  std::string_view nv_field;  ///< the same for nv
};

// A REQUEST is shorter than the INPUT that it becomes may be.
inline constexpr std::array<ChannelRow, kChannels> kChannelTable = [] {
  using enum LogFile;
  using enum Publisher;
  return std::array<ChannelRow, kChannels>{{
      {Channel::Run, "RUN", "lab.run_t", 16 << 20, Log, Simulator, false, false, "", ""},
      {Channel::Type, "TYPE", "lab.type_t", 256 << 10, Log, Simulator, false, false, "", ""},
      {Channel::RobotState, "ROBOT_STATE", "lab.robot_state_t", 64 << 10, Log, Simulator, false, false, "nq",
       "nv"},
      {Channel::Reference, "REFERENCE", "lab.reference_t", 64 << 10, Log, Planner, true, false, "nq", "nv"},
      {Channel::Command, "COMMAND", "lab.command_t", 64 << 10, Log, Controller, true, false, "", "nv"},
      {Channel::Request, "REQUEST", "lab.request_t", 32 << 10, None, Anybody, false, true, "", ""},
      {Channel::Reply, "REPLY", "lab.reply_t", 16 << 10, None, Simulator, false, false, "", ""},
      {Channel::Input, "INPUT", "lab.input_t", 64 << 10, Log, Simulator, true, false, "", ""},
      {Channel::Event, "EVENT", "lab.event_t", 16 << 10, Log, Named, true, false, "", ""},
      {Channel::End, "END", "lab.end_t", 16 << 10, Log, Simulator, false, false, "", ""},
      {Channel::Ack, "ACK", "lab.ack_t", 4 << 10, None, Named, true, false, "", ""},
      {Channel::Need, "NEED", "lab.need_t", 4 << 10, None, Named, true, true, "", ""},
      {Channel::Process, "PROCESS", "lab.process_t", 16 << 10, Telemetry, Named, false, true, "", ""},
      {Channel::Frame, "FRAME", "lab.frame_t", 16 << 10, Telemetry, Renderer, false, false, "", ""},
      {Channel::Check, "CHECK", "lab.check_t", 4 << 10, Log, Nobody, false, false, "", ""},
  }};
}();

/// Bytes of the largest message on any channel of the lab.
inline constexpr uint32_t kLargestMessage = [] {
  uint32_t largest = 0;
  for (const ChannelRow& r : kChannelTable) largest = r.max_bytes > largest ? r.max_bytes : largest;
  return largest;
}();

constexpr const ChannelRow& row(Channel channel) { return kChannelTable[static_cast<size_t>(channel)]; }

/// The channel of that wire name; nullopt if it is not in the table. A name that starts with `prefix` is looked up
/// without it; with a non-empty prefix any other name is not found.
constexpr std::optional<Channel> channel_of(std::string_view name, std::string_view prefix = {}) {
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  for (const ChannelRow& r : kChannelTable) {
    if (r.name == name) return r.id;
  }
  return std::nullopt;
}

/// The wire name of a channel.
inline std::string wire_name(Channel channel, std::string_view prefix = {}) {
  return std::string(prefix).append(row(channel).name);
}

static_assert(
    [] {
      for (int i = 0; i < kChannels; ++i) {
        if (static_cast<int>(kChannelTable[i].id) != i) return false;
      }
      return true;
    }(),
    "kChannelTable must be in the order of Channel");

}  // namespace lab
