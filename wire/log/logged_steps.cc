#include "wire/log/logged_steps.h"

#include <fmt/format.h>

#include <algorithm>

#include "wire/log/event_hash.h"

namespace lab {
namespace {

/// Not every step has a COMMAND. One that is missing is missed by the digest.
bool is_whole(const StepRecord& record) { return record.complete(!record.command.empty()); }

}  // namespace

void LockstepLoggedSteps::drop(const Step& step, const std::string& what) {
  findings_.add({step.offset, step.bytes, step.record.step, "", what});
}

void LockstepLoggedSteps::take(Channel channel, std::span<const uint8_t> message, const LogEvent& event) {
  const int64_t step = peek_step(message);
  const auto refuse = [&](const std::string& what) {
    findings_.add({event.offset, event.bytes.size(), step, std::string(event.channel), what});
  };
  if (step <= last_) return refuse(fmt::format("comes after step {}", last_));
  if (open_ && step < open_->record.step) {
    drop(*open_, fmt::format("step {} follows it", step));
    open_.reset();
  }
  if (open_ && step > open_->record.step) close();
  if (!open_) {
    open_ = Step{};
    open_->record.clear(step);
    open_->offset = event.offset;
  }
  open_->bytes = event.offset + event.bytes.size() - open_->offset;
  open_->times.push_back(event.utime);
  if (!open_->record.store(channel, message, false)) refuse("a second one of this step");
  if (channel == Channel::RobotState) prove(step - 1, peek_digest(message));
}

/// The simulator says what the digest of a step is.
void LockstepLoggedSteps::prove(int64_t step, int64_t digest) {
  if (!waiting_ || waiting_->record.step != step || digest == 0) return;
  if (waiting_->record.digest() == digest) return visit_proven();
  drop(*waiting_, "its bytes do not have the digest that the simulator published");
  waiting_.reset();
}

void LockstepLoggedSteps::visit_proven() {
  if (!waiting_) return;
  waiting_->record.in_order([&](Channel channel, const Bytes& bytes) { visit_(channel, bytes); });
  waiting_.reset();
}

/// No more messages of this step are to come.
void LockstepLoggedSteps::close() {
  visit_proven();  // nothing contradicts the one before
  if (!open_) return;
  const StepRecord& record = open_->record;
  if (!is_whole(record)) {
    drop(*open_, "is not whole: a message of it is missing");
  } else {
    const int64_t utime = peek_utime(record.state);
    if (std::any_of(open_->times.begin(), open_->times.end(), [&](int64_t time) { return time != utime; }))
      findings_.add(
          {open_->offset, open_->bytes, record.step, "", "an event has another time than the step"});
    last_ = record.step;
    waiting_ = std::move(open_);
  }
  open_.reset();
}

void LockstepLoggedSteps::end(int64_t step, int64_t digest, const LogEvent& event) {
  close();
  if (digest != 0 && last_ != step)
    findings_.add({event.offset, event.bytes.size(), step, "END",
                   fmt::format("the last step is {}, and the last whole one here {}", step, last_)});
  prove(step, digest);
  visit_proven();
}

void LockstepLoggedSteps::cut() {
  if (open_ && !is_whole(open_->record)) open_.reset();  // the file ends within it
  close();
  visit_proven();
}

void RealtimeLoggedSteps::take(Channel channel, std::span<const uint8_t> message, const LogEvent& event) {
  held_.push_back(
      {channel, peek_step(message), event.offset, event.bytes.size(), Bytes(message.begin(), message.end())});
  if (held_.size() >= 2 * kCheckEvery) visit_plausible(false);  // no CHECK comes
}

void RealtimeLoggedSteps::checked(bool as_written) {
  for (const Message& message : held_) {
    if (!as_written) break;  // any of them may be the one
    if (message.channel == Channel::RobotState) last_state_ = std::max(last_state_, message.step);
    visit_(message.channel, message.bytes);
  }
  held_.clear();
}

void RealtimeLoggedSteps::end(int64_t, int64_t, const LogEvent&) { visit_plausible(true); }

/// By message of held_: a state whose step rises from the one before and to those after. At the end of a log there is
/// none after the last: it must not be much further from the one before than others were.
std::vector<bool> RealtimeLoggedSteps::plausible_states(bool at_end) const {
  std::vector<bool> good(held_.size());
  int64_t later = INT64_MAX;
  for (size_t i = held_.size(); i-- > 0;) {
    const Message& message = held_[i];
    if (message.channel != Channel::RobotState || message.step <= last_state_) continue;
    good[i] = message.step < later;
    later = std::min(later, message.step);
  }
  int64_t before = last_state_, widest = kWindow, last_gap = 0;
  size_t last = held_.size();
  for (size_t i = 0; i < held_.size(); ++i) {
    if (!good[i]) continue;
    widest = std::max(widest, last_gap);
    last_gap = held_[i].step - before;
    before = held_[i].step;
    last = i;
  }
  if (at_end && last < held_.size() && last_gap / 4 > widest) good[last] = false;
  return good;
}

/// The rest of held_ waits for the state after it.
void RealtimeLoggedSteps::visit_plausible(bool at_end) {
  const std::vector<bool> good = plausible_states(at_end);
  const auto last_state = std::find_if(held_.rbegin(), held_.rend(), [](const Message& message) {
    return message.channel == Channel::RobotState;
  });
  const auto before_it = static_cast<size_t>(held_.rend() - last_state) - (last_state != held_.rend());
  const size_t count = at_end || before_it == 0 ? held_.size() : before_it;
  int64_t newest = last_state_, gap = 0;
  for (size_t i = 0; i < count; ++i) {
    if (!good[i]) continue;
    gap = std::max(gap, held_[i].step - newest);
    newest = held_[i].step;
  }
  const int64_t limit = newest + std::min(gap, INT64_MAX / 4) + kWindow;
  for (size_t i = 0; i < count; ++i) {
    const Message& message = held_[i];
    const bool is_state = message.channel == Channel::RobotState;
    if (is_state ? good[i] : message.step >= 0 && message.step <= limit) {
      visit_(message.channel, message.bytes);
      continue;
    }
    findings_.add({message.offset, message.size, message.step, std::string(row(message.channel).name),
                   "its step does not fit between those around it"});
  }
  last_state_ = newest;
  held_.erase(held_.begin(), held_.begin() + static_cast<ptrdiff_t>(count));
}

}  // namespace lab
