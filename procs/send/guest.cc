#include "procs/send/guest.h"

#include <fmt/format.h>

#include <algorithm>
#include <lab/need_t.hpp>
#include <lab/run_t.hpp>

#include "procs/send/send.h"
#include "wire/process/participant.h"
#include "wire/schema/codec.h"

namespace lab::send {

volatile sig_atomic_t interrupted = 0;

Guest::Guest(const Options& options)
    : options_(options),
      guard_(options.prefix),
      until_(monotonic_now() + static_cast<Micros>(options.timeout * 1e6)),
      record_(options.run_dir) {
  BusOptions bus;
  std::vector<Channel> channels{Channel::Reply, Channel::Run, Channel::Reference};
  if (options.follow)
    channels.insert(channels.end(), {Channel::RobotState, Channel::Input, Channel::Event, Channel::End});
  for (Channel channel : channels) bus.channels.push_back(wire_name(channel, options.prefix));
  bus_ = open_bus(options.url, bus);
  if (!options.run.empty()) bind(static_cast<int64_t>(std::stoull(options.run, nullptr, 16)));
}

bool Guest::ask(Channel channel, const Bytes& message, const Take& take, Micros longest) {
  const Micros until = std::min(until_, monotonic_now() + longest);
  bool accepted = false;
  Micros next = 0;
  while (!accepted && !interrupted) {
    const Micros now = monotonic_now();
    if (now >= until) return false;
    if (now >= next) {
      next = now + kRepeat;
      bus_->publish(wire_name(channel, options_.prefix), message);
    }
    poll(std::min(next, until) - now, take, accepted);
  }
  return accepted;
}

bool Guest::poll(Micros span, const Take& take, bool& accepted) {
  bool heard = false;
  bus_->poll(
      span,
      [&](const Datagram& datagram) {
        const auto received = channel_of(datagram.channel, options_.prefix);
        if (accepted || !received || !guard_.check(*received, datagram.data) ||
            !is_of_the_lab(*received, datagram.sender))
          return;
        heard = true;
        accepted = take(*received, datagram.data);
      },
      kNoSpin);
  return heard;
}

bool Guest::listen(const Take& take, Micros silence, Micros until) {
  bool accepted = false;
  Micros heard = monotonic_now();
  for (Micros now = heard; !accepted && !interrupted && now < std::min(heard + silence, until);
       now = monotonic_now())
    if (poll(std::min({heard + silence, until, now + kRepeat}) - now, take, accepted)) heard = now;
  return accepted;
}

Bytes Guest::ask_for_run() const {
  need_t need{};
  need.run = run_;
  need.step = kBeforeStart;
  need.process = kSimulator;
  need.sender = "lab-send";
  return encode(need);
}

bool Guest::bind_to_run() {
  if (run_ != 0) return true;
  std::set<int64_t> runs;
  const auto take = [&](Channel channel, std::span<const uint8_t> bytes) {
    if (channel == Channel::Run) runs.insert(decode<run_t>(bytes).run);
    return !runs.empty();
  };
  if (!ask(Channel::Need, ask_for_run(), take)) return false;
  // where no record tells the lab's simulator from others, they have a moment to answer too
  if (options_.run_dir.empty()) {
    const auto several = [&](auto... received) { return take(received...) && runs.size() > 1; };
    ask(Channel::Need, ask_for_run(), several, kOthersAnswerIn);
  }
  if (runs.size() > 1) {
    std::string all;
    for (const int64_t run : runs) all += fmt::format(" {:016x}", static_cast<uint64_t>(run));
    throw UsageError("several labs are on this bus: say which with --run:" + all);
  }
  bind(*runs.begin());
  return true;
}

/// Whether the supervisor of the lab that is meant started the sender. True where there is no record to ask. Who was known
/// once stays known: after its answer to `reset` a simulator has ended before its record can be read again.
bool Guest::is_of_the_lab(Channel channel, uint64_t sender) {
  const bool may_be_planner = channel == Channel::Reference || channel == Channel::Event;
  if (simulators_.contains(sender) || (may_be_planner && planners_.contains(sender))) return true;
  if (record_.check(kSimulator, sender) != Claim::Stranger) return simulators_.insert(sender).second;
  return may_be_planner && record_.check(kPlanner, sender) != Claim::Stranger &&
         planners_.insert(sender).second;
}

}  // namespace lab::send
