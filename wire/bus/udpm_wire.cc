#include "wire/bus/udpm_wire.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/util/big_endian.h"
#include "wire/schema/channel_name.h"

namespace lab::udpm {
namespace {

// Splits off the channel name; false when it does not end or is too long.
bool take_channel(std::span<const uint8_t>& rest, std::string_view& channel) {
  const void* nul =
      rest.empty() ? nullptr : std::memchr(rest.data(), 0, std::min(rest.size(), kMaxChannelName + 1));
  if (!nul) return false;
  const auto length = static_cast<size_t>(static_cast<const uint8_t*>(nul) - rest.data());
  channel = {reinterpret_cast<const char*>(rest.data()), length};
  rest = rest.subspan(length + 1);
  return true;
}

bool by_offset(const Assembly::Part& a, const Assembly::Part& b) {
  return std::pair(a.offset, a.size) < std::pair(b.offset, b.size);
}

// Brings the parts into the order of their offsets; false unless they fill the message without gap or overlap.
bool put_in_order(Assembly& a) {
  const bool in_order = std::is_sorted(a.arrived.begin(), a.arrived.end(), by_offset);
  std::sort(a.arrived.begin(), a.arrived.end(), by_offset);
  uint32_t end = 0;
  for (const Assembly::Part& part : a.arrived) {
    if (part.offset != end) return false;
    end += part.size;
  }
  if (end != a.size) return false;
  if (in_order) return true;
  std::vector<uint8_t> ordered;
  ordered.reserve(a.size);
  for (const Assembly::Part& part : a.arrived)
    ordered.insert(ordered.end(), a.data.begin() + part.at, a.data.begin() + part.at + part.size);
  a.data = std::move(ordered);
  return true;
}

}  // namespace

std::optional<Packet> parse_packet(std::span<const uint8_t> bytes) {
  if (bytes.size() < kShortHeader) return std::nullopt;
  Packet packet;
  packet.sequence = load_big_endian<uint32_t>(&bytes[4]);
  const uint32_t magic = load_big_endian<uint32_t>(&bytes[0]);
  if (magic == kShort) {
    packet.data = bytes.subspan(kShortHeader);
    if (!take_channel(packet.data, packet.channel)) return std::nullopt;
    packet.size = static_cast<uint32_t>(packet.data.size());
    return packet;
  }
  if (magic != kFragment || bytes.size() < kFragmentHeader) return std::nullopt;
  packet.fragment = true;
  packet.size = load_big_endian<uint32_t>(&bytes[8]);
  packet.offset = load_big_endian<uint32_t>(&bytes[12]);
  packet.number = load_big_endian<uint16_t>(&bytes[16]);
  packet.parts = load_big_endian<uint16_t>(&bytes[18]);
  packet.data = bytes.subspan(kFragmentHeader);
  if (packet.number >= packet.parts) return std::nullopt;
  if (packet.number == 0 && !take_channel(packet.data, packet.channel)) return std::nullopt;
  if (packet.offset > packet.size || packet.data.size() > packet.size - packet.offset) return std::nullopt;
  return packet;
}

void Assembler::close(size_t index) {
  bytes_ -= half_done_[index].data.size();
  half_done_.erase(half_done_.begin() + static_cast<ptrdiff_t>(index));
}

void Assembler::give_up_oldest(std::optional<uint64_t> sender) {
  size_t oldest = half_done_.size();
  for (size_t i = 0; i < half_done_.size(); ++i) {
    if (sender && half_done_[i].sender != *sender) continue;
    if (oldest == half_done_.size() || half_done_[i].age < half_done_[oldest].age) oldest = i;
  }
  close(oldest);
  ++abandoned_;
}

Assembly& Assembler::open(uint64_t sender, const Packet& packet) {
  const auto of_sender = static_cast<size_t>(std::count_if(
      half_done_.begin(), half_done_.end(), [&](const Assembly& a) { return a.sender == sender; }));
  if (of_sender >= kPerSender) give_up_oldest(sender);
  while (half_done_.size() >= kInAll) give_up_oldest(std::nullopt);
  Assembly& a = half_done_.emplace_back();
  a.data.swap(whole_.data);  // the memory of the last message serves the next
  a.data.clear();
  a.sender = sender;
  a.sequence = packet.sequence;
  a.size = packet.size;
  a.parts = packet.parts;
  a.seen.assign(packet.parts, false);
  a.age = ++clock_;
  return a;
}

Assembler::Result Assembler::add(uint64_t sender, const Packet& packet) {
  if (packet.size > max_message_) return Result::Bad;
  while (bytes_ > kMaxBytes) give_up_oldest(std::nullopt);
  size_t i = 0;
  while (i < half_done_.size() &&
         !(half_done_[i].sender == sender && half_done_[i].sequence == packet.sequence))
    ++i;
  if (i < half_done_.size() && (half_done_[i].size != packet.size || half_done_[i].parts != packet.parts)) {
    close(i);
    return Result::Bad;
  }
  if (i == half_done_.size()) {
    open(sender, packet);
    i = half_done_.size() - 1;
  }
  Assembly& a = half_done_[i];
  if (a.seen[packet.number]) return Result::More;
  a.seen[packet.number] = true;
  if (packet.number == 0) a.channel = packet.channel;
  a.arrived.push_back(
      {packet.offset, static_cast<uint32_t>(a.data.size()), static_cast<uint32_t>(packet.data.size())});
  a.data.insert(a.data.end(), packet.data.begin(), packet.data.end());
  bytes_ += packet.data.size();
  if (a.data.size() > a.size) {
    close(i);
    return Result::Bad;
  }
  if (a.arrived.size() < a.parts) return Result::More;
  const bool whole = put_in_order(a);
  bytes_ -= a.data.size();
  if (whole) whole_ = std::move(a);
  half_done_.erase(half_done_.begin() + static_cast<ptrdiff_t>(i));
  return whole ? Result::Whole : Result::Bad;
}

}  // namespace lab::udpm
