// The types that a spy knows: from files, also from ones that are no good, and from TYPE messages.
#include "procs/spy/types.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/util/big_endian.h"

namespace lab::spy {
namespace {

namespace fs = std::filesystem;

class TypesTest : public testing::Test {
 protected:
  TypesTest() { fs::create_directories(folder_); }
  ~TypesTest() override { fs::remove_all(folder_); }
  std::string file(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(folder_ + "/" + name).parent_path());
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }
  Types types(const std::vector<std::string>& paths) {
    return {paths, [this](const std::string& why) { warnings_.push_back(why); }};
  }
  static std::vector<uint8_t> message_of(const Types& types, const char* name) {
    std::vector<uint8_t> bytes(8);
    store_big_endian(bytes.data(), types.schema().find(name)->fingerprint);
    return bytes;
  }
  const std::string folder_ = testing::TempDir() + "types_" + std::to_string(getpid());
  std::vector<std::string> warnings_;
};

TEST_F(TypesTest, FilesAndFoldersBesideEachOther) {
  const std::string one = file("a.lcm", "package a; struct pose_t { double x; }");
  file("more/deep/b.lcm", "package b; struct pose_t { double x; } struct pair_t { a.pose_t first; }");
  const Types known = types({one, folder_ + "/more", one});
  EXPECT_EQ(warnings_, std::vector<std::string>{});
  EXPECT_EQ(known.name_of("POSE", message_of(known, "a.pose_t")), "a.pose_t|b.pose_t");
  EXPECT_EQ(known.name_of("PAIR", message_of(known, "b.pair_t")), "b.pair_t");
  EXPECT_EQ(known.name_of("ROBOT_STATE", message_of(known, "lab.robot_state_t")), "lab.robot_state_t");
  EXPECT_EQ(known.name_of("X", std::vector<uint8_t>{0, 0, 0, 0, 0, 0, 1, 2}), "? 0000000000000102");
}

// a struct that looks like one of the lab's has both names, but on the lab's own channel
TEST_F(TypesTest, OnAChannelOfTheLabTheLabsNameCounts) {
  const std::string twin =
      file("t.lcm",
           "package twin; struct ack_t { int64_t utime; int64_t run; int64_t step; string process; "
           "int64_t complete_to; boolean closed; }");
  const Types known = types({twin});
  EXPECT_EQ(known.name_of("ACK", message_of(known, "twin.ack_t")), "lab.ack_t");
  EXPECT_EQ(known.name_of("MY_ACK", message_of(known, "twin.ack_t")), "lab.ack_t|twin.ack_t");
}

TEST_F(TypesTest, WhatCannotBeUsedIsAWarningAndTheRestIsUsed) {
  const std::string bad = file("bad.lcm", "package x;\nstruct a_t { int32_t n; double v[m]; }\n");
  const std::string binary = file("binary.lcm", std::string(5000, '\x7f'));
  const std::string own = file("own.lcm", "package lab; struct ack_t { int8_t x; }");
  fs::create_directories(folder_ + "/empty");
  const std::string good = file("good.lcm", "package g; struct g_t { const int8_t N = 2; int8_t x[N]; }");
  const Types known = types({bad, "/nowhere/x.lcm", folder_ + "/empty", "/dev/null", binary, own, good});
  EXPECT_EQ(warnings_,
            (std::vector<std::string>{
                "/nowhere/x.lcm: there is no such file or folder",
                folder_ + "/empty: there is no .lcm file in this folder", "/dev/null: cannot be read",
                bad + ":2: array size 'm' is neither a number nor a member or constant declared before",
                binary + ":1: expected package, struct or enum, found '" + std::string(60, '\x7f') + "..'",
                own + ":1: struct lab.ack_t is declared twice, before in lcmtypes"}));
  EXPECT_TRUE(known.schema().find("g.g_t"));
  EXPECT_EQ(known.schema().find("lab.ack_t")->fields.size(), 6u);
}

// twelve types that all hold each other: their fingerprints would take for ever
TEST_F(TypesTest, TypesThatCannotBeHashedAreAWarning) {
  std::string text;
  for (int i = 0; i < 12; ++i) {
    text += "struct t" + std::to_string(i) + " {";
    for (int k = 0; k < 12; ++k) text += " t" + std::to_string(k) + " m" + std::to_string(k) + ";";
    text += " }\n";
  }
  const Types known = types({file("tangle.lcm", text)});
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_TRUE(warnings_[0].ends_with("types nest each other too often to hash; no --types are used"));
  EXPECT_TRUE(known.schema().find("lab.run_t"));
}

TEST_F(TypesTest, LearnsFromTypeMessages) {
  Types known = types({});
  known.learn("package a; struct b_t { c_t part; }");
  EXPECT_FALSE(known.schema().find("a.b_t")) << "its part is not known yet";
  known.learn("package a; struct c_t { int8_t x; }");
  known.learn("package a; struct b_t { c_t part; }");
  EXPECT_TRUE(known.schema().find("a.b_t"));
}

}  // namespace
}  // namespace lab::spy
