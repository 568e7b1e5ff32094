// The parser's errors, the walker's reasons, and the tree's text.
#include "wire/schema/schema.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/util/json_text.h"
#include "wire/schema/schema_parse.h"

namespace lab {
namespace {

using Bytes = std::vector<uint8_t>;

Schema one(const std::string& file, const std::string& text) {
  return Schema(std::vector<Source>{{file, text}});
}

std::string parse_error(const std::string& text) {
  try {
    one("x.lcm", text);
  } catch (const SchemaError& e) {
    return e.what();
  }
  return "";
}

TEST(SchemaParser, ErrorsNameFileAndLine) {
  EXPECT_EQ(parse_error("package a;\nstruct s {\n  int32_t n\n}\n"), "x.lcm:4: expected ';', found '}'");
  EXPECT_EQ(parse_error("struct s {\n  other_t o;\n}\n"),
            "x.lcm:2: member 'o' of s has the unknown type 'other_t'");
  EXPECT_EQ(parse_error("struct s {\n int32_t a;\n int8_t a;\n}"), "x.lcm:3: two members named 'a'");
  EXPECT_EQ(parse_error("struct s {\n double x[n];\n int32_t n;\n}"),
            "x.lcm:2: array size 'n' is neither a number nor a member or constant declared before");
  EXPECT_EQ(parse_error("struct s { double n; double x[n]; }"),
            "x.lcm:1: array size 'n' must be a single integer member");
  EXPECT_EQ(parse_error("struct s { int8_t x[0]; }"),
            "x.lcm:1: array size '0' must be a whole number from 1 to 2147483647");
  EXPECT_EQ(parse_error("struct s { const int8_t X = 200; }"), "x.lcm:1: '200' is not an int8_t");
  EXPECT_EQ(parse_error("struct s { const string X = 2; }"),
            "x.lcm:1: 'string' cannot be the type of a constant");
  EXPECT_EQ(parse_error("struct s {"), "x.lcm:1: expected a type, found the end of the text");
  EXPECT_EQ(parse_error("\n/* never"), "x.lcm:2: a comment that starts here never ends");
  EXPECT_EQ(parse_error("union s { }"), "x.lcm:1: expected package, struct or enum, found 'union'");
  EXPECT_EQ(parse_error("struct s { struct t { } }"), "x.lcm:1: a struct cannot be declared inside a struct");
  EXPECT_EQ(parse_error("struct s { }\nstruct s { }"),
            "x.lcm:2: struct s is declared twice, before in x.lcm");
  EXPECT_EQ(parse_error("struct s { int32_t n[n]; }"),
            "x.lcm:1: array size 'n' is neither a number nor a member or constant declared before");
  EXPECT_EQ(parse_error("enum e { A = 1, B = 1 }"), "x.lcm:1: enum values 'A' and 'B' are the same");
  EXPECT_EQ(parse_error("enum e { A = 1, A = 2 }"), "x.lcm:1: enum values 'A' and 'A' are the same");
}

TEST(SchemaParser, KindsHaveTheNamesOfTheTexts) {
  std::string names;
  for (int kind = 0; kind <= static_cast<int>(Kind::Struct); ++kind)
    names += std::string(kind_name(static_cast<Kind>(kind))) + " ";
  EXPECT_EQ(names, "int8_t int16_t int32_t int64_t byte float double string boolean enum struct ");
}

TEST(SchemaParser, TextThatIsNotEvenClose) {
  // every prefix and every single deletion of a good text parses or throws SchemaError, nothing else
  const std::string good =
      "package a.b; enum e { A = 1, B }\nstruct s { const float F = 1.5; int8_t n; e k; s t[n][2]; }";
  EXPECT_EQ(parse_error(good), "");
  int errors = 0;
  for (size_t i = 0; i < good.size(); ++i) {
    errors += !parse_error(good.substr(0, i)).empty();
    errors += !parse_error(std::string(good).erase(i, 1)).empty();
    errors += !parse_error(std::string(good).replace(i, 1, 1, '\xff')).empty();
  }
  EXPECT_GT(errors, 150);
}

TEST(SchemaParser, EnumsAsLcmGenHasThem) {
  // 0x7636f6d82a7e5b6 and the struct's hash: lcm-gen 1.3.1 -p for this text
  const Schema s = one("e.lcm", R"(package a.b;
enum color_t { RED = 1, GREEN, BLUE }
struct p_t { int32_t n; color_t c; double x[n][3]; p_t kids[n]; byte raw[n]; boolean ok; })");
  const uint64_t sum = 0xe4877c347028989b + 0x7636f6d82a7e5b6;  // own, enum, and 0 for itself
  EXPECT_EQ(static_cast<uint64_t>(s.find("a.b.p_t")->fingerprint), std::rotl(sum, 1));
  EXPECT_EQ(s.find("a.b.p_t")->fields[1].kind, Kind::Enum);
  EXPECT_EQ(s.find(s.find("a.b.p_t")->fingerprint), s.find("a.b.p_t"));
}

// 0x21f0.. and the others: lcm-gen 1.5.3 -p for these texts (1.3.1 has no such sizes)
TEST(SchemaParser, ConstantsAsSizesAsLcmGen15HasThem) {
  const auto own = [](const std::string& members) {
    const Schema s = one("c.lcm", "struct c_t { " + members + " }");
    return std::rotr(static_cast<uint64_t>(s.types()[0].fingerprint), 1);
  };
  EXPECT_EQ(own("const int32_t N = 3; double x[N];"), 0x21f0a3980ef3355au);
  EXPECT_EQ(own("double x[3];"), 0x21f0a3980ef3355au);
  EXPECT_EQ(own("const int32_t N = 0x3; double x[N];"), 0x5c67f10ccca84514u) << "the text counts";
  EXPECT_EQ(own("int32_t n; const int8_t M = 2, K = 4; double x[n][M]; int8_t y[K];"), 0x8b452753fe93b620u);
  const Schema s = one("c.lcm", "struct c_t { const int32_t N = 0x3; int8_t x[N][2]; }");
  EXPECT_EQ(s.types()[0].fields[0].dims[0].size, 3);

  EXPECT_EQ(parse_error("struct s { double x[N]; const int32_t N = 3; }"),
            "x.lcm:1: array size 'N' is neither a number nor a member or constant declared before");
  EXPECT_EQ(parse_error("struct s { const int32_t N = -3;\n double x[N]; }"),
            "x.lcm:2: array size '-3' must be a whole number from 1 to 2147483647");
  EXPECT_EQ(parse_error("struct s { const double N = 3.5; double x[N]; }"),
            "x.lcm:1: array size '3.5' must be a whole number from 1 to 2147483647");
  EXPECT_EQ(parse_error("struct o { const int32_t N = 3; } struct s { double x[N]; }"),
            "x.lcm:1: array size 'N' is neither a number nor a member or constant declared before");
}

TEST(SchemaParser, OfManyTextsTheUsableOnesAreKept) {
  std::vector<std::string> faults;
  const Schema s(
      {{"a.lcm", "package a; struct pose_t { double x; }"},
       {"broken.lcm", "package b;\nstruct t { int32_t n; double v[m]; }"},
       {"twice.lcm", "package a; struct new_t { int8_t i; }\nstruct pose_t { float x; }"},
       {"needs_needs.lcm", "struct c { b x; }"},
       {"needs.lcm", "struct b {\n lost.t x; }"},
       {"uses.lcm", "struct d { a.pose_t x; a.new_t y; }"},
       {"cousin.lcm", "package b; struct pose_t { double x; } struct e { a.pose_t p; a.kind_t k; }"},
       {"kind.lcm", "package a; enum kind_t { A }"}},
      [&](const std::string& why) { faults.push_back(why); });
  EXPECT_EQ(faults,
            (std::vector<std::string>{
                "broken.lcm:2: array size 'm' is neither a number nor a member or constant declared before",
                "twice.lcm:2: struct a.pose_t is declared twice, before in a.lcm",
                "needs.lcm:2: member 'x' of b has the unknown type 'lost.t'",
                "uses.lcm:1: member 'y' of d has the unknown type 'a.new_t'",
                "needs_needs.lcm:1: member 'x' of c has the unknown type 'b'"}));
  ASSERT_EQ(s.types().size(), 3u);
  EXPECT_EQ(s.sources().size(), 3u);
  EXPECT_EQ(s.sources()[s.find("b.e")->source].file, "cousin.lcm");
  EXPECT_EQ(s.find("b.e")->fields[1].kind, Kind::Enum);
  const auto equal = s.all_of(s.find("a.pose_t")->fingerprint);
  ASSERT_EQ(equal.size(), 2u);
  EXPECT_EQ(equal[0]->name + "|" + equal[1]->name, "a.pose_t|b.pose_t");
}

TEST(SchemaParser, DeepSharingIsNotExponential) {
  // each type holds the one before twice: 2^60 paths, 60 types
  std::string text = "struct t0 { int8_t x; }\n";
  for (int i = 1; i <= 60; ++i) {
    const std::string before = std::to_string(i - 1);
    text += "struct t" + std::to_string(i) + " { t" + before + " a; t" + before + " b; }\n";
  }
  const Schema s = one("deep.lcm", text);
  EXPECT_NE(s.find("t60")->fingerprint, 0);
}

Bytes message(const Type& type, std::initializer_list<int> rest) {
  Bytes out;
  for (int shift = 56; shift >= 0; shift -= 8)
    out.push_back(static_cast<uint8_t>(static_cast<uint64_t>(type.fingerprint) >> shift));
  for (int b : rest) out.push_back(static_cast<uint8_t>(b));
  return out;
}

TEST(SchemaWalker, ReasonsNameFieldValueAndBound) {
  const Schema s = one("x.lcm",
                       "struct in { boolean b; string s; } struct out { int16_t n; in list[n]; float f; "
                       "int8_t m; double d[m]; }");
  const Type& t = *s.find("out");
  const auto why = [&](std::initializer_list<int> rest) { return s.check(t, message(t, rest)); };
  EXPECT_EQ(why({0, 1, 1, 0, 0, 0, 2, 'a', 0, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(why({0xff, 0xfe, 0, 0, 0, 0, 0}), "n is -2");
  EXPECT_EQ(why({0, 1, 2}), "list[0].b is 2, a boolean is 0 or 1");
  EXPECT_EQ(why({0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}),
            "list[0].s has length 0, with its NUL it is at least 1");
  EXPECT_EQ(why({0, 1, 1, 0, 0, 0, 9, 0, 0, 0, 0, 0}), "list[0].s has length 9, 5 bytes are left");
  EXPECT_EQ(why({0, 1, 1, 0, 0, 0, 1, 'x', 0, 0, 0, 0, 0}), "list[0].s does not end in NUL");
  EXPECT_EQ(why({0, 1, 1, 0, 0, 0, 3, 'x', 0, 0, 0, 0, 0, 0, 0}), "list[0].s has a NUL inside, at 1");
  EXPECT_EQ(why({0, 0, 0x7f, 0x80, 0, 0, 0}), "f is inf");
  EXPECT_EQ(why({0, 0, 0xff, 0x80, 0, 0, 0}), "f is -inf");
  EXPECT_EQ(why({0, 0, 0, 0, 0, 0, 1, 0x7f, 0xf0, 0, 0, 0, 0, 0, 1}), "d[0] is nan");
  EXPECT_EQ(why({0, 0, 0, 0, 0, 0, 2, 0, 0, 0}), "d needs 16 bytes, 3 are left");
  EXPECT_EQ(why({0, 0, 0, 0, 0, 0, 0, 7}), "1 bytes are left over at the end");
  EXPECT_EQ(why({}), "n needs 2 bytes, 0 are left");
  EXPECT_EQ(s.check(t, Bytes{1, 2, 3}), "only 3 bytes, the fingerprint alone takes 8");
  EXPECT_NE(s.check(*s.find("in"), message(t, {})).find("is not that of in (0x"), std::string::npos);
  // a spy may look at what a process must not take
  EXPECT_EQ(s.check(t, message(t, {0, 0, 0x7f, 0x80, 0, 0, 0}), {.finite = false}), "");
}

TEST(SchemaWalker, FinitenessFollowsTheBits) {
  // every combination of sign and exponent, with three mantissas: only the all-ones exponent is refused
  const Schema s = one("x.lcm", "struct d { double x[3]; } struct f { float x[5]; }");
  for (int exponent = 0; exponent < 2048; ++exponent) {
    for (uint64_t sign = 0; sign < 2; ++sign) {
      const uint64_t bits = sign << 63 | static_cast<uint64_t>(exponent) << 52 | 5;
      Bytes m = message(*s.find("d"), {});
      m.resize(8 + 24);
      for (int i = 0; i < 8; ++i) m[8 + 8 + i] = static_cast<uint8_t>(bits >> (56 - 8 * i));
      EXPECT_EQ(s.check(*s.find("d"), m).empty(), exponent != 2047) << exponent;
      if (exponent >= 256) continue;
      const uint32_t narrow = static_cast<uint32_t>(sign) << 31 | static_cast<uint32_t>(exponent) << 23 | 3;
      Bytes n = message(*s.find("f"), {});
      n.resize(8 + 20);
      for (int i = 0; i < 4; ++i) n[8 + 16 + i] = static_cast<uint8_t>(narrow >> (24 - 8 * i));
      EXPECT_EQ(s.check(*s.find("f"), n).empty(), exponent != 255) << exponent;
    }
  }
}

TEST(SchemaWalker, EndlessTypesEndAtTheDepthBound) {
  const Schema s = one("x.lcm", "struct a { int8_t n; a next[n]; } struct b { b self; }");
  Bytes chain = message(*s.find("a"), {});
  chain.insert(chain.end(), 33, 1);
  chain.push_back(0);
  EXPECT_NE(s.check(*s.find("a"), chain).find("is nested deeper than 32"), std::string::npos);
  EXPECT_NE(s.check(*s.find("b"), message(*s.find("b"), {})).find("is nested deeper than 32"),
            std::string::npos);
}

TEST(SchemaWalker, HugeFixedArraysCostNothing) {
  const Schema s = one("x.lcm",
                       "struct e { } struct a { e x[2147483647][2147483647][2147483647]; } struct b { double "
                       "x[0x7fffffff][0x7fffffff]; }");
  EXPECT_EQ(s.check(*s.find("a"), message(*s.find("a"), {})),
            "x has 1152921504606846976 elements, more than the message can hold");
  EXPECT_NE(s.check(*s.find("b"), message(*s.find("b"), {})), "");
}

TEST(Value, TextJsonAndPaths) {
  const Schema s =
      one("x.lcm",
          "struct in { float f; } struct out { int8_t n; double q[n]; in list[2]; string s; boolean b; }");
  const Type& t = *s.find("out");
  // q = {0.1, nan}; list = {0.1f, -2}; s = "a\xff"; b = true
  const Value v = s.decode(
      t,
      message(t, {2,    0x3f, 0xb9, 0x99, 0x99, 0x99, 0x99, 0x99, 0x9a, 0x7f, 0xf8, 0, 0,   0,    0, 0, 0,  //
                  0x3d, 0xcc, 0xcc, 0xcd, 0xc0, 0,    0,    0,    0,    0,    0,    3, 'a', 0xff, 0, 1}));
  EXPECT_EQ(to_text(v),
            "n: 2\nq: [0.1, nan]\nlist[0]:\n  f: 0.1\nlist[1]:\n  f: -2\ns: \"a\\\\xff\"\nb: true\n");
  const auto json = to_json(v);
  EXPECT_EQ(json["q"].dump(), "[0.1,null]");
  EXPECT_EQ(json_text(json["s"]), R"("a\\xff")");
  EXPECT_EQ(json["list"][1]["f"], -2);
  EXPECT_EQ(v.at("q[0]")->number(), 0.1);
  EXPECT_EQ(v.at("list[1].f")->number(), -2);
  EXPECT_EQ(v.at("b")->number(), 1);
  for (const char* path : {"q[2]", "q[", "q[0", "q[-1]", "list.f", "nothing", "s.x", "q[0]x"})
    EXPECT_EQ(v.at(path), nullptr) << path;
}

}  // namespace
}  // namespace lab
