#include "wire/protocol/realtime_simulator.h"

#include <fmt/format.h>

#include <lab/input_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab {

void RealtimeSimulatorRole::on_message(Channel channel, std::span<const uint8_t> bytes, Micros) {
  if (channel == Channel::Reference && (reference_.empty() || peek_step(bytes) > peek_step(reference_)))
    reference_.assign(bytes.begin(), bytes.end());
  if (channel != Channel::Command || phase_ != Phase::Running) return;
  command_t command;
  decode(bytes, command);
  if (command.state_step > published_ || (fresh_ && command.state_step <= command_.state_step)) {
    ++late_;
    return;
  }
  command_ = std::move(command);
  fresh_ = true;
}

/// At most one EVENT in a hundred steps about refused commands.
void RealtimeSimulatorRole::refused(const Refusal& refusal, Micros) {
  if (refusal.channel != Channel::Command || phase_ != Phase::Running || published_ < refused_at_ + 100)
    return;
  refused_at_ = published_;
  noticed_.push_back({"command_rejected", kController, refusal.reason});
}

bool StrangerLimit::allows(const std::string& who, Micros now) {
  if (now - second_ >= 1'000'000) {
    second_ = now;
    count_ = 0;
    last_.clear();
  }
  if (count_ >= 10 || !last_.try_emplace(who, now).second) return false;
  ++count_;
  return true;
}

void RealtimeSimulatorRole::stranger(Channel channel, const std::string& reason, Micros now) {
  if (phase_ != Phase::Running || !strangers_.allows(reason, now)) return;
  noticed_.push_back({"stranger_ignored", std::string(row(channel).name), reason});
}

void RealtimeSimulatorRole::on_input(int64_t, const Bytes& input) {
  const auto message = decode<input_t>(input);
  int64_t& seq = kept_seq_[{message.action.verb, message.action.target, message.action.key}];
  kept_.erase(seq);
  seq = message.input_seq;
  kept_[seq] = input;
  if (kept_.size() <= kMaxKept) return;
  kept_.erase(kept_.begin());
  std::erase_if(kept_seq_, [&](const auto& entry) { return !kept_.contains(entry.second); });
}

/// The INPUTs follow with the next ticks.
void RealtimeSimulatorRole::on_need(int64_t step, Micros now) {
  if (step == kBeforeStart) publish_run_again(now);
  if (resend_from_ == INT64_MAX) resend_from_ = 0;
  if (!end_.empty()) publish_(Channel::End, end_);
}

void RealtimeSimulatorRole::tick(Micros now) {
  SimulatorRole::tick(now);
  auto input = kept_.lower_bound(resend_from_);
  for (int n = 0; n < kInputsPerTick && input != kept_.end(); ++n, ++input)
    publish_(Channel::Input, input->second);
  resend_from_ = input == kept_.end() ? INT64_MAX : input->first;
}

/// Takes one more step, so that the log contains the reason for the end.
void RealtimeSimulatorRole::on_reset(const std::string& sender) {
  noticed_.push_back({"reset", sender, "asked for a new run"});
  last_step_ = std::min(last_step_, published_ + 1);
  paused_ = false;
}

void RealtimeSimulatorRole::begin(Micros now) {
  grid_start_ = now;
  take_step(now);
}

void RealtimeSimulatorRole::start_grid(Micros now) {
  grid_step_ = published_ + 1;
  grid_start_ = now;
}

void RealtimeSimulatorRole::take_due_steps(Micros now) {
  for (int n = 0; n < kStepsPerTick && phase_ == Phase::Running; ++n) {
    if (published_ >= last_step_) return end(false, "", now);
    if (paused_ && single_steps_ == 0) {
      start_grid(now + kRepeat);
      idle_timer_.reset();
      return;
    }
    const Micros late = now - due(published_ + 1);
    if (paused_) {
      --single_steps_;
    } else if (late < 0) {
      return;
    } else {
      lateness_.add(late);
      overruns_ += static_cast<double>(late) > config_.dt * 1e6;
      if (late > kSlip) {
        noticed_.push_back({"clock_slipped", kSimulator,
                            fmt::format("stood still for {} ms; time goes on from here", late / 1000)});
        start_grid(now);
      }
    }
    take_step(now);
  }
}

void RealtimeSimulatorRole::take_step(Micros now) {
  const int64_t step = published_ + 1;
  const Command command = to_signal(command_);
  StepResult result = simulate_(step, fresh_ ? &command : nullptr, actions_);
  if (!result.abort.empty()) return fail(kSafety, fmt::format("step {}: {}", step, result.abort), now);
  fresh_ = false;
  result.events.insert(result.events.begin(), noticed_.begin(), noticed_.end());
  noticed_.clear();
  robot_state_t message{};
  message.command_step = command_.state_step;
  compose(result, step, message, [&](Channel channel, const Bytes& bytes) { publish_(channel, bytes); });
}

}  // namespace lab
