#include "wire/bus/udpm_wire.h"

#include <algorithm>
#include <cstring>

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
  bytes_ -= half_done_[index].size;
  half_done_.erase(half_done_.begin() + static_cast<ptrdiff_t>(index));
}

Assembly& Assembler::open(uint64_t sender, const Packet& packet) {
  const auto oldest = [&](bool of_sender) {
    size_t best = half_done_.size();
    for (size_t i = 0; i < half_done_.size(); ++i) {
      if (of_sender && half_done_[i].sender != sender) continue;
      if (best == half_done_.size() || half_done_[i].age < half_done_[best].age) best = i;
    }
    return best;
  };
  const auto of_sender = static_cast<size_t>(std::count_if(
      half_done_.begin(), half_done_.end(), [&](const Assembly& a) { return a.sender == sender; }));
  if (of_sender >= kPerSender) {
    close(oldest(true));
    ++abandoned_;
  }
  while (!half_done_.empty() && (half_done_.size() >= kInAll || bytes_ + packet.size > kMaxBytes)) {
    close(oldest(false));
    ++abandoned_;
  }
  Assembly& a = half_done_.emplace_back();
  a.data.swap(whole_.data);  // the memory of the last message serves the next
  a.sender = sender;
  a.sequence = packet.sequence;
  a.size = packet.size;
  a.parts = packet.parts;
  a.missing = packet.parts;
  a.seen.assign(packet.parts, false);
  a.age = ++clock_;
  bytes_ += packet.size;
  return a;
}

Assembler::Result Assembler::add(uint64_t sender, const Packet& packet) {
  if (packet.size > max_message_) return Result::Bad;
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
  --a.missing;
  a.got += packet.data.size();
  if (packet.number == 0) a.channel = packet.channel;
  // memory follows what has arrived, not what a header claims
  const size_t end = packet.offset + packet.data.size();
  if (a.data.size() < end) {
    if (a.data.capacity() < end) a.data.reserve(std::min<size_t>(a.size, 2 * end));
    a.data.resize(end);
  }
  std::copy(packet.data.begin(), packet.data.end(), a.data.begin() + packet.offset);
  if (a.missing > 0) return Result::More;
  const bool whole = a.got == a.size && a.data.size() >= a.size;
  if (whole) {
    a.data.resize(a.size);
    whole_ = std::move(a);
  }
  close(i);
  return whole ? Result::Whole : Result::Bad;
}

}  // namespace lab::udpm
