// Whether a wait begins with a look for the next packet, by the processor's time that it costs. Runs in a private network namespace
// (tests/support/netns.sh).
#include <gtest/gtest.h>
#include <time.h>

#include "tests/wire/bus/bus_user.h"
#include "wire/protocol/role.h"

namespace lab {
namespace {

/// us of the processor that a thousand waits of 100 us for nothing take.
int64_t cost(Bus& bus, int64_t batch_us) {
  const auto used = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return t.tv_sec * 1'000'000 + t.tv_nsec / 1000;
  };
  const int64_t before = used();
  for (int n = 0; n < 1000; ++n) bus.poll(100, [](const Datagram&) {}, batch_us);
  return used() - before;
}

// An answer within 30 us is found without a sleep; who waits for nothing in particular sleeps at once. Half of 30 ms is left for
// what the system calls of the two differ by.
TEST(OwnEndpoint, LooksForAnAnswerBeforeItSleepsUnlessItIsToldNotTo) {
  const auto bus = open_bus(url(next_port()));
  const int64_t sleeping = cost(*bus, kNoSpin);
  EXPECT_GT(cost(*bus, 0), sleeping + 15'000);
}

}  // namespace
}  // namespace lab
