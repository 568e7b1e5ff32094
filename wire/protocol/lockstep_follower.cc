#include "wire/protocol/lockstep_follower.h"

#include <algorithm>
#include <lab/need_t.hpp>

#include "wire/schema/codec.h"

namespace lab {

LockstepFollower::LockstepFollower(FollowerContext& context)
    : FollowerRun(context), stored_(std::max(setup().lead, setup().every) + 2) {}

std::string LockstepFollower::state() const {
  if (catching_up_) return "STARTING";
  return next_ == 0 ? "READY" : "RUNNING";
}

void LockstepFollower::start(const ReadLog& read_log, Micros now) {
  retry_timer_.reset(now);
  catching_up_ = static_cast<bool>(read_log);
  begin();
  if (!catching_up_) return;
  read_log(context_.run, [&](Channel channel, std::span<const uint8_t> logged) {
    if (channel == Channel::RobotState || channel == Channel::Reference || channel == Channel::Input)
      receive(channel, logged, now);
  });
  catching_up_ = false;
  for (const Stored& stored : stored_)
    if (stored.answer.step >= 0) context_.publish_answer(stored.answer);
}

void LockstepFollower::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  switch (channel) {
    case Channel::RobotState:
    case Channel::Reference:
    case Channel::Input:
      context_.idle_timer.reset();
      file(channel, bytes, now);
      handle_while_possible(now);
      break;
    case Channel::Need:
      if (const auto need = decode<need_t>(bytes); need.process == context_.name && need.step >= 0)
        resend(need.step, now);
      break;
    default:
      break;
  }
}

void LockstepFollower::file(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  if (channel == Channel::Input) return inputs_.add(bytes);
  const int64_t step = peek_step(bytes);
  if (step < next_ || step >= next_ + ring_.size()) {
    if (step < next_) ++late_;
    return;
  }
  ring_.at(step).store(channel, bytes, false);
  if (channel == Channel::RobotState && step > next_ && gap_at_ != next_) {
    gap_at_ = next_;
    retry_timer_.trigger(now);
  }
}

void LockstepFollower::handle_while_possible(Micros now) {
  while (!context_.outcome.ended) {
    const StepRecord* record = ring_.find(next_);
    if (!record || record->state.empty() || !can_handle(*record)) return;
    decode(record->state, state_);
    if (!inputs_.complete_to(state_.input_seq)) return;
    const std::vector<Action> actions = inputs_.take_to(state_.input_seq);
    ++next_;
    handle(state_, *record, actions);
    retry_timer_.reset(now);
  }
}

void LockstepFollower::publish_answer(Answer answer) {
  Stored& stored = stored_[answer.step % stored_.size()];
  stored = {std::move(answer), 0};
  if (!catching_up_) context_.publish_answer(stored.answer);
}

void LockstepFollower::resend(int64_t step, Micros now) {
  Stored& stored = stored_[step % stored_.size()];
  if (stored.answer.step != step || now - stored.resent < kFirstWait / 2) return;
  stored.resent = now;
  context_.publish_answer(stored.answer);
}

void LockstepFollower::tick(Micros now) {
  if (retry_timer_.expired(now)) context_.request(next_);
}

}  // namespace lab
