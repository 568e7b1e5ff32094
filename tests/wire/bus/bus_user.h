// What tests on a real bus share: a port of their own, and messages as they came. They run in a private network namespace
// (tests/support/netns.sh).
#pragma once
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/wire/bus/noise.h"
#include "wire/bus/bus.h"

namespace lab {

using Clock = std::chrono::steady_clock;

struct Message {
  std::string channel;
  Bytes data;
  uint64_t sender = 0;
  int64_t lost_before = 0;
};

// Polls until `enough` messages have come, or ten seconds have passed.
inline std::vector<Message> collect(Bus& bus, size_t enough) {
  std::vector<Message> out;
  const auto deadline = Clock::now() + std::chrono::seconds(10);
  while (out.size() < enough && Clock::now() < deadline) {
    bus.poll(100'000, [&](const Datagram& d) {
      if (d.channel == "LCM_SELF_TEST") return;  // liblcm checks its route with it
      out.push_back({std::string(d.channel), Bytes(d.data.begin(), d.data.end()), d.sender, d.lost_before});
    });
  }
  return out;
}

inline std::string url(int port, const std::string& more = "") {
  return "udpm://239.255.76.67:" + std::to_string(port) + "?ttl=0" + more;
}
inline int next_port() {
  static int port = 7700;
  return ++port;
}

// Routes and firewall rules are only ever touched in a namespace that netns.sh made for this test.
inline bool is_private() { return std::getenv("LAB_PRIVATE_NETNS") != nullptr; }

}  // namespace lab
