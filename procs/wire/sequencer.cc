#include "procs/wire/sequencer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lab/ack_t.hpp>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/reply_t.hpp>
#include <lab/robot_state_t.hpp>

#include "procs/wire/codec.h"
#include "procs/wire/convert.h"

namespace lab {

Sequencer::Sequencer(SequencerConfig config, AdvanceStep advance, Publish publish)
    : config_(std::move(config)),
      advance_(std::move(advance)),
      publish_(std::move(publish)),
      last_step_(config_.last_step) {
  for (const auto& name : config_.required) peers_[name];
  for (const auto& name : config_.listeners) acks_[name] = kBeforeStart;
  publish_(Channel::Run, config_.run);
}

std::string Sequencer::state() const {
  if (verdict_.exit_code != kOk) return "FAULT";
  if (phase_ == Phase::Gathering) return "READY";
  return phase_ == Phase::Running ? "RUNNING" : "STOPPING";
}

int64_t Sequencer::utime(int64_t step) const { return step_utime(step, config_.dt); }

// ---- what comes in ------------------------------------------------------------------------------------------

void Sequencer::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  switch (channel) {
    case Channel::Reference:
    case Channel::Command:
    case Channel::Event:
      file(channel, bytes);
      advance_while_possible(now);
      break;
    case Channel::Ack: {
      const auto ack = decode<ack_t>(bytes);
      const auto known = acks_.find(ack.process);
      if (known == acks_.end()) break;
      if (ack.complete_to > known->second) known->second = ack.complete_to, silence_.progress();
      if (ack.closed && phase_ == Phase::Ending) closed_.insert(ack.process);
      advance_while_possible(now);
      break;
    }
    case Channel::Need: {
      const auto need = decode<need_t>(bytes);
      if (need.process == kSimulator) on_need(need.step, now);
      break;
    }
    case Channel::Process: on_process(decode<process_t>(bytes), now); break;
    case Channel::Request: on_request(decode<request_t>(bytes), now); break;
    default: break;
  }
}

/// Keeps an answer; the first one counts.
void Sequencer::file(Channel channel, std::span<const uint8_t> bytes) {
  const int64_t step = peek_step(bytes);
  const bool ahead = step > std::max<int64_t>(published_, kBeforeStart) + std::max<int64_t>(config_.lead, 0);
  if (step < 0 || step < published_ || ahead || phase_ == Phase::Ending) {
    if (step >= 0 && step < published_) ++late_;
    return;
  }
  if (channel == Channel::Command && !command_due(step)) return;
  ring_.at(step).file(channel, bytes, false);
}

void Sequencer::refused(const Refusal& refusal, Micros now) {
  if (refusal.channel != Channel::Command && refusal.channel != Channel::Reference) return;
  last_refusal_ = refusal.reason;
  if (phase_ != Phase::Running || refusal.step < published_) return;
  const char* who = refusal.channel == Channel::Command ? kController : kPlanner;
  fail(refusal.non_finite ? kSafety : kTransport, fmt::format("{}'s message for step {} was refused: {}", who, refusal.step, refusal.reason), now);
}

void Sequencer::on_process(const process_t& process, Micros now) {
  const auto known = peers_.find(process.name);
  if (known == peers_.end() || (config_.nonce && process.nonce != config_.nonce)) return;
  Peer& peer = known->second;
  if (process.pid != peer.pid) {
    if (process.utime <= peer.heard) return;  // an old word, overtaken by a newer process'
    if (peer.former.contains(process.pid)) {
      fail(kTransport, fmt::format("two live processes are named {}: pid {} and pid {}", process.name, peer.pid, process.pid), now);
      return;
    }
    if (peer.pid) peer.former.insert(peer.pid);
    peer.pid = process.pid, peer.step = process.step;
  }
  if (process.step > peer.step) silence_.progress();
  peer.state = process.state, peer.step = process.step, peer.heard = std::max(peer.heard, process.utime);
  if (process.run == config_.run_id && process.model_hash != 0 && process.model_hash != config_.model_hash && phase_ <= Phase::Running) {
    fail(kNotReady, fmt::format("{} has another model: hash {:016x}, the simulator's is {:016x}", process.name,
                                static_cast<uint64_t>(process.model_hash), static_cast<uint64_t>(config_.model_hash)), now);
    return;
  }
  peer.ready = process.run == config_.run_id && (process.state == "READY" || process.state == "RUNNING");
  start_if_ready(now);
}

void Sequencer::on_request(const request_t& request, Micros now) {
  const std::pair<std::string, int64_t> key{request.sender, request.id};
  if (const auto known = replies_.find(key); known != replies_.end()) return publish_(Channel::Reply, known->second);

  reply_t reply{};
  reply.run = config_.run_id, reply.sender = request.sender, reply.id = request.id;
  reply.step = published_ + 1, reply.utime = utime(reply.step), reply.ok = true;
  const std::string& verb = request.action.verb;
  const auto refuse = [&](const std::string& why) { reply.ok = false, reply.step = -1, reply.utime = 0, reply.reason = why; };

  if (phase_ != Phase::Running || published_ >= last_step_) {
    refuse(phase_ == Phase::Gathering ? "the run has not started" : "the run is ending");
  } else if (verb == "pause") {
    paused_ = true;
  } else if (verb == "resume") {
    paused_ = false, single_steps_ = 0;
  } else if (verb == "step") {
    if (!paused_) refuse("the run is not paused");
    else single_steps_ += request.action.n > 0 ? static_cast<int64_t>(request.action.values[0]) : 1;
  } else if (verb == "reset") {
    refuse("reset is for real time only");
  } else {
    input_t input{};
    input.utime = reply.utime, input.run = config_.run_id, input.step = input_step_ = published_ + 1;
    input.input_seq = ++input_seq_, input.sender = request.sender, input.id = request.id, input.action = request.action;
    actions_.push_back(to_signal(request.action));
    const Bytes bytes = encode(input);
    ring_.at(input.step).file(Channel::Input, bytes, false);
    publish_(Channel::Input, bytes);
  }
  publish_(Channel::Reply, replies_[key] = encode(reply));
  silence_.progress();
  advance_while_possible(now);
}

void Sequencer::on_need(int64_t step, Micros now) {
  Micros& last = resent_[step];
  if (last != 0 && now - last < kFirstWait / 2) return;
  last = now;
  if (step == kBeforeStart) return publish_(Channel::Run, config_.run);
  resent_.erase(resent_.lower_bound(0), resent_.lower_bound(std::max<int64_t>(published_ - ring_.size(), 0)));
  if (const StepRecord* record = ring_.find(step)) resend(*record);
  if (!end_.empty() && step >= last_step_) publish_(Channel::End, end_);
}

/// Extras first, then the main message, process by process.
void Sequencer::resend(const StepRecord& record) {
  for (const auto& [seq, bytes] : record.inputs) publish_(Channel::Input, bytes);
  for (const auto& [key, bytes] : record.events) publish_(Channel::Event, bytes);
  if (!record.state.empty()) publish_(Channel::RobotState, record.state);
  if (!record.reference.empty()) publish_(Channel::Reference, record.reference);
  if (!record.command.empty()) publish_(Channel::Command, record.command);
}

// ---- what goes on -------------------------------------------------------------------------------------------

void Sequencer::start_if_ready(Micros now) {
  if (phase_ != Phase::Gathering) return;
  for (const auto& name : config_.required)
    if (!peers_[name].ready) return;
  phase_ = Phase::Running;
  started_at_ = now;
  if (publish_state(0, now)) advance_while_possible(now);
}

bool Sequencer::answered(int64_t step) {
  const StepRecord* record = ring_.find(step);
  return record && record->complete(command_due(step));
}

bool Sequencer::credit_for(int64_t step) const {
  return std::all_of(acks_.begin(), acks_.end(), [&](const auto& ack) { return ack.second >= step - kWindow; });
}

void Sequencer::advance_while_possible(Micros now) {
  while (phase_ == Phase::Running && published_ >= 0 && answered(published_)) {
    if (published_ >= last_step_) return end(false, "", now);
    if (paused_ && single_steps_ == 0) return;
    if (!credit_for(published_ + 1)) return;
    if (paused_) --single_steps_;
    if (!publish_state(published_ + 1, now)) return;
  }
}

/// Integrates to `step` and publishes it, extras first. Returns false if the run ended instead.
bool Sequencer::publish_state(int64_t step, Micros now) {
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
  const Advance advance = advance_(step, fresh, actions_);
  if (!advance.abort.empty()) return fail(kSafety, fmt::format("step {}: {}", step, advance.abort), now), false;

  StepRecord& record = ring_.at(step);
  const auto put = [&](Channel channel, const Bytes& bytes) {
    record.file(channel, bytes, true);
    publish_(channel, bytes);
  };
  for (size_t i = 0; i < advance.events.size(); ++i)
    put(Channel::Event, encode(to_message(advance.events[i], kSimulator, step, utime(step), config_.run_id, static_cast<int64_t>(i))));
  to_message(advance.state, message);
  message.utime = utime(step), message.run = config_.run_id, message.step = step;
  message.input_seq = input_seq_;
  message.command_step = step > 0 ? (step - 1) / config_.every * config_.every : -1;
  message.extras = static_cast<int32_t>(actions_.size() + advance.events.size());
  put(Channel::RobotState, encode(message));

  actions_.clear();
  published_ = step;
  asked_ = 0;
  patience_.reset(now);
  silence_.progress();
  return true;
}

void Sequencer::tick(Micros now) {
  silence_.look(now);
  switch (phase_) {
    case Phase::Gathering:
      if (silence_.total() > config_.ready_deadline)
        fail(kNotReady, fmt::format("not ready in {:g} s: {}", config_.ready_deadline * 1e-6, missing_party()), now);
      break;
    case Phase::Running:
      advance_while_possible(now);
      if (phase_ != Phase::Running) break;
      if (paused_ && answered(published_)) silence_.progress();
      if (patience_.expired(now)) ask_for_answers();
      if (silence_.total() > config_.deadline)
        fail(kTransport, fmt::format("{} in {:g} s{}", silent_party(), config_.deadline * 1e-6,
                                     last_refusal_.empty() ? "" : "; last refused: " + last_refusal_), now);
      break;
    case Phase::Ending:
      if (now >= next_end_) publish_(Channel::End, end_), next_end_ = now + kRepeat;
      leave_if_all_closed();
      if (phase_ == Phase::Ending && silence_.total() > (verdict_.exit_code == kOk ? config_.deadline : std::min(config_.deadline, 20 * kRepeat))) {
        if (verdict_.exit_code == kOk) verdict_ = {true, kTransport, "the log was not closed in time"};
        phase_ = Phase::Over, outcome_ = verdict_;
      }
      break;
    case Phase::Over: break;
  }
}

Micros Sequencer::wake() const {
  return phase_ == Phase::Running ? patience_.due() : phase_ == Phase::Ending ? next_end_ : INT64_MAX;
}

void Sequencer::ask_for_answers() {
  const StepRecord* record = ring_.find(published_);
  const auto ask = [&](const char* whom) {
    need_t need{};
    need.utime = utime(published_), need.run = config_.run_id, need.step = published_;
    need.process = whom, need.sender = kSimulator;
    publish_(Channel::Need, encode(need));
  };
  const bool reference = record->closed_by(kPlanner);
  const bool command = !command_due(published_) || record->closed_by(kController);
  if (reference && command) return;
  if (!reference) ask(kPlanner);
  if (!command) ask(kController);
  if (++asked_ % 3 == 0) resend(*record);
}

/// Who keeps the run from going on, in words.
std::string Sequencer::silent_party() {
  const StepRecord* record = ring_.find(published_);
  if (!record->closed_by(kPlanner)) return fmt::format("{} gave no REFERENCE for step {}", kPlanner, published_);
  if (command_due(published_) && !record->closed_by(kController)) return fmt::format("{} gave no COMMAND for step {}", kController, published_);
  for (const auto& [name, ack] : acks_)
    if (ack < published_ + 1 - kWindow) return fmt::format("{} wrote nothing after step {}", name, ack);
  return fmt::format("nothing went on after step {}", published_);
}

std::string Sequencer::missing_party() const {
  std::string text;
  for (const auto& name : config_.required) {
    const Peer& peer = peers_.at(name);
    if (peer.ready) continue;
    if (!text.empty()) text += ", ";
    text += fmt::format("{} ({})", name, peer.state.empty() ? "never heard" : peer.state);
  }
  return text;
}

// ---- how it ends --------------------------------------------------------------------------------------------

void Sequencer::stop(Micros now) {
  if (phase_ == Phase::Gathering) return end(true, "stopped before step 0", now);
  if (phase_ != Phase::Running) return;
  last_step_ = std::max(published_, input_step_);
  paused_ = false;
  advance_while_possible(now);
}

void Sequencer::fail(int exit_code, const std::string& reason, Micros now) {
  if (phase_ >= Phase::Ending) return;
  verdict_ = {true, exit_code, reason};
  end(true, reason, now);
}

void Sequencer::end(bool aborted, const std::string& reason, Micros now) {
  end_t end{};
  end.run = config_.run_id, end.aborted = aborted, end.reason = reason;
  end.step = published_, end.utime = utime(std::max<int64_t>(published_, 0));
  if (answered(published_)) {
    StepRecord& last = *ring_.find(published_);
    last.trim();
    end.digest = last.digest();
  }
  last_step_ = published_;
  end_ = encode(end);
  verdict_.ended = true;
  phase_ = Phase::Ending;
  silence_.progress();
  publish_(Channel::End, end_);
  next_end_ = now + kRepeat, ended_at_ = now;
  leave_if_all_closed();
}

void Sequencer::leave_if_all_closed() {
  if (phase_ != Phase::Ending || closed_.size() < acks_.size()) return;
  phase_ = Phase::Over, outcome_ = verdict_;
}

}  // namespace lab
