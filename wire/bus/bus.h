// The bus: publish and poll, nothing else. Two back ends: our own single-threaded endpoint that speaks LCM's UDPM wire
// format (udpm://), and liblcm for every other URL and on request. Both pass the same conformance tests. One bus belongs
// to one thread.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lab {

/// One message as it arrives. The views are valid until the handler returns.
struct Datagram {
  std::string_view channel;
  std::span<const uint8_t> data;
  uint64_t sender =
      0;  ///< address and port of the sending socket in one number; 0 = the back end cannot tell
  int64_t lost_before =
      0;  ///< messages of that sender that were lost just before this one (see BusCounters::lost)
};
using Handler = std::function<void(const Datagram&)>;

struct BusCounters {
  int64_t received = 0;  ///< messages handed to handlers
  int64_t sent = 0;      ///< messages published whole
  int64_t lost = 0;  ///< gaps in the senders' sequence numbers, and messages of which a fragment never came.
                     ///< Gaps are seen only without a channel list: what the filter drops leaves gaps too
  int64_t overflow =
      0;  ///< packets the kernel dropped on a full receive buffer; -1 = not known (with a channel list)
  int64_t malformed = 0;    ///< packets that are not LCM's, or whose sizes are inconsistent
  int64_t send_failed = 0;  ///< messages the kernel did not take (firewall, full queue)
  int64_t faulted = 0;      ///< packets that the fault hook dropped
};

/// Drops incoming packets (own endpoint) or messages (liblcm) with this probability: tests only.
struct FaultHook {
  double probability = 0;  ///< 0..1
  uint64_t seed = 0;
};

struct BusOptions {
  /// Wire names wanted; empty = all. On the own endpoint the kernel then drops everything else, and what this
  /// bus itself sent, so that the process is not woken for it. With liblcm, which cannot tell senders
  /// apart, a process receives its own messages.
  std::vector<std::string> channels;
  int recv_buf_size = 8 << 20;      ///< bytes asked of the kernel; the URL's recv_buf_size has precedence
  uint32_t max_message = 64 << 20;  ///< larger messages are refused, also as a claim in a fragment's header
  FaultHook drop;                   ///< env LAB_FAULT_DROP=percent,seed when probability is 0
};

inline constexpr int kMaxPerPoll = 1024;  ///< messages, bounds the time of one poll

class Bus {
 public:
  virtual ~Bus() = default;
  /// Sends one message. Never waits longer than a millisecond; what the kernel does not take is counted.
  /// Throws std::invalid_argument for a channel name that is empty or longer than kMaxChannelName bytes.
  virtual void publish(std::string_view channel, std::span<const uint8_t> data) = 0;
  /// Hands every message that waits to the handler, about kMaxPerPoll at most; waits up to timeout_us for the
  /// first (0 = does not wait, negative = for ever). Returns how many. A signal ends the wait early with 0.
  /// The handler may publish and may throw; after a throw the rest of the messages comes with the next poll.
  /// batch_us > 0: after its wake-up the process sleeps that much longer before it reads, so that it is woken less
  /// often. 0: it first spins for about 30 us, within which the answer arrives in lockstep. -1: it sleeps at once.
  virtual int poll(int64_t timeout_us, const Handler& handler, int64_t batch_us = 0) = 0;
  virtual BusCounters counters() const = 0;
  /// One line of text: back end, address, receive buffer asked and granted.
  virtual std::string describe() const = 0;
  /// The address that others see as Datagram::sender; 0 = the back end does not tell.
  virtual uint64_t own_address() const { return 0; }
  /// Readable when messages wait: for a ppoll of the caller's own.
  virtual int fd() const = 0;
};

struct BusError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A bus URL in parts: provider://network?key=value&..
struct BusUrl {
  std::string provider, network;
  std::vector<std::pair<std::string, std::string>> options;
  std::string text() const;
};
BusUrl parse_url(const std::string& url);

/// The URL that is used if none is given: env LCM_DEFAULT_URL, or udpm://239.255.76.67:7667?ttl=0.
std::string default_url();

/// Opens a bus; throws BusError with the URL, what failed and what to do. `?backend=liblcm` in a udpm URL, or
/// env LAB_BUS=liblcm, picks liblcm.
std::unique_ptr<Bus> open_bus(const std::string& url = "", const BusOptions& options = {});

}  // namespace lab
