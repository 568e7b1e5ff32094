#include "procs/logger/log_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "core/util/console.h"
#include "wire/log/log_reader.h"
#include "wire/process/participant.h"
#include "wire/schema/codec.h"
#include "wire/schema/guard.h"

namespace lab::logger {
namespace {

constexpr uint64_t kTelemetryFlush = 4096;  // bytes

/// How much of a log of `run` is whole steps: everything before the first message of the last step in it, since only
/// what follows a step proves it whole.
struct Whole {
  uint64_t bytes = 0;
  int64_t events = 0;
};
std::optional<Whole> whole_steps(const std::string& path, int64_t run) {
  LogReader reader(path);
  Guard guard;
  Whole whole;
  int64_t events = 0, last_step = kBeforeStart;
  for (LogEvent event; reader.next(event); ++events) {
    const auto channel = channel_of(event.channel);
    if (!reader.skipped().empty()) break;
    if (!channel) return std::nullopt;
    const Verdict verdict = guard.check(*channel, event.data);
    if (!verdict || verdict.head.run != run) return std::nullopt;
    if (*channel != Channel::Check && verdict.head.step != last_step) {
      last_step = verdict.head.step;
      whole = {event.offset, events};
    }
  }
  if (last_step == kBeforeStart) return std::nullopt;
  return whole;
}

/// The telemetry of the process before this one goes on, whether it was killed or has ended; without one it begins.
std::unique_ptr<LogWriter> continued(const std::string& path) {
  if (std::filesystem::exists(path)) std::filesystem::rename(path, part_name(path));
  if (!std::filesystem::exists(part_name(path))) return std::make_unique<LogWriter>(path);
  LogReader reader(part_name(path));
  int64_t events = 0;
  for (LogEvent event; reader.next(event) && reader.skipped().empty();) ++events;
  return std::make_unique<LogWriter>(path, reader.position(), events);
}

/// RUN and TYPE, which say what all other messages mean.
bool begins_a_log(Channel channel) { return channel == Channel::Run || channel == Channel::Type; }

/// What was written so far becomes NAME.earlier.lcm; NAME.lcm begins anew. NAME.lcm itself is never there meanwhile: it
/// means that the run has ended.
void begin_next_piece(std::unique_ptr<LogWriter>& log, const std::string& path) {
  log = nullptr;
  const std::string earlier = std::filesystem::path(path).replace_extension("earlier.lcm");
  std::filesystem::rename(part_name(path), part_name(earlier));
  publish_file(earlier);
  log = std::make_unique<LogWriter>(path);
}

}  // namespace

LogFiles::LogFiles(const std::string& run_dir, uint64_t quota)
    : log_path_(run_dir + "/log.lcm"), telemetry_path_(run_dir + "/telemetry.lcm"), split_(quota / 2) {
  if (std::filesystem::exists(log_path_))
    throw std::runtime_error(fmt::format("{} is there already; give another --run-dir", log_path_));
  telemetry_ = continued(telemetry_path_);
}

LogFiles::~LogFiles() {
  try {
    telemetry_->finish();
  } catch (const std::exception& error) {
    say("lab-logger: {}", error.what());
  }
}

void LogFiles::open(int64_t run, LogKind kind,
                    const std::function<void(Channel, std::span<const uint8_t>)>& visit) {
  run_ = run;
  kind_ = kind;
  const std::string part = part_name(log_path_);
  const auto whole = std::filesystem::exists(part) ? whole_steps(part, run) : std::nullopt;
  if (!whole) {
    log_ = std::make_unique<LogWriter>(log_path_);
    return;
  }
  LogReader reader(part);
  LogEvent event;
  for (int64_t i = 0; i < whole->events && reader.next(event); ++i) {
    const auto channel = channel_of(event.channel);
    if (!channel) continue;  // whole_steps takes no file with such an event
    if (begins_a_log(*channel)) begin_.push_back({*channel, {event.data.begin(), event.data.end()}});
    utime_ = event.utime;
    if (*channel == Channel::Check)
      unchecked_.reset();
    else
      unchecked_.add(event.bytes, event.utime);
    visit(*channel, event.data);
  }
  log_ = std::make_unique<LogWriter>(log_path_, whole->bytes, whole->events);
}

void LogFiles::add_to_log(Channel channel, std::span<const uint8_t> bytes, int64_t utime) {
  utime_ = utime;
  unchecked_.add(log_->add(utime, row(channel).name, bytes), utime);
  if (unchecked_.count() >= kCheckEvery) add_check();
}

void LogFiles::add_check() {
  if (kind_.checks && unchecked_.count() > 0)
    log_->add(unchecked_.utime(), row(Channel::Check).name, encode(unchecked_.check(run_)));
  unchecked_.reset();
}

void LogFiles::append(Channel channel, std::span<const uint8_t> bytes, int64_t utime) {
  if (channel == Channel::End) {  // proves itself
    add_check();
    log_->add(utime, row(channel).name, bytes);
    return;
  }
  add_to_log(channel, bytes, utime);
  if (begins_a_log(channel)) begin_.push_back({channel, {bytes.begin(), bytes.end()}});
}

void LogFiles::flush() {
  log_->flush();
  if (split_ == 0 || !kind_.may_split || log_->bytes() < split_) return;
  add_check();
  log_->flush();
  begin_next_piece(log_, log_path_);
  for (const Begin& event : begin_) add_to_log(event.channel, event.bytes, utime_);
  log_->flush();
}

void LogFiles::close() {
  add_check();
  log_->finish();
}

void LogFiles::telemetry(Channel channel, std::span<const uint8_t> bytes) {
  telemetry_->add(wall_now(), row(channel).name, bytes);
  if (telemetry_->waiting() < kTelemetryFlush) return;
  telemetry_->flush();
  if (split_ != 0 && telemetry_->bytes() >= split_) begin_next_piece(telemetry_, telemetry_path_);
}

}  // namespace lab::logger
