#include "core/util/number.h"

#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace lab {
namespace {

std::string printed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

TEST(Number, AsPeopleWriteIt) {
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(-2), "-2");
  EXPECT_EQ(number(1e-9), "1e-09");
  EXPECT_EQ(number(0.1 + 0.2), "0.30000000000000004");
}

TEST(Number, ReadsBackAsTheSameDoubleAndNoShorterTextDoes) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 10000; ++i) {
    const auto value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    const std::string text = number(value);
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), value) << text;
    const auto digits = [](const std::string& s) {
      const std::string m = s.substr(0, s.find('e'));
      int n = 0;
      for (const char c : m) n += std::isdigit(static_cast<unsigned char>(c)) != 0;
      return n;
    };
    const int n = digits(text);
    if (text.find('e') == text.npos || n < 2) continue;
    EXPECT_NE(std::strtod(printed(value, n - 1).c_str(), nullptr), value) << text;
  }
}

TEST(Rounded, IsPrintfsG) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> exponent(-20, 20), sign(-1, 1);
  for (int i = 0; i < 10000; ++i) {
    const double value = sign(random) * std::pow(10, exponent(random));
    for (const int digits : {1, 3, 4, 9, 17}) EXPECT_EQ(rounded(value, digits), printed(value, digits));
  }
  for (const double value : {0.0, -0.0, double(NAN), double(INFINITY), -double(INFINITY), 99999.5, 1e308})
    EXPECT_EQ(rounded(value), printed(value, 4));
}

}  // namespace
}  // namespace lab
