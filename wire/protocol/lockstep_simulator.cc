#include "wire/protocol/lockstep_simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <lab/need_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {

LockstepSimulatorRole::LockstepSimulatorRole(SimulatorConfig config, SimulateStep simulate, Publish publish)
    : SimulatorRole(std::move(config), std::move(simulate), std::move(publish)) {
  for (const auto& name : config_.listeners) acks_[name] = kBeforeStart;
}

// ---- received messages --------------------------------------------------------------------------------------

void LockstepSimulatorRole::on_message(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  if (channel != Channel::Reference && channel != Channel::Command && channel != Channel::Event) return;
  file(channel, bytes);
  take_due_steps(now);
}

void LockstepSimulatorRole::on_ack(const std::string& process, int64_t complete_to) {
  int64_t& known = acks_[process];
  if (complete_to > known && complete_to <= published_) {
    known = complete_to;
    idle_timer_.reset();
  }
}

/// Keeps an answer; later ones for the same step are ignored.
void LockstepSimulatorRole::file(Channel channel, std::span<const uint8_t> bytes) {
  const int64_t step = peek_step(bytes);
  const bool ahead = step > std::max<int64_t>(published_, kBeforeStart) + std::max<int64_t>(config_.lead, 0);
  if (step < 0 || step < published_ || ahead || phase_ == Phase::Ending) {
    if (step >= 0 && step < published_) ++late_;
    return;
  }
  if (channel == Channel::Command && !command_due(step)) return;
  ring_.at(step).store(channel, bytes, false);
}

void LockstepSimulatorRole::refused(const Refusal& refusal, Micros now) {
  if (refusal.channel != Channel::Command && refusal.channel != Channel::Reference) return;
  last_refusal_ = refusal.reason;
  if (phase_ != Phase::Running || refusal.step < published_) return;
  const char* process = refusal.channel == Channel::Command ? kController : kPlanner;
  fail(refusal.non_finite ? kSafety : kTransport,
       fmt::format("{}'s message for step {} was refused: {}", process, refusal.step, refusal.reason), now);
}

void LockstepSimulatorRole::on_need(int64_t step, Micros now) {
  if (step == kBeforeStart) return publish_run_again(now);
  if (step < 0 || step > published_ + kWindow) return;
  Micros& last = resent_[step];
  if (last != 0 && now - last < kFirstWait / 2) return;
  last = now;
  resent_.erase(resent_.begin(), resent_.lower_bound(std::max<int64_t>(published_ - ring_.size(), 0)));
  if (const StepRecord* record = ring_.find(step)) resend(*record);
  if (!end_.empty() && step >= last_step_) publish_(Channel::End, end_);
}

/// Extras first, then the main message, process by process.
void LockstepSimulatorRole::resend(const StepRecord& record) {
  for (const auto& [seq, bytes] : record.inputs) publish_(Channel::Input, bytes);
  for (const auto& [key, bytes] : record.events) publish_(Channel::Event, bytes);
  if (!record.state.empty()) publish_(Channel::RobotState, record.state);
  if (!record.reference.empty()) publish_(Channel::Reference, record.reference);
  if (!record.command.empty()) publish_(Channel::Command, record.command);
}

// ---- steps --------------------------------------------------------------------------------------------------

void LockstepSimulatorRole::begin(Micros now) {
  if (publish_state(0, now)) take_due_steps(now);
}

bool LockstepSimulatorRole::answered(int64_t step) {
  const StepRecord* record = ring_.find(step);
  return record && record->complete(command_due(step));
}

bool LockstepSimulatorRole::has_credit(int64_t step) const {
  return std::all_of(acks_.begin(), acks_.end(),
                     [&](const auto& ack) { return ack.second >= step - kWindow; });
}

void LockstepSimulatorRole::take_due_steps(Micros now) {
  while (phase_ == Phase::Running && published_ >= 0 && answered(published_)) {
    if (published_ >= last_step_) return end(false, "", now);
    if (paused_ && single_steps_ == 0) return;
    if (!has_credit(published_ + 1)) return;
    if (paused_) --single_steps_;
    if (!publish_state(published_ + 1, now)) return;
  }
}

/// Integrates to `step` and publishes it, extras first. Returns false if the run ended instead.
bool LockstepSimulatorRole::publish_state(int64_t step, Micros now) {
  robot_state_t message{};
  Command command;
  const Command* fresh = nullptr;
  if (step > 0) {
    StepRecord& before = *ring_.find(step - 1);
    before.trim();
    message.digest = before.digest();
    if (command_due(step - 1)) {
      decode(before.command, command_);
      command = to_signal(command_);
      fresh = &command;
    }
  }
  const StepResult result = simulate_(step, fresh, actions_);
  if (!result.abort.empty()) {
    fail(kSafety, fmt::format("step {}: {}", step, result.abort), now);
    return false;
  }

  StepRecord& record = ring_.at(step);
  message.command_step = step > 0 ? (step - 1) / config_.every * config_.every : -1;
  compose(result, step, message, [&](Channel channel, const Bytes& bytes) {
    record.store(channel, bytes, true);
    publish_(channel, bytes);
  });
  asked_ = 0;
  retry_timer_.reset(now);
  return true;
}

void LockstepSimulatorRole::tick(Micros now) {
  SimulatorRole::tick(now);
  if (phase_ != Phase::Running) return;
  if (paused_ && answered(published_)) idle_timer_.reset();
  if (retry_timer_.expired(now)) ask_for_answers();
  if (idle_timer_.elapsed() > config_.deadline)
    fail(kTransport,
         fmt::format("{} in {:g} s{}", missing_answer(), config_.deadline * 1e-6,
                     last_refusal_.empty() ? "" : "; last refused: " + last_refusal_),
         now);
}

void LockstepSimulatorRole::ask_for_answers() {
  const StepRecord* record = ring_.find(published_);
  const auto ask = [&](const char* process) {
    need_t need{};
    need.utime = utime(published_);
    need.run = config_.run_id;
    need.step = published_;
    need.process = process;
    need.sender = kSimulator;
    publish_(Channel::Need, encode(need));
  };
  const bool reference = record->closed_by(kPlanner);
  const bool command = !command_due(published_) || record->closed_by(kController);
  if (reference && command) return;
  if (!reference) ask(kPlanner);
  if (!command) ask(kController);
  if (++asked_ % 3 == 0) resend(*record);
}

/// What the run waits for, in words.
std::string LockstepSimulatorRole::missing_answer() {
  const StepRecord* record = ring_.find(published_);
  if (!record->closed_by(kPlanner))
    return fmt::format("{} gave no REFERENCE for step {}", kPlanner, published_);
  if (command_due(published_) && !record->closed_by(kController))
    return fmt::format("{} gave no COMMAND for step {}", kController, published_);
  for (const auto& [name, ack] : acks_)
    if (ack < published_ + 1 - kWindow) return fmt::format("{} wrote nothing after step {}", name, ack);
  return fmt::format("nothing went on after step {}", published_);
}

std::span<const uint8_t> LockstepSimulatorRole::newest_reference() {
  for (int64_t step = published_ + config_.lead; step >= std::max<int64_t>(published_ - 1, 0); --step)
    if (const StepRecord* record = ring_.find(step); record && !record->reference.empty())
      return record->reference;
  return {};
}

int64_t LockstepSimulatorRole::digest_of_last() {
  if (!answered(published_)) return 0;
  StepRecord& last = *ring_.find(published_);
  last.trim();
  return last.digest();
}

}  // namespace lab
