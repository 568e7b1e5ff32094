// The bus: one conformance suite for both back ends, in every pairing, and what only the own endpoint can do.
// Runs in a private network namespace (tests/support/netns.sh).
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <map>
#include <random>

#include "core/util/big_endian.h"
#include "tests/wire/bus/bus_user.h"
#include "tests/wire/bus/noise.h"
#include "wire/bus/bus.h"
#include "wire/bus/udpm_wire.h"

namespace lab {
namespace {

struct Pairing {
  std::string from, to;
};

class Conformance : public testing::TestWithParam<Pairing> {
 protected:
  std::unique_ptr<Bus> open(const std::string& backend, const BusOptions& options = {}) {
    return open_bus(url(port_, "&backend=" + backend), options);
  }
  int port_ = next_port();
};

TEST_P(Conformance, SizesAcrossEveryBoundary) {
  const auto to = open(GetParam().to);
  const auto from = open(GetParam().from);
  const size_t name = std::string("BIG").size() + 1;
  uint32_t seed = 0;
  for (const size_t n : {size_t{0}, size_t{1}, size_t{100}, size_t{1400}, size_t{60'000},
                         udpm::kMaxShort - name, udpm::kMaxShort - name + 1, udpm::kMaxFragment - name,
                         udpm::kMaxFragment - name + 1, 2 * udpm::kMaxFragment - name,
                         2 * udpm::kMaxFragment - name + 1, size_t{200'000}, size_t{1'000'000}}) {
    if (n > 100'000 && to->describe().find("raise net.core.rmem_max") != std::string::npos)
      continue;  // cannot hold it
    const Bytes data = noise(n, ++seed);
    from->publish("BIG", data);
    const auto got = collect(*to, 1);
    ASSERT_EQ(got.size(), 1u) << n;
    EXPECT_EQ(got[0].channel, "BIG");
    EXPECT_EQ(got[0].data, data) << n;
  }
  EXPECT_EQ(to->counters().malformed, 0);
  EXPECT_EQ(to->counters().lost, 0);
  EXPECT_EQ(from->counters().send_failed, 0);
}

TEST_P(Conformance, OrderAndNothingLostInABurst) {
  const auto to = open(GetParam().to);
  const auto from = open(GetParam().from);
  constexpr uint32_t kMany = 100;  // fits the smallest receive buffer of a stock kernel
  for (uint32_t i = 0; i < kMany; ++i) {
    Bytes data = noise(200, i);
    store_big_endian(data.data(), i);
    from->publish(i % 2 ? "ODD" : "EVEN", data);
  }
  const auto got = collect(*to, kMany);
  ASSERT_EQ(got.size(), kMany);
  for (uint32_t i = 0; i < kMany; ++i) {
    Bytes expected = noise(200, i);
    store_big_endian(expected.data(), i);
    EXPECT_EQ(got[i].data, expected);
    EXPECT_EQ(got[i].channel, i % 2 ? "ODD" : "EVEN");
  }
  EXPECT_EQ(from->counters().sent, kMany);
}

TEST_P(Conformance, ChannelListAndSpecialCharacters) {
  BusOptions options;
  options.channels = {"A.B", "WANTED"};
  const auto to = open(GetParam().to, options);
  const auto from = open(GetParam().from);
  for (const char* channel : {"AxB", "WANTE", "WANTEDX", "A.B", "UNWANTED", "WANTED"}) {
    from->publish(channel, noise(50, 1));
    from->publish(channel, noise(100'000, 2));
  }
  const auto got = collect(*to, 4);
  ASSERT_EQ(got.size(), 4u);
  EXPECT_EQ(got[0].channel, "A.B");
  EXPECT_EQ(got[1].data, noise(100'000, 2));
  EXPECT_EQ(got[2].channel, "WANTED");
  EXPECT_EQ(got[3].data, noise(100'000, 2));
  EXPECT_EQ(to->poll(0, [](const Datagram&) {}), 0);
}

TEST_P(Conformance, PollTimesOutAndTheFdTells) {
  const auto to = open(GetParam().to);
  const auto from = open(GetParam().from);
  while (to->poll(100'000, [](const Datagram&) {}) > 0) {  // what opening it has left on the way
  }
  const auto start = Clock::now();
  EXPECT_EQ(to->poll(20'000, [](const Datagram&) {}), 0);
  EXPECT_GE(Clock::now() - start, std::chrono::milliseconds(19));
  from->publish("X", noise(10, 1));
  pollfd p{to->fd(), POLLIN, 0};
  EXPECT_EQ(::poll(&p, 1, 10'000), 1);
  EXPECT_EQ(to->poll(-1, [](const Datagram&) {}), 1);
}

TEST_P(Conformance, HandlersMayPublishAndThrow) {
  const auto to = open(GetParam().to);
  const auto from = open(GetParam().from);
  for (uint8_t i = 0; i < 5; ++i) from->publish("PING", Bytes{i});
  std::vector<int> seen;
  int thrown = 0;
  const auto deadline = Clock::now() + std::chrono::seconds(10);
  while (seen.size() < 5 && Clock::now() < deadline) {
    try {
      to->poll(100'000, [&](const Datagram& d) {
        if (d.channel != "PING") return;
        seen.push_back(d.data[0]);
        to->publish("PONG", d.data);
        if (d.data[0] == 2) throw std::runtime_error("from the handler");
      });
    } catch (const std::runtime_error&) {
      ++thrown;
    }
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(thrown, 1);
  std::vector<Bytes> answers;  // liblcm also hears its own PING
  while (answers.size() < 5 && Clock::now() < deadline) {
    for (const Message& m : collect(*from, 1)) {
      if (m.channel == "PONG") answers.push_back(m.data);
    }
  }
  EXPECT_EQ(answers, (std::vector<Bytes>{{0}, {1}, {2}, {3}, {4}}));
}

TEST_P(Conformance, BadChannelNames) {
  const auto bus = open(GetParam().from);
  EXPECT_THROW(bus->publish("", Bytes{}), std::invalid_argument);
  EXPECT_THROW(bus->publish(std::string(64, 'x'), Bytes{}), std::invalid_argument);
  EXPECT_THROW(bus->publish(std::string("a\0b", 3), Bytes{}), std::invalid_argument);
  bus->publish(std::string(63, 'x'), Bytes{});
  EXPECT_EQ(bus->counters().sent, 1);
}

TEST_P(Conformance, FaultHookIsSeededAndCounted) {
  const auto survivors = [&](uint64_t seed) {
    BusOptions options;
    options.drop = {0.3, seed};
    const auto to = open(GetParam().to, options);
    const auto from = open(GetParam().from);
    const int64_t before = to->counters().faulted;  // of liblcm's self tests
    static_cast<void>(before);
    std::vector<int> out;
    for (uint8_t i = 0; i < 200; ++i) {
      from->publish("X", Bytes{i});
      to->poll(i == 199 ? 0 : 0, [&](const Datagram& d) {
        if (d.channel == "X") out.push_back(d.data[0]);
      });
    }
    const auto deadline = Clock::now() + std::chrono::seconds(10);
    while (to->counters().received + to->counters().faulted < 200 && Clock::now() < deadline) {
      to->poll(50'000, [&](const Datagram& d) {
        if (d.channel == "X") out.push_back(d.data[0]);
      });
    }
    EXPECT_GT(to->counters().faulted, 30);  // 60 expected, 4.6 sigma away
    EXPECT_LT(to->counters().faulted, 95);
    return out;
  };
  const auto first = survivors(1);
  EXPECT_LT(first.size(), 170u);
  if (GetParam().from == "own" && GetParam().to == "own") {  // no self tests of liblcm in between
    EXPECT_EQ(survivors(1), first);
    EXPECT_NE(survivors(2), first);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, Conformance,
                         testing::Values(Pairing{"own", "own"}, Pairing{"own", "liblcm"},
                                         Pairing{"liblcm", "own"}, Pairing{"liblcm", "liblcm"}),
                         [](const auto& info) { return info.param.from + "_to_" + info.param.to; });

TEST(OwnEndpoint, SequenceGapsAreCountedPerSender) {
  const int port = next_port();
  const auto to = open_bus(url(port));
  const auto raw = [&](int fd, uint32_t sequence) {
    uint8_t p[12] = {0, 0, 0, 0, 0, 0, 0, 0, 'C', 0, 1, 2};
    store_big_endian(p, udpm::kShort);
    store_big_endian(p + 4, sequence);
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_port = htons(static_cast<uint16_t>(port));
    inet_pton(AF_INET, "239.255.76.67", &a.sin_addr);
    ASSERT_EQ(sendto(fd, p, sizeof p, 0, reinterpret_cast<const sockaddr*>(&a), sizeof a), 12);
  };
  const int one = socket(AF_INET, SOCK_DGRAM, 0), two = socket(AF_INET, SOCK_DGRAM, 0);
  for (uint32_t s : {5u, 6u, 9u}) raw(one, s);           // two lost; what was before 5 is unknown
  for (uint32_t s : {0xffffffffu, 0u, 1u}) raw(two, s);  // goes round
  for (uint32_t s : {8u, 10u}) raw(one, s);              // one late: no new loss
  // a new process on the old port after 100000: its numbers begin anew, and two of its own are lost before 4
  for (uint32_t s : {100'000u, 0u, 1u, 4u}) raw(one, s);
  close(one);
  close(two);
  const auto got = collect(*to, 12);
  ASSERT_EQ(got.size(), 12u);
  std::map<uint64_t, std::vector<int64_t>> lost;
  for (const Message& m : got) lost[m.sender].push_back(m.lost_before);
  ASSERT_EQ(lost.size(), 2u);
  EXPECT_EQ(lost[got[0].sender], (std::vector<int64_t>{0, 0, 2, 0, 0, 99'989, 0, 0, 2}));
  EXPECT_EQ(lost[got[3].sender], (std::vector<int64_t>{0, 0, 0}));
  EXPECT_EQ(to->counters().lost, 2 + 99'989 + 2);
}

TEST(OwnEndpoint, OverflowOfTheReceiveBufferIsSeen) {
  const int port = next_port();
  BusOptions options;
  options.recv_buf_size = 4096;
  const auto to = open_bus(url(port), options);
  const auto from = open_bus(url(port));
  for (int i = 0; i < 500; ++i) from->publish("X", noise(1000, 1));
  int received = 0;
  while (to->poll(0, [&](const Datagram&) { ++received; }) > 0) {
  }
  EXPECT_LT(received, 500);
  EXPECT_EQ(received + to->counters().overflow, 500);
  from->publish("X", noise(1000, 1));
  const auto last = collect(*to, 1);
  ASSERT_EQ(last.size(), 1u);
  EXPECT_EQ(last[0].lost_before, to->counters().lost);
  EXPECT_EQ(to->counters().lost, to->counters().overflow);
}

TEST(OwnEndpoint, WithAChannelListItDoesNotHearItselfNorWakeForOthers) {
  const int port = next_port();
  BusOptions options;
  options.channels = {"MINE"};
  const auto bus = open_bus(url(port), options);
  const auto other = open_bus(url(port));
  bus->publish("MINE", noise(10, 1));
  bus->publish("MINE", noise(100'000, 1));
  other->publish("OTHER", noise(10, 1));
  pollfd p{bus->fd(), POLLIN, 0};
  EXPECT_EQ(::poll(&p, 1, 0), 0) << "loopback delivers at once: the filter let something through";
  EXPECT_EQ(collect(*other, 3).size(), 3u);  // without a list: everything, its own too
  other->publish("MINE", noise(10, 1));
  EXPECT_EQ(collect(*bus, 1).size(), 1u);
  EXPECT_EQ(bus->counters().overflow, -1);
}

TEST(OwnEndpoint, OtherGroupsOnThePortStayOut) {
  const int port = next_port();
  const auto bus = open_bus(url(port));
  const auto other = open_bus("udpm://239.255.76.68:" + std::to_string(port) + "?ttl=0");
  other->publish("X", noise(10, 1));
  bus->publish("Y", noise(10, 1));
  const auto got = collect(*bus, 1);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].channel, "Y");
}

TEST(OwnEndpoint, StrayPacketsAreCountedNotTrusted) {
  const int port = next_port();
  const auto bus = open_bus(url(port));
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_port = htons(static_cast<uint16_t>(port));
  inet_pton(AF_INET, "239.255.76.67", &a.sin_addr);
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  std::mt19937 rng(4);
  int64_t stray = 0;
  for (; stray < 100; ++stray) {
    const Bytes bytes = noise(rng() % 40, static_cast<uint32_t>(stray));
    sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&a), sizeof a);
  }
  close(fd);
  bus->publish("LAST", noise(3, 1));
  const auto got = collect(*bus, 1);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].channel, "LAST");
  EXPECT_EQ(bus->counters().malformed, stray);
}

TEST(OwnEndpoint, BatchingWakesOnceForMany) {
  const int port = next_port();
  const auto to = open_bus(url(port)), from = open_bus(url(port));
  for (int i = 0; i < 300; ++i) from->publish("X", noise(20, 1));
  const auto start = Clock::now();
  EXPECT_EQ(to->poll(1'000'000, [](const Datagram&) {}, 20'000), 300);
  EXPECT_GE(Clock::now() - start, std::chrono::milliseconds(19));
}

TEST(OwnEndpoint, ASignalEndsTheWait) {
  const auto bus = open_bus(url(next_port()));
  struct sigaction quiet{};
  quiet.sa_handler = [](int) {};
  sigaction(SIGALRM, &quiet, nullptr);
  const itimerval soon{{0, 0}, {0, 20'000}};
  setitimer(ITIMER_REAL, &soon, nullptr);
  const auto start = Clock::now();
  EXPECT_EQ(bus->poll(30'000'000, [](const Datagram&) {}), 0);
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(10));
}

TEST(OwnEndpoint, AFirewallIsSurvivedAndCounted) {
  if (!is_private()) GTEST_SKIP() << "start it with tests/support/netns.sh";
  if (std::system("nft add table inet lab 2>/dev/null") != 0) GTEST_SKIP() << "needs nft and its rights";
  const int port = next_port();
  const auto bus = open_bus(url(port));
  ASSERT_EQ(std::system("nft 'add chain inet lab out { type filter hook output priority 0; }' && nft add "
                        "rule inet lab out udp length '>' 0 drop"),
            0);
  bus->publish("X", noise(10, 1));
  bus->publish("X", noise(200'000, 1));
  EXPECT_EQ(bus->counters().send_failed, 2);
  EXPECT_EQ(std::system("nft delete table inet lab"), 0);
  bus->publish("X", noise(10, 1));
  EXPECT_EQ(bus->counters().sent, 1);
  EXPECT_EQ(collect(*bus, 1).size(), 1u);
}

TEST(Liblcm, WhatCannotBeSentIsCounted) {
  if (!is_private()) GTEST_SKIP() << "start it with tests/support/netns.sh";
  const auto bus = open_bus(url(next_port(), "&backend=liblcm"));
  ASSERT_EQ(std::system("ip route del 224.0.0.0/4 dev lo"), 0);
  bus->publish("X", noise(10, 1));
  ASSERT_EQ(std::system("ip route add 224.0.0.0/4 dev lo"), 0);
  EXPECT_EQ(bus->counters().send_failed, 1);
  EXPECT_EQ(bus->counters().sent, 0);
}

TEST(Liblcm, OtherProvidersHearThemselves) {
  const auto bus = open_bus("memq://");
  for (uint8_t i = 0; i < 100; ++i) bus->publish("X", Bytes{i});  // liblcm's queue would hold 30
  const auto got = collect(*bus, 100);
  ASSERT_EQ(got.size(), 100u);
  for (uint8_t i = 0; i < 100; ++i) EXPECT_EQ(got[i].data, Bytes{i});
}

TEST(OpenBus, ErrorsSayWhatToDo) {
  const auto reason = [](const std::string& text) -> std::string {
    try {
      open_bus(text);
    } catch (const BusError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(reason("nonsense").find("expected provider://network"), std::string::npos);
  EXPECT_NE(reason("udpm://1.2.3.4:7667").find("'1.2.3.4' is not a multicast address"), std::string::npos);
  EXPECT_NE(reason("udpm://239.255.76.67:99999").find("port '99999' must be a number from 1 to 65535"),
            std::string::npos);
  EXPECT_NE(reason("udpm://239.255.76.67:7667?tll=0").find("unknown option 'tll'"), std::string::npos);
  EXPECT_NE(reason("udpm://239.255.76.67:7667?ttl=x").find("ttl 'x' must be a number from 0 to 255"),
            std::string::npos);
  EXPECT_NE(reason("udpm://239.255.76.67:7667?ttl").find("should be key=value"), std::string::npos);
  EXPECT_NE(reason("udpm://239.255.76.67:7667?backend=zmq").find("bus backend 'zmq'"), std::string::npos);
  EXPECT_NE(reason("nosuch://x").find("liblcm cannot open it"), std::string::npos);
  if (!is_private()) GTEST_SKIP() << "start it with tests/support/netns.sh";
  EXPECT_NE(reason(url(next_port(), "&interface=nope")).find("no network interface 'nope'"),
            std::string::npos);
  ASSERT_EQ(std::system("ip route del 224.0.0.0/4 dev lo"), 0);
  EXPECT_NE(reason("udpm://239.255.76.67:7667?ttl=1").find("ip route add 224.0.0.0/4 dev lo"),
            std::string::npos);
  ASSERT_EQ(std::system("ip route add 224.0.0.0/4 dev lo"), 0);
}

TEST(OpenBus, Environment) {
  const int port = next_port();
  setenv("LCM_DEFAULT_URL", url(port).c_str(), 1);
  const auto from = open_bus();
  EXPECT_NE(from->describe().find("own endpoint udpm://239.255.76.67:" + std::to_string(port)),
            std::string::npos)
      << from->describe();
  setenv("LAB_BUS", "liblcm", 1);
  EXPECT_EQ(open_bus()->describe().substr(0, 6), "liblcm");
  unsetenv("LAB_BUS");
  setenv("LAB_FAULT_DROP", "100,7", 1);
  const auto deaf = open_bus();
  setenv("LAB_FAULT_DROP", "lots", 1);
  EXPECT_THROW(open_bus(), BusError);
  unsetenv("LAB_FAULT_DROP");
  const auto to = open_bus();
  unsetenv("LCM_DEFAULT_URL");
  from->publish("X", noise(10, 1));
  EXPECT_EQ(collect(*to, 1).size(), 1u);
  EXPECT_EQ(deaf->poll(0, [](const Datagram&) {}), 0);
  EXPECT_EQ(deaf->counters().faulted, 1);
}

}  // namespace
}  // namespace lab
