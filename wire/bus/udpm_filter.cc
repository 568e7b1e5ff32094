#include "wire/bus/udpm_filter.h"

#include <algorithm>
#include <stdexcept>

#include "wire/bus/udpm_wire.h"

namespace lab::udpm {
namespace {

// Offsets from the UDP header, where the kernel lets a socket's filter start.
constexpr uint32_t kSourcePortAt = 0;
constexpr uint32_t kMagicAt = 8;
constexpr uint32_t kChannelAt = 16;
constexpr uint32_t kSourceAddressAt = static_cast<uint32_t>(SKF_NET_OFF) + 12;

sock_filter load(uint16_t size, uint32_t offset) {
  return {static_cast<uint16_t>(BPF_LD | size | BPF_ABS), 0, 0, offset};
}
sock_filter unless_equal(uint32_t value, uint8_t skip) { return {BPF_JMP | BPF_JEQ | BPF_K, 0, skip, value}; }
sock_filter verdict(bool pass) { return {BPF_RET | BPF_K, 0, 0, pass ? 0xffffffffu : 0u}; }

}  // namespace

std::vector<sock_filter> channel_filter(std::vector<std::string> channels, uint32_t own_address,
                                        uint16_t own_port) {
  // A load behind the packet's end drops the packet. Shortest names first makes that right: a packet too
  // short for this name is too short for all that follow.
  std::sort(channels.begin(), channels.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  std::vector<sock_filter> program = {
      load(BPF_H, kSourcePortAt),
      unless_equal(own_port, 3),  //
      load(BPF_W, kSourceAddressAt),
      unless_equal(own_address, 1),  //
      verdict(false),                //
      load(BPF_W, kMagicAt),
      unless_equal(kFragment, 1),  //
      verdict(true),
      unless_equal(kShort, 1),  //
      {BPF_JMP | BPF_JA, 0, 0, 1},
      verdict(false),
  };
  for (const std::string& name : channels) {
    // the name with its NUL in words of 4, 2 and 1 bytes
    std::vector<sock_filter> compare;
    const size_t length = name.size() + 1;
    for (size_t at = 0; at < length;) {
      const size_t n = length - at >= 4 ? 4 : length - at >= 2 ? 2 : 1;
      uint32_t value = 0;
      for (size_t i = 0; i < n; ++i) value = value << 8 | static_cast<uint8_t>(name.c_str()[at + i]);
      compare.push_back(load(n == 4   ? BPF_W
                             : n == 2 ? BPF_H
                                      : BPF_B,
                             kChannelAt + static_cast<uint32_t>(at)));
      compare.push_back(unless_equal(value, 0));
      at += n;
    }
    compare.push_back(verdict(true));
    for (size_t i = 1; i < compare.size(); i += 2)
      compare[i].jf = static_cast<uint8_t>(compare.size() - 1 - i);
    program.insert(program.end(), compare.begin(), compare.end());
  }
  program.push_back(verdict(false));
  if (program.size() > BPF_MAXINSNS)
    throw std::invalid_argument("too many channel names for one socket filter");
  return program;
}

}  // namespace lab::udpm
