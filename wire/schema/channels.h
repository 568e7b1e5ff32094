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
  Frame
};
inline constexpr int kChannels = 14;

/// Which file of a run's folder keeps the channel.
enum class LogFile : uint8_t { None, Log, Telemetry };

struct ChannelRow {
  Channel id;
  std::string_view name;  ///< on the wire, without prefix
  std::string_view type;  ///< package and struct of the message
  uint32_t max_bytes;     ///< of an encoded message
  LogFile log_file;
  bool any_run;               ///< run 0 = "any lab on this bus" is accepted
  std::string_view nq_field;  ///< field that must equal the robot's nq; empty = no rule
  std::string_view nv_field;  ///< the same for nv
};

inline constexpr std::array<ChannelRow, kChannels> kChannelTable{{
    {Channel::Run, "RUN", "lab.run_t", 16 << 20, LogFile::Log, false, "", ""},
    {Channel::Type, "TYPE", "lab.type_t", 256 << 10, LogFile::Log, false, "", ""},
    {Channel::RobotState, "ROBOT_STATE", "lab.robot_state_t", 64 << 10, LogFile::Log, false, "nq", "nv"},
    {Channel::Reference, "REFERENCE", "lab.reference_t", 64 << 10, LogFile::Log, false, "nq", "nv"},
    {Channel::Command, "COMMAND", "lab.command_t", 64 << 10, LogFile::Log, false, "", "nv"},
    {Channel::Request, "REQUEST", "lab.request_t", 64 << 10, LogFile::None, true, "", ""},
    {Channel::Reply, "REPLY", "lab.reply_t", 16 << 10, LogFile::None, false, "", ""},
    {Channel::Input, "INPUT", "lab.input_t", 64 << 10, LogFile::Log, false, "", ""},
    {Channel::Event, "EVENT", "lab.event_t", 16 << 10, LogFile::Log, false, "", ""},
    {Channel::End, "END", "lab.end_t", 16 << 10, LogFile::Log, false, "", ""},
    {Channel::Ack, "ACK", "lab.ack_t", 4 << 10, LogFile::None, false, "", ""},
    {Channel::Need, "NEED", "lab.need_t", 4 << 10, LogFile::None, true, "", ""},
    {Channel::Process, "PROCESS", "lab.process_t", 16 << 10, LogFile::Telemetry, true, "", ""},
    {Channel::Frame, "FRAME", "lab.frame_t", 16 << 10, LogFile::Telemetry, false, "", ""},
}};

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
