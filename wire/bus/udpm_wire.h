// LCM's UDPM wire format, as liblcm 1.3.1 speaks it; big endian.
// Short: magic LC02, sequence number, channel, NUL, data. Fragment: magic LC03, sequence number, size of the data, offset
// of this part, number of this part, number of parts; then, in part 0 only, channel and NUL; then the part. The sequence
// number counts the sender's messages.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lab::udpm {

inline constexpr uint32_t kShort = 0x4c433032;
inline constexpr uint32_t kFragment = 0x4c433033;
inline constexpr size_t kShortHeader = 8;
inline constexpr size_t kFragmentHeader = 20;
inline constexpr size_t kMaxShort = 65499;     ///< channel, NUL and data of a short message
inline constexpr size_t kMaxFragment = 65487;  ///< channel, NUL and data of one fragment
inline constexpr size_t kMaxPacket = 65536;

/// One received packet in parts.
struct Packet {
  bool fragment = false;
  uint32_t sequence = 0;
  std::string_view channel;  ///< short messages and part 0
  std::span<const uint8_t> data;
  uint32_t size = 0, offset = 0;  ///< fragments: of the whole message; of this part
  uint16_t number = 0, parts = 1;
};

/// Nothing when the bytes are not a packet of this format or its sizes are inconsistent.
std::optional<Packet> parse_packet(std::span<const uint8_t> bytes);

/// A message put together from its fragments. Memory and time follow what has arrived, never what a header claims.
struct Assembly {
  struct Part {
    uint32_t offset = 0;  ///< in the message
    uint32_t at = 0;      ///< in `data`
    uint32_t size = 0;
  };
  uint64_t sender = 0;
  uint32_t sequence = 0;
  uint32_t size = 0;  ///< bytes of the whole message
  uint16_t parts = 0;
  std::string channel;        ///< known once part 0 is here
  std::vector<uint8_t> data;  ///< of the parts, as they arrived
  std::vector<Part> arrived;
  std::vector<bool> seen;  ///< per part
  uint64_t age = 0;
};

/// Half-done messages, bounded in number per sender, in all, and in bytes: the oldest is dropped first.
/// Parts may come in any order and twice.
class Assembler {
 public:
  explicit Assembler(uint32_t max_message) : max_message_(max_message) {}

  static constexpr size_t kPerSender = 2;
  static constexpr size_t kInAll = 64;
  static constexpr uint64_t kMaxBytes = 256 << 20;

  enum class Result { More, Whole, Bad };
  /// Adds one fragment. Whole: the message is in whole() until the next call. Bad: it contradicts itself or
  /// the fragments before it, or is too large.
  Result add(uint64_t sender, const Packet& packet);
  const Assembly& whole() const { return whole_; }
  int64_t abandoned() const { return abandoned_; }  ///< messages given up unfinished
  size_t half_done() const { return half_done_.size(); }
  uint64_t held_bytes() const { return bytes_; }  ///< of half-done messages

 private:
  Assembly& open(uint64_t sender, const Packet& packet);
  void close(size_t index);
  void give_up_oldest(std::optional<uint64_t> sender);
  uint32_t max_message_;
  std::vector<Assembly> half_done_;
  Assembly whole_;
  uint64_t bytes_ = 0, clock_ = 0;
  int64_t abandoned_ = 0;
};

}  // namespace lab::udpm
