#include "wire/bus/liblcm_bus.h"

#include <lcm/lcm.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <exception>
#include <utility>

#include "wire/bus/bus_fault.h"

namespace lab {
namespace {

// A channel name as a regular expression that matches only it.
std::string literal(const std::string& name) {
  std::string out;
  for (char c : name) {
    if (std::string_view("\\^$.|?*+()[]{}").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

class LiblcmBus : public Bus {
 public:
  LiblcmBus(const BusUrl& url, const BusOptions& options) : options_(options), dice_(options.drop) {
    BusUrl full = url;
    const auto is_size = [](const auto& option) { return option.first == "recv_buf_size"; };
    if (url.provider == "udpm" && std::none_of(url.options.begin(), url.options.end(), is_size)) {
      full.options.emplace_back("recv_buf_size", std::to_string(options.recv_buf_size));
    }
    url_ = full.text();
    lcm_ = lcm_create(url_.c_str());
    if (!lcm_) throw BusError("bus '" + url_ + "': liblcm cannot open it (its own message is on stderr)");
    if (options.channels.empty()) subscribe(".*");
    for (const std::string& name : options.channels) subscribe(literal(name));
  }

  ~LiblcmBus() override { lcm_destroy(lcm_); }

  void publish(std::string_view channel, std::span<const uint8_t> data) override {
    check_channel_name(channel);
    name_.assign(channel);
    if (lcm_publish(lcm_, name_.c_str(), data.data(), static_cast<unsigned>(data.size())) == 0) {
      ++counters_.sent;
    } else {
      ++counters_.send_failed;
    }
  }

  int poll(int64_t timeout_us, const Handler& handler, int64_t batch_us) override {
    if (timeout_us != 0) {
      pollfd p{fd(), POLLIN, 0};
      const timespec limit{timeout_us / 1'000'000, timeout_us % 1'000'000 * 1000};
      if (ppoll(&p, 1, timeout_us < 0 ? nullptr : &limit, nullptr) <= 0) return 0;
      if (batch_us > 0) {
        const timespec rest{batch_us / 1'000'000, batch_us % 1'000'000 * 1000};
        nanosleep(&rest, nullptr);
      }
    }
    handler_ = &handler;
    handled_ = 0;
    for (int i = 0; i < kMaxPerPoll && !thrown_ && lcm_handle_timeout(lcm_, 0) > 0; ++i) {
    }
    handler_ = nullptr;
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    return handled_;
  }

  BusCounters counters() const override { return counters_; }
  std::string describe() const override { return "liblcm " + url_; }
  int fd() const override { return lcm_get_fileno(lcm_); }

 private:
  void subscribe(const std::string& pattern) {
    lcm_subscription_t* s = lcm_subscribe(lcm_, pattern.c_str(), &LiblcmBus::receive, this);
    if (!s) throw BusError("bus '" + url_ + "': liblcm cannot subscribe (its own message is on stderr)");
    // liblcm would keep the oldest 30 and silently drop the rest
    lcm_subscription_set_queue_capacity(s, 0);
  }

  // Called through liblcm's C frames, which an exception must not cross.
  static void receive(const lcm_recv_buf_t* message, const char* channel, void* user) {
    auto& self = *static_cast<LiblcmBus*>(user);
    if (message->data_size > self.options_.max_message) {
      ++self.counters_.malformed;
      return;
    }
    if (self.dice_.drop()) {
      ++self.counters_.faulted;
      return;
    }
    ++self.counters_.received;
    ++self.handled_;
    try {
      (*self.handler_)({channel, {static_cast<const uint8_t*>(message->data), message->data_size}, 0, 0});
    } catch (...) {
      self.thrown_ = std::current_exception();
    }
  }

  BusOptions options_;
  FaultDice dice_;
  std::string url_;
  lcm_t* lcm_ = nullptr;
  std::string name_;
  BusCounters counters_;
  const Handler* handler_ = nullptr;
  int handled_ = 0;
  std::exception_ptr thrown_;
};

}  // namespace

std::unique_ptr<Bus> open_liblcm(const BusUrl& url, const BusOptions& options) {
  return std::make_unique<LiblcmBus>(url, options);
}

}  // namespace lab
