// The wire format without a network: packets, reassembly, the socket filter.
#include "wire/bus/udpm_wire.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/util/big_endian.h"
#include "wire/bus/udpm_filter.h"

namespace lab::udpm {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes short_packet(uint32_t sequence, const std::string& channel, const Bytes& data) {
  Bytes out(kShortHeader);
  store_big_endian(out.data(), kShort);
  store_big_endian(&out[4], sequence);
  out.insert(out.end(), channel.begin(), channel.end());
  out.push_back(0);
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

// A message cut into parts of at most `most` bytes of data.
std::vector<Bytes> fragments(uint32_t sequence, const std::string& channel, const Bytes& data, size_t most) {
  const size_t count = (data.size() + most - 1) / most;
  std::vector<Bytes> out;
  for (size_t i = 0; i < count; ++i) {
    Bytes p(kFragmentHeader);
    store_big_endian(p.data(), kFragment);
    store_big_endian(&p[4], sequence);
    store_big_endian(&p[8], static_cast<uint32_t>(data.size()));
    store_big_endian(&p[12], static_cast<uint32_t>(i * most));
    store_big_endian(&p[16], static_cast<uint16_t>(i));
    store_big_endian(&p[18], static_cast<uint16_t>(count));
    if (i == 0) p.insert(p.end(), channel.c_str(), channel.c_str() + channel.size() + 1);
    const auto begin = data.begin() + static_cast<ptrdiff_t>(i * most);
    p.insert(p.end(), begin, begin + static_cast<ptrdiff_t>(std::min(most, data.size() - i * most)));
    out.push_back(std::move(p));
  }
  return out;
}

Bytes noise(size_t n, uint32_t seed) {
  std::mt19937 rng(seed);
  Bytes out(n);
  for (uint8_t& b : out) b = static_cast<uint8_t>(rng());
  return out;
}

TEST(UdpmPacket, ShortAndItsLimits) {
  const Bytes bytes = short_packet(0x01020304, "CHANNEL", {7, 8, 9});
  const auto p = parse_packet(bytes);
  ASSERT_TRUE(p);
  EXPECT_FALSE(p->fragment);
  EXPECT_EQ(p->sequence, 0x01020304u);
  EXPECT_EQ(p->channel, "CHANNEL");
  EXPECT_EQ(Bytes(p->data.begin(), p->data.end()), (Bytes{7, 8, 9}));
  EXPECT_TRUE(parse_packet(short_packet(1, std::string(63, 'x'), {})));
  EXPECT_FALSE(parse_packet(short_packet(1, std::string(64, 'x'), {})));
  for (size_t n = 0; n < 8 + 8; ++n)
    EXPECT_FALSE(parse_packet(std::span(bytes).first(n))) << n;  // the name must end
  Bytes other = bytes;
  other[3] ^= 1;  // LC03 with a short body
  EXPECT_FALSE(parse_packet(other));
  other[0] = 0;
  EXPECT_FALSE(parse_packet(other));
}

TEST(UdpmPacket, FragmentsThatLie) {
  const Bytes good = fragments(1, "C", noise(100, 1), 60)[1];
  ASSERT_TRUE(parse_packet(good));
  const auto with = [&](size_t at, uint8_t value) {
    Bytes bad = good;
    bad[at] = value;
    return parse_packet(bad).has_value();
  };
  EXPECT_FALSE(with(17, 2));   // part 2 of 2
  EXPECT_FALSE(with(19, 0));   // of none
  EXPECT_FALSE(with(15, 61));  // ends behind the message
  EXPECT_FALSE(with(12, 0xff));
  EXPECT_FALSE(with(17, 0));  // part 0 has a channel: these bytes hold no NUL within 64
}

TEST(UdpmAssembler, AnyOrderTwiceOverAndInterleavedSenders) {
  std::mt19937 rng(5);
  Assembler assembler(1 << 20);
  for (int round = 0; round < 200; ++round) {
    struct Piece {
      uint64_t sender;
      Bytes bytes;
    };
    std::vector<Piece> pieces;
    std::vector<Bytes> data;
    for (uint64_t sender = 1; sender <= 3; ++sender) {
      data.push_back(noise(200 + rng() % 3000, static_cast<uint32_t>(rng())));
      for (Bytes& f :
           fragments(static_cast<uint32_t>(round), "C" + std::to_string(sender), data.back(), 150)) {
        if (rng() % 4 == 0)
          pieces.push_back({sender, f});  // the network may double a packet; the double comes first or last
        pieces.push_back({sender, std::move(f)});
      }
    }
    std::shuffle(pieces.begin(), pieces.end(), rng);
    std::vector<int> whole(4);
    for (const Piece& piece : pieces) {
      const auto result = assembler.add(piece.sender, *parse_packet(piece.bytes));
      ASSERT_NE(result, Assembler::Result::Bad);
      if (result != Assembler::Result::Whole) continue;
      ++whole[piece.sender];
      EXPECT_EQ(assembler.whole().channel, "C" + std::to_string(piece.sender));
      EXPECT_EQ(assembler.whole().data, data[piece.sender - 1]);
    }
    EXPECT_EQ(whole, (std::vector<int>{0, 1, 1, 1}));
  }
}

TEST(UdpmAssembler, ContradictionsAndBounds) {
  Assembler assembler(10'000);
  const auto add = [&](uint64_t sender, const Bytes& bytes) {
    return assembler.add(sender, *parse_packet(bytes));
  };
  using Result = Assembler::Result;
  // too large a claim
  EXPECT_EQ(add(1, fragments(1, "C", noise(10'001, 1), 6000)[0]), Result::Bad);
  EXPECT_EQ(assembler.half_done(), 0u);
  // another size under the same number
  EXPECT_EQ(add(1, fragments(1, "C", noise(9000, 1), 6000)[0]), Result::More);
  EXPECT_EQ(add(1, fragments(1, "C", noise(9001, 1), 6000)[1]), Result::Bad);
  EXPECT_EQ(assembler.half_done(), 0u);
  // all parts there, but they do not fill the message
  auto holes = fragments(2, "C", noise(9000, 1), 6000);
  holes[1].pop_back();
  EXPECT_EQ(add(1, holes[0]), Result::More);
  EXPECT_EQ(add(1, holes[1]), Result::Bad);
  EXPECT_EQ(assembler.half_done(), 0u);
  // one sender cannot hold more than its share, all together not more than the bound
  for (uint32_t s = 0; s < 10; ++s) add(1, fragments(100 + s, "C", noise(9000, 1), 6000)[0]);
  EXPECT_EQ(assembler.half_done(), Assembler::kPerSender);
  for (uint64_t sender = 2; sender < 500; ++sender) add(sender, fragments(1, "C", noise(9000, 1), 6000)[0]);
  EXPECT_EQ(assembler.half_done(), Assembler::kInAll);
  EXPECT_EQ(assembler.abandoned(), 10 + 498 - static_cast<int64_t>(Assembler::kInAll));
  // the newest is still good
  EXPECT_EQ(add(499, fragments(1, "C", noise(9000, 1), 6000)[1]), Result::Whole);
}

// A few bytes at the far end of a large message: nothing is set aside for what lies before them.
TEST(UdpmAssembler, MemoryFollowsWhatArrivedNotWhatIsClaimed) {
  Assembler assembler(64 << 20);
  const uint8_t byte = 1;
  Packet packet;
  packet.fragment = true;
  packet.size = 64 << 20;
  packet.offset = packet.size - 1;
  packet.number = 1;
  packet.parts = 2;
  packet.data = {&byte, 1};
  for (uint64_t sender = 1; sender <= 3; ++sender)
    EXPECT_EQ(assembler.add(sender, packet), Assembler::Result::More);
  EXPECT_EQ(assembler.half_done(), 3u);
  EXPECT_EQ(assembler.held_bytes(), 3u);
}

TEST(UdpmAssembler, AllHalfDoneMessagesTogetherAreBounded) {
  static_assert(Assembler::kInAll == 64 && Assembler::kMaxBytes == 256 << 20);
  Assembler assembler(64 << 20);
  const Bytes part(20 << 20);
  Packet packet;
  packet.fragment = true;
  packet.size = 64 << 20;
  packet.parts = 4;
  packet.channel = "C";
  packet.data = part;
  for (uint64_t sender = 1; sender <= 16; ++sender) {
    assembler.add(sender, packet);
    ASSERT_LE(assembler.held_bytes(), Assembler::kMaxBytes + part.size()) << "looked at before each packet";
  }
  EXPECT_GE(assembler.held_bytes(), Assembler::kMaxBytes - part.size());
}

// Parts that overlap and leave a gap of the same size are not a message, although their bytes add up.
TEST(UdpmAssembler, OverlapAndGapThatAddUpAreRefused) {
  Assembler assembler(100);
  const Bytes half = noise(5, 1);
  Packet packet;
  packet.fragment = true;
  packet.size = 10;
  packet.parts = 2;
  packet.channel = "C";
  packet.data = half;
  EXPECT_EQ(assembler.add(1, packet), Assembler::Result::More);
  packet.number = 1;
  packet.offset = 4;
  EXPECT_EQ(assembler.add(1, packet), Assembler::Result::Bad);
  EXPECT_EQ(assembler.held_bytes(), 0u);
}

TEST(UdpmPacket, RandomBytesAreHandled) {
  std::mt19937 rng(11);
  Assembler assembler(1 << 16);
  int whole = 0;
  for (int round = 0; round < 100'000; ++round) {
    Bytes bytes = fragments(rng() % 4, "C", noise(1 + rng() % 200, 1), 1 + rng() % 100)[0];
    for (unsigned k = rng() % 4; k > 0; --k)
      bytes[4 + rng() % (bytes.size() - 4)] = static_cast<uint8_t>(rng() % 8);
    if (const auto p = parse_packet(bytes))
      whole += assembler.add(1 + rng() % 3, *p) == Assembler::Result::Whole;
  }
  EXPECT_GT(whole, 100);
  EXPECT_LE(assembler.half_done(), 3 * Assembler::kPerSender);
}

// Runs the classic BPF program as the kernel does: a load behind the end returns 0.
bool passes(const std::vector<sock_filter>& program, const Bytes& udp, uint32_t source_address) {
  uint32_t a = 0;
  for (size_t pc = 0;;) {
    const sock_filter& op = program.at(pc++);
    switch (op.code) {
      case BPF_LD | BPF_W | BPF_ABS:
      case BPF_LD | BPF_H | BPF_ABS:
      case BPF_LD | BPF_B | BPF_ABS: {
        if (op.k == static_cast<uint32_t>(SKF_NET_OFF) + 12) {
          a = source_address;
          break;
        }
        const size_t n = BPF_SIZE(op.code) == BPF_W ? 4 : BPF_SIZE(op.code) == BPF_H ? 2 : 1;
        if (op.k + n > udp.size()) return false;
        a = 0;
        for (size_t i = 0; i < n; ++i) a = a << 8 | udp[op.k + i];
        break;
      }
      case BPF_JMP | BPF_JEQ | BPF_K:
        pc += a == op.k ? op.jt : op.jf;
        break;
      case BPF_JMP | BPF_JA:
        pc += op.k;
        break;
      case BPF_RET | BPF_K:
        return op.k > 0;
      default:
        ADD_FAILURE() << "code " << op.code;
        return false;
    }
  }
}

TEST(UdpmFilter, PassesWhatIsWantedWhateverTheLengths) {
  std::mt19937 rng(9);
  for (int round = 0; round < 300; ++round) {
    // names over two letters, so that many are prefixes of each other
    const auto name = [&] {
      std::string s;
      for (unsigned n = 1 + rng() % 12; n > 0; --n) s += rng() % 5 ? 'A' : 'B';
      return s;
    };
    std::vector<std::string> wanted(1 + rng() % 6);
    for (std::string& w : wanted) w = name();
    const auto program = channel_filter(wanted, 0x0a000001, 5000);
    for (int k = 0; k < 50; ++k) {
      const std::string channel = rng() % 2 ? wanted[rng() % wanted.size()] : name();
      Bytes udp(8);
      udp[0] = 5001 >> 8;
      udp[1] = static_cast<uint8_t>(5001 & 0xff);
      const Bytes packet = short_packet(static_cast<uint32_t>(rng()), channel, Bytes(rng() % 3, 'A'));
      udp.insert(udp.end(), packet.begin(), packet.end());
      const bool expected = std::find(wanted.begin(), wanted.end(), channel) != wanted.end();
      ASSERT_EQ(passes(program, udp, 0x0a000001), expected) << channel;
      udp[1] = static_cast<uint8_t>(5000 & 0xff);  // our own port
      EXPECT_FALSE(passes(program, udp, 0x0a000001));
      EXPECT_EQ(passes(program, udp, 0x0a000002), expected);  // the same port on another host
    }
  }
}

TEST(UdpmFilter, FragmentsPassOtherMagicsDoNot) {
  const auto program = channel_filter({"WANTED"}, 1, 1);
  Bytes udp(8);
  const Bytes fragment = fragments(1, "OTHER", noise(100, 1), 50)[1];
  udp.insert(udp.end(), fragment.begin(), fragment.end());
  EXPECT_TRUE(passes(program, udp, 2));
  udp[11] = 0x31;
  EXPECT_FALSE(passes(program, udp, 2));
  EXPECT_FALSE(passes(program, Bytes(9), 2));
  EXPECT_THROW(channel_filter(std::vector<std::string>(1000, std::string(60, 'x')), 1, 1),
               std::invalid_argument);
}

// The kernel takes 4096 instructions. Twelve are for no name; a name of three letters is one word, compared and passed in
// three, one of five letters two words in five.
TEST(UdpmFilter, IsAsLongAsTheKernelTakes) {
  std::vector<std::string> names(1358, "abc");
  names.insert(names.end(), 2, "abcde");
  EXPECT_EQ(channel_filter(names, 1, 1).size(), static_cast<size_t>(BPF_MAXINSNS));
  names.push_back("abc");
  EXPECT_THROW(channel_filter(names, 1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace lab::udpm
