// The schema and the generated count checks against lcm-gen itself: 200 random type trees, and a type with everything in
// it.
#include <gtest/gtest.h>

#include <counts/count_fault.cc>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <lab/command_t.hpp>
#include <lab/request_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <nlohmann/json.hpp>
#include <random>
#include <wiretest/torture_t.hpp>

#include "tests/support/paths.h"
#include "wire/schema/codec.h"
#include "wire/schema/guard.h"
#include "wire/schema/schema.h"

namespace {

// Bytes asked of the heap, to see a decoder that trusts a count.
size_t g_allocated = 0;

}  // namespace

// not inlined: g++ would see malloc on one side and delete on the other
[[gnu::noinline]] void* operator new(size_t n) {
  g_allocated += n;
  if (void* p = std::malloc(n)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, size_t) noexcept { std::free(p); }

namespace lab {
namespace {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<uint8_t>;

Bytes from_hex(const std::string& hex) {
  Bytes out;
  for (size_t i = 0; i + 1 < hex.size(); i += 2)
    out.push_back(static_cast<uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return out;
}

TEST(SchemaAgainstLcmGen, RandomTypeTrees) {
  const std::string folder = lab::build_path("tests/wire/random_types");
  std::filesystem::remove_all(folder);
  if (std::system("python3 -c 'import json, struct' 2>/dev/null") != 0) GTEST_SKIP() << "needs python3";
  const std::string command =
      "python3 " + lab::source_path("tests/conformance/random_types.py") + " " + folder + " 20261122 200";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;

  std::ifstream in(folder + "/cases.jsonl");
  std::string line;
  std::mt19937 rng(1);
  int trees = 0, types = 0, messages = 0;
  while (std::getline(in, line)) {
    const Json tree = Json::parse(line);
    std::vector<Source> sources;
    for (const Json& s : tree["sources"]) sources.push_back({s["file"], s["text"]});
    const Schema schema(sources);
    ++trees;
    for (const Json& c : tree["cases"]) {
      const Type* type = schema.find(c["type"].get<std::string>());
      ASSERT_TRUE(type) << c["type"];
      ++types;
      EXPECT_EQ(static_cast<uint64_t>(type->fingerprint),
                std::stoull(c["fingerprint"].get<std::string>(), nullptr, 16))
          << type->name << "\n"
          << tree["sources"];
      for (const Json& m : c["messages"]) {
        const Bytes bytes = from_hex(m["hex"]);
        ++messages;
        ASSERT_EQ(schema.check(*type, bytes), "") << type->name << "\n" << tree["sources"];
        ASSERT_EQ(to_json(schema.decode(*type, bytes)), m["content"]) << type->name;
        // nothing cut off and nothing added is a message
        Bytes longer = bytes;
        longer.push_back(0);
        ASSERT_NE(schema.check(*type, longer), "");
        ASSERT_NE(schema.check(*type, std::span(bytes).first(bytes.size() - 1)), "");
        ASSERT_NE(schema.check(*type, std::span(bytes).first(rng() % bytes.size())), "");
      }
    }
  }
  EXPECT_EQ(trees, 200);
  EXPECT_GT(types, 600);
  EXPECT_GT(messages, 1800);
}

// A message of the type that holds everything. Counts are small so that every byte gets its turn below.
wiretest::torture_t torture() {
  wiretest::torture_t m{};
  m.rows = 2;
  m.columns = 3;
  m.raw = {1, 255};
  m.grid = {{1, 2, 3}, {4, 5, 6}};
  for (auto& plane : (m.cube.resize(2), m.cube)) plane = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  m.names = {"", "two"};
  m.board = {{"a", "b", "c"}, {"", "", "zzz"}};
  m.pairs.resize(3);
  for (auto& p : m.pairs) p = {"pair", {1, 0, 1}};
  m.ok = 1;
  m.bits = {0, 1};
  m.root.n = 2;
  m.root.children.resize(2);
  m.root.children[1].n = 1;
  m.root.children[1].children.resize(1);
  m.nothing.resize(3);
  return m;
}

const Schema& torture_schema() {
  static const Schema schema = [] {
    std::ifstream in(lab::source_path("tests/wire/types/torture.lcm"));
    std::ostringstream text;
    text << in.rdbuf();
    return Schema(std::vector<Source>{{"torture.lcm", text.str()}});
  }();
  return schema;
}

template <class T>
Bytes encode_plain(const T& m) {
  Bytes out(static_cast<size_t>(m.getEncodedSize()));
  EXPECT_EQ(m.encode(out.data(), 0, static_cast<int>(out.size())), static_cast<int>(out.size()));
  return out;
}

TEST(CountFault, ComparesEveryDimensionThatIsCounted) {
  EXPECT_EQ(count_fault(torture()), "");
  const auto fault = [](const std::function<void(wiretest::torture_t&)>& change) {
    wiretest::torture_t m = torture();
    change(m);
    return count_fault(m);
  };
  const std::string type = "wiretest.torture_t: ";
  EXPECT_EQ(fault([](auto& m) { m.raw.pop_back(); }), type + "raw has 1 elements, rows is 2");
  EXPECT_EQ(fault([](auto& m) { m.grid[1].push_back(0); }), type + "grid has 4 elements, columns is 3");
  EXPECT_EQ(fault([](auto& m) { m.cube.pop_back(); }), type + "cube has 1 elements, must have 2");
  EXPECT_EQ(fault([](auto& m) { m.cube[1][2].push_back(0); }), type + "cube has 4 elements, must have 3");
  EXPECT_EQ(fault([](auto& m) { m.names.clear(); }), type + "names has 0 elements, rows is 2");
  EXPECT_EQ(fault([](auto& m) { m.board[1].pop_back(); }), type + "board has 2 elements, columns is 3");
  EXPECT_EQ(fault([](auto& m) { m.pairs.resize(4); }), type + "pairs has 4 elements, columns is 3");
  EXPECT_EQ(fault([](auto& m) { m.bits.pop_back(); }), type + "bits has 1 elements, rows is 2");
  EXPECT_EQ(fault([](auto& m) { m.nothing.pop_back(); }), type + "nothing has 2 elements, columns is 3");
  EXPECT_EQ(fault([](auto& m) { m.rows = -1; }), type + "raw has 2 elements, rows is -1");
  EXPECT_EQ(fault([](auto& m) { m.root.children[1].n = 2; }),
            "wiretest.node_t: children has 1 elements, n is 2");
}

TEST(SchemaAgainstLcmGen, FingerprintsOfGeneratedClasses) {
  const auto expect = [](const Schema& s, const char* name, int64_t hash) {
    EXPECT_EQ(s.find(name)->fingerprint, hash) << name;
  };
  expect(torture_schema(), "wiretest.torture_t", wiretest::torture_t::getHash());
  expect(torture_schema(), "wiretest.node_t", wiretest::node_t::getHash());  // recursive
  expect(torture_schema(), "wiretest.empty_t", wiretest::empty_t::getHash());
  expect(lab_schema(), "lab.robot_state_t", robot_state_t::getHash());
  expect(lab_schema(), "lab.request_t", request_t::getHash());  // nested
  expect(lab_schema(), "lab.run_t", run_t::getHash());
}

// Changes valid messages byte by byte. Whatever the walker accepts, the generated decoder must take whole,
// without asking for memory out of proportion, and give back the same bytes.
template <class T>
void mutate(const Schema& schema, const char* name, const T& message, int rounds) {
  const Type& type = *schema.find(name);
  const Bytes good = encode_plain(message);
  ASSERT_EQ(schema.check(type, good), "");
  std::mt19937 rng(7);
  int accepted = 0, refused = 0;
  const auto probe = [&](const Bytes& bytes) {
    const std::string why = schema.check(type, bytes);
    EXPECT_NO_THROW({
      if (why.empty()) schema.decode(type, bytes);
    });
    if (!why.empty()) {
      ++refused;
      return;
    }
    ++accepted;
    T out;
    g_allocated = 0;
    ASSERT_EQ(out.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
    // elements that take no bytes may add up to the walker's allowance (65536 containers of at most 200
    // bytes, doubled by a vector's growth); everything else follows the message's length
    EXPECT_LT(g_allocated, 400 * (bytes.size() + 65536));
    ASSERT_EQ(encode_plain(out), bytes);
  };
  for (size_t i = 0; i <= good.size(); ++i)
    probe(Bytes(good.begin(), good.begin() + static_cast<ptrdiff_t>(i)));
  for (size_t i = 0; i < good.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes bytes = good;
      bytes[i] ^= static_cast<uint8_t>(1 << bit);
      probe(bytes);
    }
    for (uint8_t value : {0x00, 0x7f, 0x80, 0xff}) {
      Bytes bytes = good;
      bytes[i] = value;
      probe(bytes);
    }
  }
  for (int round = 0; round < rounds; ++round) {
    Bytes bytes = good;
    for (unsigned k = 1 + rng() % 4; k > 0; --k) {
      switch (rng() % 4) {
        case 0:
          bytes[8 + rng() % (bytes.size() - 8)] = static_cast<uint8_t>(rng());
          break;
        case 1:
          bytes[8 + rng() % (bytes.size() - 8)] ^= static_cast<uint8_t>(1 << rng() % 8);
          break;
        case 2:
          bytes.resize(8 + rng() % (bytes.size() - 8) + 1);
          break;
        case 3:
          bytes.insert(bytes.begin() + 8 + rng() % (bytes.size() - 8), 1 + rng() % 9,
                       static_cast<uint8_t>(rng()));
          break;
      }
    }
    probe(bytes);
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 50);
}

TEST(SchemaAgainstLcmGen, MutatedMessagesNeverHurtTheGeneratedDecoder) {
  mutate(torture_schema(), "wiretest.torture_t", torture(), 20000);
  robot_state_t state{};
  state.nq = state.nv = 2;
  state.q = state.v = state.tau = {0.5, -3};
  mutate(lab_schema(), "lab.robot_state_t", state, 5000);
  request_t request{};
  request.sender = "me";
  request.action.verb = "set";
  request.action.n = 3;
  request.action.values = {1, 2, 3};
  mutate(lab_schema(), "lab.request_t", request, 5000);
  run_t run{};
  run.experiment = "robot: x\n";
  run.njoints = 2;
  run.joint_names = {"a", "b"};
  mutate(lab_schema(), "lab.run_t", run, 5000);
}

// Counts that would cost the generated decoder gigabytes or for ever, although no byte stands for the
// elements.
TEST(SchemaAgainstLcmGen, CountsWithoutBytesAreRefused) {
  const Type& type = *torture_schema().find("wiretest.torture_t");
  wiretest::torture_t m = torture();
  m.rows = m.columns = 0;
  m.raw.clear();
  m.grid.clear();
  m.names.clear();
  m.pairs.clear();
  m.bits.clear();
  m.nothing.clear();
  for (auto& plane : m.cube) plane.clear();
  for (auto& line : m.board) line.clear();
  Bytes bytes = encode_plain(m);
  ASSERT_EQ(torture_schema().check(type, bytes), "");
  const int rows_at = torture_schema().fixed_offset(type, "rows"),
            columns_at = torture_schema().fixed_offset(type, "columns");
  ASSERT_EQ(rows_at, 8 + 3);
  ASSERT_EQ(columns_at, 8 + 7);
  bytes[rows_at] = 0x7f;  // two thousand million rows of no columns
  EXPECT_NE(torture_schema().check(type, bytes), "");
  bytes[rows_at] = 0xff;
  EXPECT_EQ(torture_schema().check(type, bytes), "rows is -16777216");
  bytes[rows_at] = 0;
  bytes[columns_at] = 0x7f;  // 2^63 nearly
  EXPECT_NE(torture_schema().check(type, bytes), "");
}

}  // namespace
}  // namespace lab
