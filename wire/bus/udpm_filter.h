// A socket filter in the kernel for the channels that a bus wants.
#pragma once
#include <linux/filter.h>

#include <cstdint>
#include <string>
#include <vector>

namespace lab::udpm {

/// A classic BPF program for an IPv4 UDP socket: passes fragments (their channel is in the first one only)
/// and short messages whose channel is wanted; drops the rest, and everything from `own_address`:`own_port`
/// (host byte order). Throws std::invalid_argument when the list is too long for one program (some 200
/// names).
std::vector<sock_filter> channel_filter(std::vector<std::string> channels, uint32_t own_address,
                                        uint16_t own_port);

}  // namespace lab::udpm
