#include "wire/protocol/leader.h"

#include <fmt/format.h>

#include <algorithm>
#include <lab/ack_t.hpp>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/reply_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {

Leader::Leader(LeaderConfig config, AdvanceStep advance, Publish publish)
    : config_(std::move(config)),
      advance_(std::move(advance)),
      publish_(std::move(publish)),
      last_step_(config_.last_step) {
  for (const auto& name : config_.required) peers_[name];
  publish_(Channel::Run, config_.run);
}

std::string Leader::state() const {
  if (verdict_.exit_code != kOk) return "FAULT";
  if (phase_ == Phase::Gathering) return "READY";
  return phase_ == Phase::Running ? mode_ : "STOPPING";
}

// ---- what comes in ------------------------------------------------------------------------------------------

void Leader::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  switch (channel) {
    case Channel::Ack: {
      const auto ack = decode<ack_t>(bytes);
      if (std::find(config_.listeners.begin(), config_.listeners.end(), ack.process) ==
          config_.listeners.end())
        break;
      on_ack(ack.process, ack.complete_to);
      if (ack.closed && phase_ == Phase::Ending) closed_.insert(ack.process);
      go_on(now);
      break;
    }
    case Channel::Need: {
      const auto need = decode<need_t>(bytes);
      if (need.process == kSimulator) on_need(need.step, now);
      break;
    }
    case Channel::Process:
      on_process(decode<process_t>(bytes), now);
      break;
    case Channel::Request:
      on_request(decode<request_t>(bytes), now);
      break;
    default:
      on_message(channel, bytes, now);
  }
}

void Leader::on_process(const process_t& process, Micros now) {
  const auto known = peers_.find(process.name);
  if (known == peers_.end() || (config_.nonce && process.nonce != config_.nonce)) return;
  Peer& peer = known->second;
  if (process.pid != peer.pid) {
    if (process.utime <= peer.heard) return;  // an old word, overtaken by a newer process'
    if (peer.former.contains(process.pid)) {
      fail(kTransport,
           fmt::format("two live processes are named {}: pid {} and pid {}", process.name, peer.pid,
                       process.pid),
           now);
      return;
    }
    if (peer.pid) peer.former.insert(peer.pid);
    peer.pid = process.pid, peer.step = process.step;
  }
  if (process.step > peer.step) silence_.progress();
  peer.state = process.state, peer.step = process.step, peer.heard = std::max(peer.heard, process.utime);
  if (process.run == config_.run_id && process.model_hash != 0 && process.model_hash != config_.model_hash &&
      phase_ <= Phase::Running) {
    fail(kNotReady,
         fmt::format("{} has another model: hash {:016x}, the simulator's is {:016x}", process.name,
                     static_cast<uint64_t>(process.model_hash), static_cast<uint64_t>(config_.model_hash)),
         now);
    return;
  }
  peer.ready = process.run == config_.run_id &&
               (process.state == "READY" || process.state == "RUNNING" || process.state == "HOLDING");
  start_if_ready(now);
}

void Leader::on_request(const request_t& request, Micros now) {
  const std::pair<std::string, int64_t> key{request.sender, request.id};
  if (const auto known = replies_.find(key); known != replies_.end())
    return publish_(Channel::Reply, known->second);

  reply_t reply{};
  reply.run = config_.run_id, reply.sender = request.sender, reply.id = request.id;
  reply.step = published_ + 1, reply.utime = utime(reply.step), reply.ok = true;
  const Action action = to_signal(request.action);
  const auto refuse = [&](const std::string& why) {
    reply.ok = false, reply.step = -1, reply.utime = 0, reply.reason = why;
  };

  if (phase_ != Phase::Running || published_ >= last_step_) {
    refuse(phase_ == Phase::Gathering ? "the run has not started" : "the run is ending");
  } else if (action.verb == "pause") {
    paused_ = true;
  } else if (action.verb == "resume") {
    paused_ = false, single_steps_ = 0;
    on_resume(now);
  } else if (action.verb == "step") {
    if (!paused_)
      refuse("the run is not paused");
    else
      single_steps_ +=
          action.values.empty() ? 1 : std::max<int64_t>(0, static_cast<int64_t>(action.values[0]));
  } else if (action.verb == "reset") {
    again_ = config_.no_reset.empty();
    if (again_)
      on_reset(request.sender);
    else
      refuse(config_.no_reset);
  } else if (const std::string why = config_.why_not ? config_.why_not(action) : ""; !why.empty()) {
    refuse(why);
  } else {
    input_t input{};
    input.utime = reply.utime, input.run = config_.run_id, input.step = input_step_ = published_ + 1;
    input.input_seq = ++input_seq_, input.sender = request.sender, input.id = request.id,
    input.action = request.action;
    actions_.push_back(action);
    const Bytes bytes = encode(input);
    on_input(input.step, bytes);
    publish_(Channel::Input, bytes);
  }
  publish_(Channel::Reply, replies_[key] = encode(reply));
  silence_.progress();
  go_on(now);
}

// ---- what goes on -------------------------------------------------------------------------------------------

void Leader::start_if_ready(Micros now) {
  if (phase_ != Phase::Gathering) return;
  for (const auto& name : config_.required)
    if (!peers_[name].ready) return;
  phase_ = Phase::Running;
  started_at_ = now;
  begin(now);
}

void Leader::compose(const Advance& advance, int64_t step, robot_state_t& message, const Put& put) {
  for (size_t i = 0; i < advance.events.size(); ++i)
    put(Channel::Event, encode(to_message(advance.events[i], kSimulator, step, utime(step), config_.run_id,
                                          static_cast<int64_t>(i))));
  to_message(advance.state, message);
  message.utime = utime(step), message.run = config_.run_id, message.step = step;
  message.input_seq = input_seq_;
  message.extras = static_cast<int32_t>(actions_.size() + advance.events.size());
  put(Channel::RobotState, encode(message));
  actions_.clear();
  published_ = step;
  mode_ = advance.mode;
  silence_.progress();
}

void Leader::tick(Micros now) {
  silence_.look(now);
  switch (phase_) {
    case Phase::Gathering:
      if (silence_.total() > config_.ready_deadline)
        fail(kNotReady,
             fmt::format("not ready in {:g} s: {}", config_.ready_deadline * 1e-6, missing_party()), now);
      break;
    case Phase::Running:
      go_on(now);
      break;
    case Phase::Ending:
      if (now >= next_end_) publish_(Channel::End, end_), next_end_ = now + kRepeat;
      leave_if_all_closed();
      if (phase_ == Phase::Ending &&
          silence_.total() >
              (verdict_.exit_code == kOk ? config_.deadline : std::min(config_.deadline, 20 * kRepeat))) {
        if (verdict_.exit_code == kOk) verdict_ = {true, kTransport, "the log was not closed in time"};
        phase_ = Phase::Over, outcome_ = verdict_;
      }
      break;
    case Phase::Over:
      break;
  }
}

Micros Leader::wake() const {
  return phase_ == Phase::Running ? next_look() : phase_ == Phase::Ending ? next_end_ : INT64_MAX;
}

std::string Leader::missing_party() const {
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

void Leader::stop(Micros now) {
  if (phase_ == Phase::Gathering) return end(true, "stopped before step 0", now);
  if (phase_ != Phase::Running) return;
  last_step_ = std::max(published_, input_step_);
  paused_ = false;
  go_on(now);
}

void Leader::fail(int exit_code, const std::string& reason, Micros now) {
  if (phase_ >= Phase::Ending) return;
  verdict_ = {true, exit_code, reason};
  end(true, reason, now);
}

void Leader::end(bool aborted, const std::string& reason, Micros now) {
  end_t end{};
  end.run = config_.run_id, end.aborted = aborted, end.reason = reason;
  end.step = published_, end.utime = utime(std::max<int64_t>(published_, 0));
  end.digest = digest_of_last();
  last_step_ = published_;
  end_ = encode(end);
  verdict_.ended = true;
  phase_ = Phase::Ending;
  silence_.progress();
  publish_(Channel::End, end_);
  next_end_ = now + kRepeat, ended_at_ = now;
  leave_if_all_closed();
}

void Leader::leave_if_all_closed() {
  if (phase_ != Phase::Ending || closed_.size() < config_.listeners.size()) return;
  phase_ = Phase::Over, outcome_ = verdict_;
}

}  // namespace lab
