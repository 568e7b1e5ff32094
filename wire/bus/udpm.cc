#include "wire/bus/udpm.h"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <unordered_map>

#include "core/util/big_endian.h"
#include "wire/bus/bus_fault.h"
#include "wire/bus/udpm_filter.h"
#include "wire/bus/udpm_wire.h"

namespace lab {
namespace {

using namespace udpm;

constexpr int kBatch = 16;     // packets a system call
constexpr int64_t kSpin = 30;  // us to look for the next packet before the sleep
constexpr size_t kMaxSenders = 4096;
constexpr int32_t kRestarted = 1000;  // a sequence number so far back means a new process on an old port

int64_t now_us() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * 1'000'000 + t.tv_nsec / 1000;
}

timespec to_timespec(int64_t us) { return {us / 1'000'000, us % 1'000'000 * 1000}; }

struct Fd {
  int fd = -1;
  ~Fd() {
    if (fd >= 0) close(fd);
  }
};

class UdpmBus : public Bus {
 public:
  UdpmBus(const BusUrl& url, const BusOptions& options)
      : url_(url), options_(options), dice_(options.drop), assembler_(options.max_message) {
    read_url();
    open_send();
    open_receive();
    memory_.reset(new uint8_t[kBatch * kMaxPacket]);
    for (int i = 0; i < kBatch; ++i) {
      parts_[i] = {&memory_[i * kMaxPacket], kMaxPacket};
      packets_[i].msg_hdr = {};
      packets_[i].msg_hdr.msg_name = &from_[i];
      packets_[i].msg_hdr.msg_iov = &parts_[i];
      packets_[i].msg_hdr.msg_iovlen = 1;
    }
  }

  void publish(std::string_view channel, std::span<const uint8_t> data) override;
  int poll(int64_t timeout_us, const Handler& handler, int64_t batch_us) override;
  BusCounters counters() const override;
  std::string describe() const override;
  uint64_t own_address() const override { return self_; }
  int fd() const override { return receive_.fd; }

 private:
  struct Sender {
    bool known = false;
    uint32_t next = 0;  // sequence number expected
    int64_t unreported = 0;
    bool ignoring = false;  // fragments of a message that is not wanted
    uint32_t ignored = 0;
  };

  [[noreturn]] void fail(const std::string& what, const char* advice = "") const {
    const std::string reason = std::strerror(errno);
    throw BusError("bus '" + url_.text() + "': " + what + ": " + reason + advice);
  }
  void read_url();
  void open_send();
  void open_receive();
  bool send(iovec* parts, size_t n);
  bool wait(int64_t timeout_us, int64_t batch_us);
  int drain(const Handler& handler);
  int take(size_t i, const Handler& handler);
  void note_sequence(Sender& sender, uint32_t sequence);
  bool wanted(std::string_view channel) const;

  BusUrl url_;
  BusOptions options_;
  FaultDice dice_;
  Assembler assembler_;
  sockaddr_in group_{};
  uint8_t ttl_ = 0;
  int interface_ = 0;  // index of the one that the URL names; 0 = none
  Fd send_, receive_;
  uint64_t self_ = 0;
  int granted_ = 0;  // bytes of receive buffer
  uint32_t sequence_ = 0;
  std::string name_;
  BusCounters counters_;
  std::unordered_map<uint64_t, Sender> senders_;
  std::unique_ptr<uint8_t[]> memory_;
  sockaddr_in from_[kBatch];
  iovec parts_[kBatch];
  mmsghdr packets_[kBatch];
  size_t next_ = 0, filled_ = 0;  // packets received and not yet handed out
  bool drained_ = true;           // the last receive found less than a batch
};

constexpr const char* kNoRoute =
    "; LCM needs a multicast route, for one machine: ip link set lo multicast on; ip route add 224.0.0.0/4 "
    "dev lo";

int loopback() { return static_cast<int>(if_nametoindex("lo")); }

uint64_t key_of(const sockaddr_in& a) { return uint64_t{ntohl(a.sin_addr.s_addr)} << 16 | ntohs(a.sin_port); }

void UdpmBus::read_url() {
  const std::string network = url_.network.empty() ? "239.255.76.67:7667" : url_.network;
  const size_t colon = network.find(':');
  group_.sin_family = AF_INET;
  const auto refuse = [&](const std::string& why) { throw BusError("bus '" + url_.text() + "': " + why); };
  const auto number = [&](const std::string& what, std::string_view text, int low, int high) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < low || value > high) {
      refuse(what + " '" + std::string(text) + "' must be a number from " + std::to_string(low) + " to " +
             std::to_string(high));
    }
    return value;
  };
  if (inet_pton(AF_INET, network.substr(0, colon).c_str(), &group_.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(group_.sin_addr.s_addr))) {
    refuse("'" + network.substr(0, colon) + "' is not a multicast address such as 239.255.76.67");
  }
  const int port = colon == std::string::npos ? 7667 : number("port", network.substr(colon + 1), 1, 65535);
  group_.sin_port = htons(static_cast<uint16_t>(port));
  for (const auto& [key, value] : url_.options) {
    if (key == "ttl") {
      ttl_ = static_cast<uint8_t>(number("ttl", value, 0, 255));
    } else if (key == "recv_buf_size") {
      options_.recv_buf_size = number("recv_buf_size", value, 0, 1 << 30);
    } else if (key == "interface") {
      interface_ = static_cast<int>(if_nametoindex(value.c_str()));
      if (interface_ == 0) refuse("this host has no network interface '" + value + "'");
    } else {
      refuse("unknown option '" + key + "'; ttl, recv_buf_size, interface and backend exist");
    }
  }
}

void UdpmBus::open_send() {
  send_.fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (send_.fd < 0) fail("socket");
  if (setsockopt(send_.fd, IPPROTO_IP, IP_MULTICAST_TTL, &ttl_, sizeof ttl_) < 0) fail("IP_MULTICAST_TTL");
  // What stays on this host goes over lo, whatever happens to the other interfaces and routes.
  if (const int out = interface_ != 0 ? interface_ : ttl_ == 0 ? loopback() : 0; out != 0) {
    const ip_mreqn from{{}, {}, out};
    if (setsockopt(send_.fd, IPPROTO_IP, IP_MULTICAST_IF, &from, sizeof from) < 0) fail("IP_MULTICAST_IF");
  }
  const int size = 1 << 20;
  setsockopt(send_.fd, SOL_SOCKET, SO_SNDBUF, &size, sizeof size);  // asked of the kernel
  if (connect(send_.fd, reinterpret_cast<const sockaddr*>(&group_), sizeof group_) < 0)
    fail("connect", kNoRoute);
  sockaddr_in own{};
  socklen_t length = sizeof own;
  if (getsockname(send_.fd, reinterpret_cast<sockaddr*>(&own), &length) < 0) fail("getsockname");
  self_ = key_of(own);
}

void UdpmBus::open_receive() {
  receive_.fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (receive_.fd < 0) fail("socket");
  const int fd = receive_.fd;
  const int one = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
  setsockopt(fd, SOL_SOCKET, SO_REUSEPORT, &one, sizeof one);
  // root may go beyond net.core.rmem_max; for all others the kernel clamps silently, so read it back
  if (options_.recv_buf_size > 0 &&
      setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &options_.recv_buf_size, sizeof(int)) < 0) {
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &options_.recv_buf_size, sizeof(int));
  }
  socklen_t length = sizeof granted_;
  getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted_, &length);
  granted_ /= 2;  // the kernel doubles the value for its own needs
  if (!options_.channels.empty()) {
    // before bind, so that nothing unwanted is in the queue
    auto program =
        channel_filter(options_.channels, static_cast<uint32_t>(self_ >> 16), static_cast<uint16_t>(self_));
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    if (setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) < 0) fail("SO_ATTACH_FILTER");
  }
  // bound to the group's address: other groups on the same port stay out
  if (bind(fd, reinterpret_cast<const sockaddr*>(&group_), sizeof group_) < 0) fail("bind");
  const auto join = [&](int interface) {
    const ip_mreqn member{group_.sin_addr, {}, interface};
    return setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &member, sizeof member) == 0;
  };
  // on lo we hear our own kind, on the route's interface plain LCM programs of this host, and other hosts
  const bool here = loopback() != 0 && join(loopback());
  const bool there = join(interface_) || errno == EADDRINUSE;  // the route's interface may be lo itself
  if (interface_ != 0 || ttl_ != 0 ? !there : !(here || there)) fail("joining the group", kNoRoute);
}

bool UdpmBus::send(iovec* parts, size_t n) {
  msghdr message{};
  message.msg_iov = parts;
  message.msg_iovlen = n;
  for (int attempt = 0; attempt < 3; ++attempt) {
    if (sendmsg(send_.fd, &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0) return true;
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != ENOBUFS) return false;  // such as EPERM of a firewall
    pollfd p{send_.fd, POLLOUT, 0};
    const timespec limit = to_timespec(500);
    ppoll(&p, 1, &limit, nullptr);
  }
  return false;
}

void UdpmBus::publish(std::string_view channel, std::span<const uint8_t> data) {
  check_channel_name(channel);
  if (data.size() > options_.max_message) {
    throw std::invalid_argument("publish on " + std::string(channel) + ": " + std::to_string(data.size()) +
                                " bytes, at most " + std::to_string(options_.max_message) + " are allowed");
  }
  name_.assign(channel);
  const iovec name{name_.data(), name_.size() + 1};  // with its NUL
  auto* bytes = const_cast<uint8_t*>(data.data());
  uint8_t header[kFragmentHeader];
  store_big_endian(header + 4, sequence_++);
  bool ok = true;
  if (name.iov_len + data.size() <= kMaxShort) {
    store_big_endian(header, kShort);
    iovec parts[3] = {{header, kShortHeader}, name, {bytes, data.size()}};
    ok = send(parts, 3);
  } else {
    const size_t count = (name.iov_len + data.size() + kMaxFragment - 1) / kMaxFragment;
    store_big_endian(header, kFragment);
    store_big_endian(header + 8, static_cast<uint32_t>(data.size()));
    store_big_endian(header + 18, static_cast<uint16_t>(count));
    size_t offset = 0;
    for (size_t i = 0; i < count && ok; ++i) {
      store_big_endian(header + 12, static_cast<uint32_t>(offset));
      store_big_endian(header + 16, static_cast<uint16_t>(i));
      const size_t n = std::min(data.size() - offset, i == 0 ? kMaxFragment - name.iov_len : kMaxFragment);
      iovec parts[3] = {{header, kFragmentHeader}, name, {bytes + offset, n}};
      if (i > 0) parts[1] = parts[2];
      ok = send(parts, i == 0 ? 3 : 2);
      offset += n;
    }
  }
  ++(ok ? counters_.sent : counters_.send_failed);
}

// True when something is there to receive.
bool UdpmBus::wait(int64_t timeout_us, int64_t batch_us) {
  pollfd p{receive_.fd, POLLIN, 0};
  const timespec limit = to_timespec(timeout_us);
  if (ppoll(&p, 1, timeout_us < 0 ? nullptr : &limit, nullptr) <= 0) return false;
  if (batch_us > 0) {
    const timespec rest = to_timespec(batch_us);
    nanosleep(&rest, nullptr);
  }
  return true;
}

int UdpmBus::poll(int64_t timeout_us, const Handler& handler, int64_t batch_us) {
  // An answer that comes within microseconds is taken without a sleep: a sleep and a wake-up cost more than the answer.
  if (timeout_us == 0 || batch_us <= 0 || !drained_ || next_ < filled_) {
    const int64_t spin = batch_us != 0 ? 0 : timeout_us < 0 ? kSpin : std::min(kSpin, timeout_us);
    const int64_t begin = now_us();
    do {
      if (const int n = drain(handler); n > 0) return n;
    } while (now_us() - begin < spin);
    if (timeout_us == 0) return 0;
  }
  const int64_t deadline = timeout_us < 0 ? 0 : now_us() + timeout_us;
  for (int64_t left = timeout_us;;) {
    if (!wait(left, batch_us)) return 0;
    if (const int n = drain(handler); n > 0) return n;
    if (timeout_us < 0) continue;
    left = deadline - now_us();  // packets, but no wanted message
    if (left <= 0) return 0;
  }
}

int UdpmBus::drain(const Handler& handler) {
  int handled = 0;
  for (;;) {
    while (next_ < filled_) handled += take(next_++, handler);
    if (handled >= kMaxPerPoll) return handled;
    if (filled_ > 0 && drained_) {
      filled_ = next_ = 0;
      return handled;
    }
    for (int i = 0; i < kBatch; ++i) packets_[i].msg_hdr.msg_namelen = sizeof from_[i];
    const int n = recvmmsg(receive_.fd, packets_, kBatch, MSG_DONTWAIT, nullptr);
    next_ = 0;
    filled_ = n > 0 ? static_cast<size_t>(n) : 0;
    drained_ = n < kBatch;
    if (n <= 0) return handled;
  }
}

void UdpmBus::note_sequence(Sender& sender, uint32_t sequence) {
  const auto ahead = static_cast<int32_t>(sequence - sender.next);
  if (sender.known && ahead > 0) {
    sender.unreported += ahead;
    if (options_.channels.empty()) counters_.lost += ahead;
  }
  // a small step back: late, doubled, or another fragment of the same message
  if (!sender.known || ahead >= 0 || ahead < -kRestarted) sender.next = sequence + 1;
  sender.known = true;
}

bool UdpmBus::wanted(std::string_view channel) const {
  return options_.channels.empty() ||
         std::find(options_.channels.begin(), options_.channels.end(), channel) != options_.channels.end();
}

// Handles one packet; 1 when it completed a message for the handler.
int UdpmBus::take(size_t i, const Handler& handler) {
  if (dice_.drop()) {
    ++counters_.faulted;
    return 0;
  }
  const auto packet = parse_packet({&memory_[i * kMaxPacket], packets_[i].msg_len});
  if (!packet) {
    ++counters_.malformed;
    return 0;
  }
  const uint64_t key = key_of(from_[i]);
  if (!options_.channels.empty() && key == self_) return 0;
  if (senders_.size() >= kMaxSenders && !senders_.contains(key)) senders_.clear();
  Sender& sender = senders_[key];
  note_sequence(sender, packet->sequence);
  std::string_view channel = packet->channel;
  std::span<const uint8_t> data = packet->data;
  if (packet->fragment) {
    if (sender.ignoring && sender.ignored == packet->sequence) return 0;
    if (packet->number == 0 && !wanted(channel)) {
      sender.ignoring = true;
      sender.ignored = packet->sequence;
      return 0;
    }
    const auto result = assembler_.add(key, *packet);
    if (result == Assembler::Result::Bad) ++counters_.malformed;
    if (result != Assembler::Result::Whole) return 0;
    channel = assembler_.whole().channel;
    data = assembler_.whole().data;
  }
  if (!wanted(channel)) return 0;
  const int64_t lost_before = options_.channels.empty() ? sender.unreported : 0;
  sender.unreported = 0;
  ++counters_.received;
  handler({channel, data, key, lost_before});
  return 1;
}

BusCounters UdpmBus::counters() const {
  BusCounters c = counters_;
  c.lost += assembler_.abandoned();
  uint32_t info[SK_MEMINFO_VARS] = {};
  socklen_t length = sizeof info;
  // the kernel's count includes what the filter drops
  const bool known =
      options_.channels.empty() && getsockopt(receive_.fd, SOL_SOCKET, SO_MEMINFO, info, &length) == 0;
  c.overflow = known ? int64_t{info[SK_MEMINFO_DROPS]} : -1;
  return c;
}

std::string UdpmBus::describe() const {
  std::string s = "own endpoint " + url_.text() + ", receive buffer " + std::to_string(granted_) + " bytes";
  if (granted_ < options_.recv_buf_size) {
    s += " (asked for " + std::to_string(options_.recv_buf_size) + "; raise net.core.rmem_max)";
  }
  return s;
}

}  // namespace

std::unique_ptr<Bus> open_udpm(const BusUrl& url, const BusOptions& options) {
  return std::make_unique<UdpmBus>(url, options);
}

}  // namespace lab
