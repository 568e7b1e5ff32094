#include "wire/process/participant.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <lab/ack_t.hpp>
#include <lab/event_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <sstream>

#include "core/util/console.h"
#include "core/util/interrupt.h"
#include "wire/process/launch_record.h"
#include "wire/protocol/lateness.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

constexpr Micros kEarly =
    50;  // us before a tick that the process wakes up and spins: a sleep may end that much late

Micros clock_now(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return t.tv_sec * 1'000'000 + t.tv_nsec / 1'000;
}

std::vector<std::string> names_of(const std::vector<Channel>& channels, const std::string& prefix) {
  std::vector<std::string> names;
  for (Channel channel : channels) names.push_back(wire_name(channel, prefix));
  return names;
}

/// PROCESS is always among them: it tells which address is whose.
BusOptions bus_options(const ParticipantOptions& options) {
  BusOptions bus;
  std::vector<Channel> channels = options.channels;
  if (!channels.empty() && std::find(channels.begin(), channels.end(), Channel::Process) == channels.end())
    channels.push_back(Channel::Process);
  bus.channels = names_of(channels, options.prefix);
  bus.max_message = kLargestMessage;
  return bus;
}

/// The names of env LAB_GUESTS, which the supervisor sets.
std::vector<std::string> guests() {
  std::vector<std::string> names;
  const char* text = std::getenv("LAB_GUESTS");
  std::istringstream words(text ? text : "");
  for (std::string name; std::getline(words, name, ',');) names.push_back(name);
  return names;
}

/// The run's folder, where the supervisor keeps its record; empty for a process that was started by hand.
std::string run_dir() {
  const char* text = launch_nonce() != 0 ? std::getenv("LAB_RUN_DIR") : nullptr;
  return text ? text : "";
}

/// The process that a message of a channel with Publisher::Named comes from.
std::string named_publisher(Channel channel, std::span<const uint8_t> bytes) {
  switch (channel) {
    case Channel::Event:
      return decode<event_t>(bytes).process;
    case Channel::Ack:
      return decode<ack_t>(bytes).process;
    case Channel::Need:
      return decode<need_t>(bytes).sender;
    default:
      return {};
  }
}

/// True for a message that would be well formed if its numbers were finite.
bool only_not_finite(Channel channel, std::span<const uint8_t> bytes) {
  const Schema& schema = lab_schema();
  const Type& type = *schema.find(row(channel).type);
  return !schema.check(type, bytes).empty() && schema.check(type, bytes, {.finite = false}).empty();
}

}  // namespace

Micros monotonic_now() { return clock_now(CLOCK_MONOTONIC); }
Micros wall_now() { return clock_now(CLOCK_REALTIME); }

/// In a process namespace under the host's /proc, the pid that the host sees.
int host_pid() {
  static const int pid = [] {
    char text[32] = {};
    const ssize_t n = readlink("/proc/self", text, sizeof text - 1);
    const int seen = n > 0 ? std::atoi(text) : 0;
    return seen > 0 ? seen : getpid();
  }();
  return pid;
}

/// Asks the kernel for what real time needs; prints what is refused.
void go_realtime(const std::string& name, int urgency) {
  prctl(PR_SET_TIMERSLACK, 1UL);
  const sched_param wanted{.sched_priority = 40 + urgency};
  std::string missing;
  if (sched_setscheduler(0, SCHED_FIFO, &wanted) < 0) missing = "SCHED_FIFO";
  if (mlockall(MCL_CURRENT | MCL_FUTURE) < 0) missing += missing.empty() ? "mlockall" : " and mlockall";
  if (!missing.empty())
    say("lab-{}: not permitted to use {}: ticks come later under load (see scripts/lab doctor)", name,
        missing);
}

Micros time_to_sleep(const Role& role, Micros next_process, Micros now) {
  const Micros wake = role.lateness() ? role.wake() - kEarly : role.wake();
  return std::clamp<Micros>(std::min(wake, next_process) - now, 0, kRepeat);
}

int64_t launch_nonce() {
  const char* text = std::getenv("LAB_LAUNCH");
  return text ? std::strtoll(text, nullptr, 10) : 0;
}

Participant::Participant(ParticipantOptions options)
    : options_(std::move(options)),
      bus_(open_bus(options_.url, bus_options(options_))),
      incoming_(options_.prefix),
      outgoing_(options_.prefix),
      publishers_(options_.name, launch_nonce(), guests(),
                  [record = LaunchRecord(run_dir())](const std::string& name, uint64_t address) {
                    return record.check(name, address);
                  }),
      nonce_(launch_nonce()),
      loops_(256, 0.f) {
  for (const ChannelRow& channel : kChannelTable)
    wire_names_.push_back(wire_name(channel.id, options_.prefix));
  publishers_.set_own_address(bus_->own_address());
  install_signal_handlers();
}

Publish Participant::publish() {
  return [this](Channel channel, std::span<const uint8_t> bytes) {
    if (const Verdict verdict = outgoing_.check(channel, bytes); !verdict)
      throw PublishRefused(verdict.reason);
    bus_->publish(wire_names_[static_cast<size_t>(channel)], bytes);
  };
}

void Participant::note_stranger(Channel channel, const std::string& reason, Role& role) {
  ++foreign_;
  last_rejected_ = fmt::format("{}: {}", row(channel).name, reason);
  const Micros now = monotonic_now();
  role.stranger(channel, reason, now);
  // before the first step, a process of our own may speak before the supervisor has recorded it
  if (role.step() < 0 || now < next_complaint_) return;
  next_complaint_ = now + 1'000'000;
  say("lab-{}: ignored {}", options_.name, last_rejected_);
}

/// Another lab's PROCESS, which has passed the guard's schema.
void Participant::note_neighbour(const Datagram& datagram, Role& role) {
  const auto process = decode<process_t>(datagram.data);
  if (process.name == kSimulator && process.state != "STOPPING" && process.state != "FAULT")
    role.neighbour(monotonic_now());
}

/// Whether the message comes from the process that alone may publish it. It has passed the guard.
bool Participant::is_attributed(Channel channel, const Datagram& datagram, Role& role) {
  const Micros now = monotonic_now();
  std::string why;
  if (channel == Channel::Process) {
    const auto process = decode<process_t>(datagram.data);
    why = publishers_.process(process.name, process.nonce, datagram.sender, now);
    if (!why.empty()) note_neighbour(datagram, role);
  } else if (channel == Channel::Need && peek_step(datagram.data) == kBeforeStart) {
    // RUN is given to anybody
  } else if (row(channel).publisher == Publisher::Named) {
    why = publishers_.message(channel, named_publisher(channel, datagram.data), datagram.sender, now);
  }
  if (!why.empty()) note_stranger(channel, why, role);
  return why.empty();
}

/// Once the role knows its run, both guards compare messages with it.
void Participant::bind(const Role& role) {
  if (role.run() == incoming_.run()) return;
  incoming_.set_run(role.run());
  incoming_.set_sizes(role.nq(), role.nv());
  outgoing_.set_sizes(role.nq(), role.nv());
}

void Participant::receive(Role& role, const Datagram& datagram) {
  const auto channel = channel_of(datagram.channel, options_.prefix);
  if (!channel || row(*channel).publisher == Publisher::Nobody) return;
  const bool wanted =
      options_.channels.empty() ||
      std::find(options_.channels.begin(), options_.channels.end(), *channel) != options_.channels.end();
  if (!wanted && *channel != Channel::Process) return;
  // whose message it is comes before what is in it: a stranger's malformed COMMAND is not the controller's fault
  if (const std::string_view owner = Publishers::owner_of(*channel); !owner.empty()) {
    const std::string why = publishers_.message(*channel, owner, datagram.sender, monotonic_now());
    if (!why.empty()) return note_stranger(*channel, why, role);
  }
  const Verdict verdict = incoming_.check(*channel, datagram.data);
  switch (verdict.kind) {
    case Verdict::Foreign:
      ++foreign_;
      if (*channel == Channel::Process) note_neighbour(datagram, role);
      return;
    case Verdict::Refused:
      ++rejected_;
      last_rejected_ = verdict.reason;
      role.refused({*channel, datagram.data.size() >= 32 ? peek_step(datagram.data) : -1,
                    only_not_finite(*channel, datagram.data), verdict.reason},
                   monotonic_now());
      return;
    case Verdict::Accepted:
      break;
  }
  if (!is_attributed(*channel, datagram, role) || !wanted) return;
  const int64_t newest = std::max(newest_state_, options_.name == kSimulator ? role.step() : -1);
  if (row(*channel).near_state && newest >= 0 && verdict.head.step > newest + kWindow) {
    ++rejected_;
    last_rejected_ =
        fmt::format("{}: step {}, ROBOT_STATE is at {}", row(*channel).name, verdict.head.step, newest);
    return;
  }
  if (*channel == Channel::RobotState) newest_state_ = std::max(newest_state_, verdict.head.step);
  ++received_;
  role.receive(*channel, datagram.data, monotonic_now());
  bind(role);
}

int Participant::run(Role& role) {
  std::string published_state;
  Micros next_process = 0;
  bool stopping = false, urgent = false;
  const auto finish = [&](int exit_code, const std::string& reason) {
    if (!reason.empty()) say("lab-{}: {}", options_.name, reason);
    return exit_code;
  };
  try {
    bind(role);
    publish_process(role, role.state());  // before any other message of ours: it tells the others our address
    while (!role.outcome().ended) {
      const Micros before = monotonic_now();
      const Micros wait = time_to_sleep(role, next_process, before);
      Micros woken = 0;
      bus_->poll(
          wait,
          [&](const Datagram& datagram) {
            if (!woken) woken = monotonic_now();
            receive(role, datagram);
          },
          role.batch());
      if (interrupted && !stopping) {
        stopping = true;
        role.stop(monotonic_now());
      }
      const Micros now = monotonic_now();
      role.tick(now);
      if (role.urgency() > 0 && !urgent) {
        urgent = true;
        go_realtime(options_.name, role.urgency());
      }
      if (woken) note_loop(now - woken);
      if (now >= next_process || role.state() != published_state) {
        published_state = role.state();
        next_process = now + kRepeat;
        publish_process(role, published_state);
      }
    }
    publish_process(role, role.outcome().exit_code == kOk ? "STOPPING" : "FAULT");
  } catch (const PublishRefused& refused) {
    publish_process(role, "FAULT");
    return finish(kSafety, fmt::format("refused to send: {}", refused.what()));
  }
  return finish(role.outcome().exit_code, role.outcome().reason);
}

void Participant::note_loop(Micros us) {
  loops_[next_loop_++ % loops_.size()] = static_cast<float>(us);
  ++loop_counts_[static_cast<size_t>(loop_bin(us))];
}

void Participant::publish_process(Role& role, const std::string& state) {
  const BusCounters bus = bus_->counters();
  process_t process{};
  process.utime = wall_now();
  process.run = role.run();
  process.step = role.step();
  process.name = options_.name;
  process.pid = host_pid();
  process.state = state;
  process.nonce = nonce_;
  process.model_hash = role.model_hash();
  process.received = received_;
  process.lost = bus.lost;
  process.late = role.late();
  process.rejected = rejected_;
  process.foreign = foreign_;
  process.malformed = bus.malformed;
  process.overflow = bus.overflow;
  process.last_rejected = last_rejected_;
  std::vector<float> loops(loops_.begin(),
                           loops_.begin() + static_cast<std::ptrdiff_t>(std::min(next_loop_, loops_.size())));
  if (!loops.empty()) {
    std::sort(loops.begin(), loops.end());
    process.loop_p50 = loops[loops.size() / 2];
    process.loop_p99 = loops[loops.size() * 99 / 100];
    process.loop_max = loops.back();
  }
  const auto last = std::find_if(loop_counts_.rbegin(), loop_counts_.rend(), [](int64_t n) { return n > 0; });
  process.loops.assign(loop_counts_.begin(), last.base());
  process.nloops = static_cast<int32_t>(process.loops.size());
  if (const Lateness* late = role.lateness()) {
    process.overruns = role.overruns();
    process.lateness_p50 = static_cast<float>(late->quantile(0.5));
    process.lateness_p99 = static_cast<float>(late->quantile(0.99));
    process.lateness_max = static_cast<float>(late->longest());
  }
  publish()(Channel::Process, encode(process));
}

}  // namespace lab
