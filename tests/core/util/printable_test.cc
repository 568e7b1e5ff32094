#include "core/util/printable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace lab {
namespace {

TEST(Printable, LeavesTextWithoutHiddenCharactersAlone) {
  for (const char* text : {"", "elbow_joint", "Ger\u00e4t \u5de6 \U0001f600", "C:\\x\\new", "it's \"x\""})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, ShowsBytesThatAreNotUtf8) {
  EXPECT_EQ(printable("Ger\xe4t"), "Ger\\xe4t");                     // Latin-1
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");                    // an overlong '/'
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");                    // the end is missing
  EXPECT_EQ(printable("\x80"), "\\x80");
}

TEST(Printable, ShowsWhatWouldActOnATerminal) {
  EXPECT_EQ(printable("a\x1b[31mb"), "a\\u001b[31mb");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\u0000b");
  EXPECT_EQ(printable("a\nb\r\tc\x7f"), "a\\nb\\r\\tc\\u007f");
  EXPECT_EQ(printable("\xc2\x9b"), "\\u009b");    // CSI in one character
  EXPECT_EQ(printable("a\u202eb"), "a\\u202eb");  // writes from right to left
  EXPECT_EQ(printable_lines("a\nb\x1b"), "a\nb\\u001b");
}

TEST(Printable, NamesHaveALengthThatTablesBear) {
  EXPECT_EQ(printable_name(""), "''");
  EXPECT_EQ(printable_name("wrist"), "wrist");
  EXPECT_EQ(printable_name(std::string(64, 'x')), std::string(64, 'x'));
  EXPECT_EQ(printable_name(std::string(4096, 'x')),
            std::string(40, 'x') + ".." + std::string(12, 'x') + " (4096 bytes)");
  const std::string cut = printable_name(std::string(300, '\xff'));
  EXPECT_LT(cut.size(), 80U);
}

// Whatever the bytes: the result is UTF-8 without control characters, and is its own picture.
TEST(Printable, AnyBytesBecomeTextThatStays) {
  std::mt19937 random(17);
  for (int i = 0; i < 2000; ++i) {
    std::string bytes(random() % 40, ' ');
    for (char& c : bytes) c = static_cast<char>(random() % 4 == 0 ? 0xc2 + random() % 0x3e : random());
    const std::string shown = printable(bytes);
    for (size_t at = 0; at < shown.size(); at += utf8_length(shown, at))
      ASSERT_GT(utf8_length(shown, at), 0U);
    EXPECT_TRUE(
        std::none_of(shown.begin(), shown.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }));
    EXPECT_EQ(printable(shown), shown);
  }
}

}  // namespace
}  // namespace lab
