#include "wire/log/checked_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <lab/end_t.hpp>
#include <lab/run_t.hpp>
#include <memory>

#include "wire/log/event_hash.h"
#include "wire/log/log_writer.h"
#include "wire/schema/codec.h"
#include "wire/schema/earlier_types.h"
#include "wire/schema/guard.h"

namespace lab {
namespace {

class CheckedLog {
 public:
  CheckedLog(const std::string& path, const VisitLogged& visit) : reader_(path), visit_(visit) {}

  LogFindings read() {
    for (LogEvent event; reader_.next(event);) {
      note_gaps();
      take(event);
    }
    note_gaps();
    if (reader_.tail() > 0 && found_.has_end)  // without END it was cut off, which is noted
      found_.add({reader_.position(), reader_.tail(), -1, "", "bytes at the end that are no whole event"});
    if (steps_ && !found_.has_end) steps_->cut();
    return std::move(found_);
  }

 private:
  void note(const LogEvent& event, int64_t step, std::string what) {
    const std::string name(event.channel);
    const bool known = channel_of(name).has_value();
    found_.add({event.offset, event.bytes.size(), step, known ? name : "", std::move(what)});
  }

  void note_gaps() {
    for (; gaps_ < reader_.skipped().size(); ++gaps_) {
      const LogReader::Gap& gap = reader_.skipped()[gaps_];
      found_.add({gap.offset, gap.bytes, -1, "", "bytes that are no event"});
    }
  }

  void take(const LogEvent& event) {
    if (event.number != next_number_)
      note(event, -1, fmt::format("event {} stands where {} belongs", event.number, next_number_));
    next_number_ = static_cast<int64_t>(static_cast<uint64_t>(event.number) + 1);
    const auto channel = channel_of(event.channel);
    if (found_.has_end) return note(event, -1, "comes after END");
    if (channel != Channel::Check) unchecked_.add(event.bytes, event.utime);
    if (!channel) return note(event, -1, "is no channel of the lab");
    if (row(*channel).log_file != LogFile::Log) return;  // a recorder of everything was here
    const std::span<const uint8_t> message = earlier_.as_now(*channel, event.data, converted_);
    const Verdict verdict = guard_.check(*channel, message);
    if (verdict.kind == Verdict::Foreign) return note(event, -1, "is of another run");
    if (!verdict) return note(event, -1, verdict.reason);
    if (found_.run == 0 && *channel != Channel::Run) return note(event, -1, "comes before RUN");
    dispatch(*channel, message, event);
  }

  void dispatch(Channel channel, std::span<const uint8_t> message, const LogEvent& event) {
    const bool of_a_step = channel != Channel::Run && channel != Channel::Type && channel != Channel::End &&
                           channel != Channel::Check;
    if (of_a_step) return steps_->take(channel, message, event);
    if (channel == Channel::Run && found_.run == 0) begin(message);
    const bool proven_by_check = realtime_ && (channel == Channel::Run || channel == Channel::Type);
    if (!proven_by_check && event.utime != peek_utime(message))
      note(event, -1, "its event and its message have different times");
    if (channel == Channel::Check) return take_check(decode<check_t>(message), event);
    if (channel == Channel::End) return take_end(message, event);
    if (channel == Channel::Run && !std::equal(message.begin(), message.end(), run_.begin(), run_.end()))
      return note(event, -1, "is another RUN of the same run");
    beginning_.add(channel, event.data);
    if (channel == Channel::Type) earlier_.add(decode<type_t>(message));
    has_types_ |= channel == Channel::Type;
    visit_(channel, message);
  }

  void begin(std::span<const uint8_t> message) {
    const auto run = decode<run_t>(message);
    run_.assign(message.begin(), message.end());
    found_.run = run.run;
    guard_.set_run(run.run);
    guard_.set_sizes(run.nq, run.nv);
    realtime_ = run.experiment.find("\n  clock: realtime\n") != std::string::npos;
    if (realtime_)
      steps_ = std::make_unique<RealtimeLoggedSteps>(visit_, found_);
    else
      steps_ = std::make_unique<LockstepLoggedSteps>(visit_, found_);
  }

  void take_check(const check_t& check, const LogEvent& event) {
    const check_t wanted = unchecked_.check(check.run);
    const bool as_written =
        check.count == wanted.count && check.hash == wanted.hash && check.step == wanted.step;
    if (!as_written)
      note(
          event, -1,
          fmt::format("the {} events before it are not the {} that were written", wanted.count, check.count));
    steps_->checked(as_written);
    unchecked_.reset();
  }

  void take_end(std::span<const uint8_t> message, const LogEvent& event) {
    const auto end = decode<end_t>(message);
    Bytes unsealed(message.begin(), message.end());
    std::fill(unsealed.end() - sizeof end.check, unsealed.end(), 0);
    beginning_.add(Channel::End, unsealed);
    found_.checksums = end.check != 0;
    const bool of_this_version = is_of_type<end_t>(event.data);
    if (end.check != 0 && end.check != beginning_.value())
      note(event, -1, "RUN, a TYPE or END is not what was written");
    if (end.check == 0 && of_this_version && has_types_) note(event, -1, "has no check");
    steps_->end(end.step, end.digest, event);
    found_.has_end = true;
    visit_(Channel::End, message);
  }

  LogReader reader_;
  const VisitLogged& visit_;
  LogFindings found_;
  Guard guard_;
  EarlierTypes earlier_;
  Bytes converted_, run_;
  std::unique_ptr<LoggedSteps> steps_;  ///< null until RUN
  LogHash beginning_;                   ///< RUN and TYPE
  EventHash unchecked_;
  size_t gaps_ = 0;
  int64_t next_number_ = 0;
  bool realtime_ = false, has_types_ = false;
};

}  // namespace

LogFindings read_checked(const std::string& path, const VisitLogged& visit) {
  return CheckedLog(path, visit).read();
}

bool is_being_written(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int fd = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool locked = ::flock(fd, LOCK_SH | LOCK_NB) < 0;
  ::close(fd);
  return locked;
}

std::string find_log(const std::string& source) {
  if (!std::filesystem::is_directory(source)) return source;
  std::string log = source + "/log.lcm";
  if (!std::filesystem::exists(log) && std::filesystem::exists(part_name(log))) return part_name(log);
  return log;
}

}  // namespace lab
