#include "wire/protocol/realtime_follower.h"

#include "wire/protocol/convert.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab {

std::string RealtimeFollower::state() const {
  if (next_ == 0) return "READY";
  return unanswered_ ? "HOLDING" : "RUNNING";
}

void RealtimeFollower::start(const ReadLog&, Micros now) {
  retry_timer_.reset(now);
  context_.request(kBeforeStart);  // with RUN come the INPUTs so far
}

void RealtimeFollower::receive(Channel channel, std::span<const uint8_t> bytes, Micros) {
  switch (channel) {
    case Channel::RobotState:
      context_.idle_timer.reset();
      if (const int64_t step = peek_step(bytes); step < next_)
        ++late_;
      else if (newest_.empty() || step > peek_step(newest_))
        newest_.assign(bytes.begin(), bytes.end());
      break;
    case Channel::Input:
      context_.idle_timer.reset();
      inputs_.add(bytes);
      break;
    default:
      receive_other(channel, bytes);
  }
}

void RealtimeFollower::tick(Micros now) {
  if (newest_.empty()) {
    if (now - answered_at_ > step_utime(setup().timeout, setup().dt)) unanswered_ = true;
    return;
  }
  decode(newest_, state_);
  // an INPUT that does not come although it was asked for so often has been replaced by a later one
  if (!inputs_.complete_to(state_.input_seq) && asked_ < kAsks) {
    if (!retry_timer_.expired(now)) return;
    ++asked_;
    context_.request(kBeforeStart);
    return;
  }
  asked_ = 0;
  newest_.clear();
  unanswered_ = !answer(state_, inputs_.take_to(state_.input_seq));
  next_ = state_.step + 1;
  answered_at_ = now;
  retry_timer_.reset(now);
}

}  // namespace lab
