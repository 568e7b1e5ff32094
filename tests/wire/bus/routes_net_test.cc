// The bus where routes and network interfaces come and go. Runs in a private network namespace (tests/support/netns.sh).
#include <gtest/gtest.h>

#include "tests/wire/bus/bus_user.h"
#include "tests/wire/bus/noise.h"

namespace lab {
namespace {

// The default route's interface comes and goes (Wi-Fi); what stays on the host must not notice.
class Routes : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_private()) GTEST_SKIP() << "start it with tests/support/netns.sh";
    ASSERT_EQ(
        std::system("ip link add wifi type veth peer name air && ip addr add 10.9.8.7/24 dev wifi && "
                    "ip link set wifi up && ip link set air up && ip route replace 224.0.0.0/4 dev wifi"),
        0);
  }
  void TearDown() override {
    if (!is_private()) return;
    ASSERT_EQ(std::system("ip link del wifi; ip route replace 224.0.0.0/4 dev lo"), 0);
  }
  bool hears(Bus& to, Bus& from) {
    from.publish("HELLO", noise(100, 1));
    return collect(to, 1).size() == 1;
  }
};

TEST_F(Routes, PlainLcmProgramsOfTheHostAreHeardAndHearUs) {
  const int port = next_port();
  const auto ours = open_bus(url(port)), other = open_bus(url(port));
  const auto plain = open_bus(url(port, "&backend=liblcm"));
  EXPECT_TRUE(hears(*ours, *other));
  EXPECT_EQ(collect(*plain, 1).size(), 1u);
  EXPECT_TRUE(hears(*ours, *plain));
}

TEST_F(Routes, LosingTheInterfaceLosesNothingOfOurs) {
  const int port = next_port();
  const auto before = open_bus(url(port)), other = open_bus(url(port));
  ASSERT_EQ(std::system("ip link set wifi down"), 0);
  EXPECT_TRUE(hears(*before, *other));
  const auto after = open_bus(url(port));
  EXPECT_TRUE(hears(*before, *after));
  EXPECT_EQ(after->counters().send_failed, 0);
}

TEST_F(Routes, AnInterfaceThatTheUrlNamesCarriesTheMessages) {
  const int port = next_port();
  const std::string named = "udpm://239.255.76.67:" + std::to_string(port) + "?ttl=1&interface=wifi";
  const auto one = open_bus(named), two = open_bus(named);
  EXPECT_TRUE(hears(*one, *two));
  EXPECT_EQ(two->own_address() >> 16, 0x0a090807u) << "sent from wifi's address";
}

}  // namespace
}  // namespace lab
