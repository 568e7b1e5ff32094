// lab-spy: shows the messages on a bus, decoded at run time.
#include <fmt/format.h>
#include <fnmatch.h>

#include <cmath>
#include <lab/process_t.hpp>
#include <lab/type_t.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/util/command_line.h"
#include "core/util/console.h"
#include "core/util/interrupt.h"
#include "core/util/json_text.h"
#include "core/util/printable.h"
#include "lab/run/shell.h"
#include "procs/spy/periods.h"
#include "procs/spy/types.h"
#include "wire/bus/bus.h"
#include "wire/process/participant.h"
#include "wire/schema/codec.h"

namespace lab::spy {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string url, prefix, channel;
  std::vector<std::string> types, fields;
  double seconds = 0, timeout = 0;  ///< s; 0 = not given
  int64_t count = 0;
  bool as_json = false, once = false;
};

/// Calls `handle` for every message for that long (us; negative = until interrupted), or until it returns false.
void listen(Bus& bus, Micros span, const std::function<bool(const Datagram&)>& handle) {
  const Micros until = monotonic_now() + span;
  for (bool go = true; go && !interrupted;) {
    const Micros left = span < 0 ? kRepeat : until - monotonic_now();
    if (left <= 0) return;
    bus.poll(
        std::min(left, kRepeat), [&](const Datagram& datagram) { go = go && handle(datagram); }, kNoSpin);
  }
}

/// Waits for the first message that `handle` counts, at most --timeout if it is given; then listens for --for, or `usual` s.
/// Returns 124 when nothing came in time.
int listen_for(Bus& bus, const Options& options, double usual,
               const std::function<bool(const Datagram&)>& counts) {
  const double span = options.seconds > 0 ? options.seconds : usual;
  bool heard = false;
  const auto note = [&](const Datagram& datagram) { heard |= counts(datagram); };
  if (options.timeout > 0)
    listen(bus, std::llround(options.timeout * 1e6), [&](const Datagram& datagram) {
      note(datagram);
      return !heard;
    });
  if (options.timeout > 0 && !heard && !interrupted)
    return refuse("lab-spy", fmt::format("nothing came in {:g} s", options.timeout), 124);
  listen(bus, std::llround(span * 1e6), [&](const Datagram& datagram) {
    note(datagram);
    return true;
  });
  return interrupted ? 128 + interrupted : kOk;
}

void learn_from(Types& types, const Datagram& datagram) {
  const Type* type = types.of(datagram.channel, datagram.data);
  if (type && type->name == "lab.type_t" && types.schema().check(*type, datagram.data).empty())
    types.learn(decode<type_t>(datagram.data).source);
}

Types known_types(const Options& options) {
  return {options.types, [](const std::string& why) { complain("lab-spy", "warning: " + why); }};
}

// ---- list and hz --------------------------------------------------------------------------------------------

struct Seen {
  std::string type;
  std::vector<Micros> times;
  int64_t bytes = 0, lost = 0;
  std::set<uint64_t> senders;
};

int list(const Options& options) {
  const auto bus = open_bus(options.url);
  Types types = known_types(options);
  std::map<std::string, Seen> channels;
  const Micros began = monotonic_now();
  const int code = listen_for(*bus, options, 1, [&](const Datagram& datagram) {
    learn_from(types, datagram);
    if (!options.channel.empty() &&
        fnmatch(options.channel.c_str(), std::string(datagram.channel).c_str(), 0) != 0)
      return false;
    Seen& seen = channels[std::string(datagram.channel)];
    seen.type = types.name_of(datagram.channel, datagram.data);
    seen.times.push_back(monotonic_now());
    seen.bytes += static_cast<int64_t>(datagram.data.size());
    seen.lost += datagram.lost_before;
    seen.senders.insert(datagram.sender);
    return true;
  });
  if (code == 124) return code;
  const double span = static_cast<double>(monotonic_now() - began) * 1e-6;
  ordered_json all = ordered_json::array();
  if (!options.as_json)
    emit("{:<24} {:<22} {:>8} {:>9} {:>10} {:>10} {:>10} {:>7} {:>5}\n", "channel", "type", "count", "hz",
         "bytes/s", "min ms", "max ms", "senders", "lost");
  for (const auto& [name, seen] : channels) {
    const auto [least, most, hz] = periods(seen.times, span);
    const double rate = static_cast<double>(seen.bytes) / span;
    if (options.as_json)
      all.push_back({{"channel", name},
                     {"type", seen.type},
                     {"count", seen.times.size()},
                     {"hz", hz},
                     {"bytes_per_s", rate},
                     {"period_min_ms", static_cast<double>(least) * 1e-3},
                     {"period_max_ms", static_cast<double>(most) * 1e-3},
                     {"senders", seen.senders.size()},
                     {"lost", seen.lost}});
    else
      emit("{:<24} {:<22} {:>8} {:>9.1f} {:>10.0f} {:>10.3f} {:>10.3f} {:>7} {:>5}\n", printable_name(name),
           printable_name(seen.type), seen.times.size(), hz, rate, static_cast<double>(least) * 1e-3,
           static_cast<double>(most) * 1e-3, seen.senders.size(), seen.lost);
  }
  if (options.as_json) emit("{}\n", json_text(all, 2));
  return code;
}

// ---- echo ---------------------------------------------------------------------------------------------------

std::string head_of(std::span<const uint8_t> bytes) {
  std::string hex;
  for (size_t i = 0; i < std::min<size_t>(bytes.size(), 24); ++i) hex += fmt::format("{:02x}", bytes[i]);
  return hex + (bytes.size() > 24 ? ".." : "");
}

struct NoField : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void show(const Options& options, const Types& types, const Datagram& datagram) {
  const Type* type = types.of(datagram.channel, datagram.data);
  const std::string name = types.name_of(datagram.channel, datagram.data);
  const std::string fault = type
                                ? types.schema().check(*type, datagram.data, {.finite = false, .text = false})
                                : "unknown type " + name;
  if (!type || !fault.empty()) {
    if (options.as_json)
      emit("{}\n", json_text(ordered_json{{"channel", datagram.channel},
                                          {"size", datagram.data.size()},
                                          {"error", fault},
                                          {"head", head_of(datagram.data)}}));
    else
      emit("{} ({} bytes): {}: {}\n", printable_name(datagram.channel), datagram.data.size(), fault,
           head_of(datagram.data));
    return;
  }
  const Value value = types.schema().decode(*type, datagram.data);
  if (!options.fields.empty()) {
    std::string line;
    ordered_json found;
    for (const std::string& field : options.fields) {
      const Value* part = value.at(field);
      if (!part)
        throw NoField(fmt::format("{} has no '{}'; it has {}", name, field, [&] {
          std::string names;
          for (const Field& f : type->fields) names += (names.empty() ? "" : " ") + f.name;
          return names;
        }()));
      found[field] = to_json(*part);
      line += (line.empty() ? "" : " ") + json_text(to_json(*part));
    }
    emit("{}\n", options.as_json ? json_text(found) : line);
  } else if (options.as_json) {
    emit("{}\n", json_text(ordered_json{{"channel", datagram.channel},
                                        {"type", name},
                                        {"size", datagram.data.size()},
                                        {"utime_wall", wall_now()},
                                        {"message", to_json(value)}}));
  } else {
    emit("{} ({}, {} bytes)\n{}\n", printable_name(datagram.channel), printable_name(name),
         datagram.data.size(), to_text(value));
  }
}

int echo(const Options& options) {
  const auto bus = open_bus(options.url);
  Types types = known_types(options);
  const int64_t most = options.once ? 1 : options.count;
  int64_t shown = 0;
  const auto show_next = [&](const Datagram& datagram) {
    learn_from(types, datagram);
    if (fnmatch(options.channel.c_str(), std::string(datagram.channel).c_str(), 0) != 0) return true;
    show(options, types, datagram);
    flush_output();
    return ++shown != most;
  };
  // both bound the whole time; only --for makes an end without enough messages a good one
  const double span = options.seconds > 0 && options.timeout > 0 ? std::min(options.seconds, options.timeout)
                                                                 : std::max(options.seconds, options.timeout);
  listen(*bus, span > 0 ? std::llround(span * 1e6) : -1, show_next);
  if (interrupted) return 128 + interrupted;
  const bool too_few = most > 0 ? shown < most : shown == 0 && options.seconds <= 0;
  if (too_few)
    return refuse(
        "lab-spy",
        fmt::format("{} on {} in {:g} s", shown == 0 ? "nothing" : "not enough", options.channel, span), 124);
  return kOk;
}

// ---- who ----------------------------------------------------------------------------------------------------

int who(const Options& options) {
  BusOptions only;
  only.channels = {wire_name(Channel::Process, options.prefix)};
  const auto bus = open_bus(options.url, only);
  Guard guard;
  struct Life {
    process_t first, last;
  };
  std::map<std::pair<std::string, int32_t>, Life> lives;
  const int code = listen_for(*bus, options, 1, [&](const Datagram& datagram) {
    if (datagram.channel != only.channels[0] || !guard.check(Channel::Process, datagram.data)) return false;
    const auto process = decode<process_t>(datagram.data);
    const auto [life, is_new] = lives.try_emplace({process.name, process.pid}, Life{process, process});
    life->second.last = process;
    return true;
  });
  if (code == 124) return code;
  ordered_json all = ordered_json::array();
  if (!options.as_json)
    emit("{:<12} {:<9} {:>8} {:>10} {:>9} {:>8} {:>8} {:>8} {:>9} {:>8}\n", "name", "state", "pid", "step",
         "steps/s", "p50 us", "p99 us", "max us", "overruns", "dropped");
  for (const auto& [key, life] : lives) {
    const process_t &a = life.first, &z = life.last;
    const double span = static_cast<double>(z.utime - a.utime) * 1e-6;
    const double rate = span > 0 ? static_cast<double>(z.step - a.step) / span : 0;
    const bool ticks = z.lateness_max > 0;
    const float p50 = ticks ? z.lateness_p50 : z.loop_p50, p99 = ticks ? z.lateness_p99 : z.loop_p99,
                most = ticks ? z.lateness_max : z.loop_max;
    if (options.as_json)
      all.push_back({{"name", z.name},
                     {"state", z.state},
                     {"pid", z.pid},
                     {"step", z.step},
                     {"rate", rate},
                     {"p50_us", p50},
                     {"p99_us", p99},
                     {"max_us", most},
                     {"overruns", z.overruns},
                     {"lost", z.lost},
                     {"late", z.late},
                     {"rejected", z.rejected},
                     {"foreign", z.foreign},
                     {"malformed", z.malformed},
                     {"overflow", z.overflow},
                     {"last_rejected", z.last_rejected},
                     {"run", fmt::format("{:016x}", static_cast<uint64_t>(z.run))},
                     {"model_hash", fmt::format("{:016x}", static_cast<uint64_t>(z.model_hash))}});
    else
      emit("{:<12} {:<9} {:>8} {:>10} {:>9.0f} {:>8.0f} {:>8.0f} {:>8.0f} {:>9} {:>8}\n",
           printable_name(z.name), printable_name(z.state), z.pid, z.step, rate, p50, p99, most, z.overruns,
           z.rejected + z.foreign + z.malformed + std::max<int64_t>(z.overflow, 0));
  }
  if (options.as_json) emit("{}\n", json_text(all, 2));
  return code;
}

int run(int argc, char** argv) {
  CommandLine line("lab-spy", "Shows what is said on an LCM bus, decoded at run time.");
  line.options_behind_verbs();
  line.footer(
      "Without a verb: list. Types: the lab's own, those of --types, and those that TYPE messages "
      "bring.\nexample: lab-spy echo "
      "ROBOT_STATE --once");
  Options options;
  line.option("-l,--url", options.url, "LCM URL (default: env LCM_DEFAULT_URL)");
  line.option("--prefix", options.prefix, "of a lab's channel names: CHANNEL and who are meant with it")
      .env("LAB_PREFIX");
  line.option("--types", options.types,
              "a .lcm file, or a folder with some; may be repeated. What cannot be used is a warning")
      .one_word();
  line.flag("--json", options.as_json, "print JSON");
  line.option("--for", options.seconds, "s to listen, then end (default: 1; echo: until interrupted)")
      .positive();
  line.option("--timeout", options.timeout, "give up with 124 when nothing has come after so many s")
      .positive();
  line.verb("list", "Lists the channels: type, count, rate, bytes, periods, senders, losses.")
      .footer("example: lab-spy list --for 2");
  CommandLine hz = line.verb("hz", "The same for some channels.");
  hz.option("channel", options.channel, "name or pattern such as 'ROBOT_*'");
  hz.footer("example: lab-spy hz COMMAND");
  CommandLine echoes = line.verb("echo", "Prints messages.");
  echoes.option("channel", options.channel, "name or pattern such as 'ROBOT_*'").required();
  echoes.flag("--once", options.once, "one message, then end");
  echoes.option("-n", options.count, "so many messages, then end").positive();
  echoes.option("--field", options.fields, "only this value, such as q[0]; may be repeated").one_word();
  echoes.footer("example: lab-spy echo ROBOT_STATE --field q[0] -n 10");
  line.verb("who", "Lists the processes that are alive, by their PROCESS messages.")
      .footer("example: lab-spy who --for 0.3");
  if (const auto code = line.parse(argc, argv)) return *code;
  if (!options.channel.empty() && !options.channel.starts_with(options.prefix))
    options.channel = options.prefix + options.channel;
  install_signal_handlers();
  return guarded_main("lab-spy", [&] {
    try {
      if (line.chosen() == "echo") return echo(options);
      if (line.chosen() == "who") return who(options);
      return list(options);
    } catch (const NoField& error) {
      return refuse("lab-spy", error.what(), kUsage);
    }
  });
}

}  // namespace
}  // namespace lab::spy

int main(int argc, char** argv) {
  return lab::run_program("lab-spy", [&] { return lab::spy::run(argc, argv); });
}
