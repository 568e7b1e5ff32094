#include "procs/spy/periods.h"

#include <gtest/gtest.h>

namespace lab::spy {
namespace {

TEST(Periods, OfUnevenMessages) {
  const Periods seen = periods({1'000, 4'000, 5'000, 10'000, 13'000}, 1);
  EXPECT_EQ(seen.least, 1'000);
  EXPECT_EQ(seen.most, 5'000);
  EXPECT_DOUBLE_EQ(seen.hz, 4 / 0.012);  // periods over the time that they took
}

TEST(Periods, OfFewMessages) {
  EXPECT_EQ(periods({}, 2).hz, 0);
  EXPECT_EQ(periods({7'000}, 2).hz, 0.5);
  EXPECT_EQ(periods({7'000}, 2).least + periods({7'000}, 2).most, 0);
  const Periods two = periods({7'000, 9'000}, 2);
  EXPECT_EQ(two.least, 2'000);
  EXPECT_EQ(two.most, 2'000);
  EXPECT_DOUBLE_EQ(two.hz, 500);
}

}  // namespace
}  // namespace lab::spy
