#include "core/util/big_endian.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace lab {
namespace {

template <class T>
class BigEndianTest : public testing::Test {};
using Integers = testing::Types<int8_t, uint8_t, int16_t, uint16_t, int32_t, uint32_t, int64_t, uint64_t>;
TYPED_TEST_SUITE(BigEndianTest, Integers);

template <class T>
std::vector<T> samples() {
  using Limits = std::numeric_limits<T>;
  return {T(0), T(1), T(0x7b), Limits::min(), Limits::max(), static_cast<T>(0x8123456789abcdefULL)};
}

// The definition, digit by digit in base 256.
TYPED_TEST(BigEndianTest, BytesAreDigitsMostSignificantFirst) {
  for (const TypeParam value : samples<TypeParam>()) {
    std::array<uint8_t, 16> bytes;
    bytes.fill(0x5a);
    store_big_endian(&bytes[3], value);
    auto rest = static_cast<uint64_t>(value);
    for (size_t i = sizeof value; i-- > 0; rest /= 256) EXPECT_EQ(bytes[3 + i], rest % 256) << +value;
    EXPECT_EQ(bytes[2], 0x5a);
    EXPECT_EQ(bytes[3 + sizeof value], 0x5a);
  }
}

TYPED_TEST(BigEndianTest, LoadReadsWhatStoreWrites) {
  for (const TypeParam value : samples<TypeParam>()) {
    uint8_t bytes[9];
    store_big_endian(bytes + 1, value);  // not aligned
    EXPECT_EQ(load_big_endian<TypeParam>(bytes + 1), value);
  }
}

TYPED_TEST(BigEndianTest, AppendKeepsWhatIsThere) {
  std::vector<uint8_t> out{7, 8};
  append_big_endian(out, static_cast<TypeParam>(5));
  ASSERT_EQ(out.size(), 2 + sizeof(TypeParam));
  EXPECT_EQ(out[0], 7);
  EXPECT_EQ(out[1], 8);
  EXPECT_EQ(load_big_endian<TypeParam>(&out[2]), 5);
}

TEST(BigEndian, IsTheByteOrderOfTheNetwork) {
  uint8_t bytes[4];
  store_big_endian(bytes, uint32_t{0x01020304});
  uint32_t word;
  std::memcpy(&word, bytes, 4);
  EXPECT_EQ(ntohl(word), 0x01020304u);
}

}  // namespace
}  // namespace lab
