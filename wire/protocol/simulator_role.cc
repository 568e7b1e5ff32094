#include "wire/protocol/simulator_role.h"

#include <fmt/format.h>

#include <algorithm>
#include <lab/ack_t.hpp>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/reply_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

constexpr size_t kMaxFormer = 64;

}  // namespace

SimulatorRole::SimulatorRole(SimulatorConfig config, SimulateStep simulate, Publish publish)
    : config_(std::move(config)),
      simulate_(std::move(simulate)),
      publish_(std::move(publish)),
      last_step_(config_.last_step) {
  for (const auto& name : config_.required) peers_[name];
}

/// RUN comes after the first PROCESS, which tells the others whose message it is.
void SimulatorRole::announce() {
  if (announced_) return;
  announced_ = true;
  publish_(Channel::Run, config_.run);
}

/// RUN and every TYPE in turn, one message at a time, for programs that joined the bus after the start. The processes of the
/// run have RUN, and the logger writes TYPE by itself: they ignore this.
void SimulatorRole::introduce(Micros now) {
  if (phase_ > Phase::Running) return;
  if (!next_introduction_) next_introduction_ = now + kIntroduce;
  if (now < *next_introduction_) return;
  next_introduction_ = now + kIntroduce;
  if (introduced_ == 0)
    publish_(Channel::Run, config_.run);
  else
    publish_(Channel::Type, config_.types[introduced_ - 1]);
  introduced_ = (introduced_ + 1) % (config_.types.size() + 1);
}

/// Answers NEED(-1), which anybody may send.
void SimulatorRole::publish_run_again(Micros now) {
  if (now - run_sent_ < kRunAgain) return;
  run_sent_ = now;
  publish_(Channel::Run, config_.run);
}

std::string SimulatorRole::state() const {
  if (verdict_.exit_code != kOk) return "FAULT";
  if (phase_ == Phase::Gathering) return "READY";
  return phase_ == Phase::Running ? mode_ : "STOPPING";
}

// ---- received messages --------------------------------------------------------------------------------------

void SimulatorRole::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  announce();
  switch (channel) {
    case Channel::Ack: {
      const auto ack = decode<ack_t>(bytes);
      if (std::find(config_.listeners.begin(), config_.listeners.end(), ack.process) ==
          config_.listeners.end())
        break;
      on_ack(ack.process, ack.complete_to);
      if (ack.closed && phase_ == Phase::Ending) closed_.insert(ack.process);
      take_due_steps(now);
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

void SimulatorRole::on_process(const process_t& process, Micros now) {
  const auto known = peers_.find(process.name);
  if (known == peers_.end()) return;
  Peer& peer = known->second;
  if (process.pid != peer.pid) {
    if (process.utime <= peer.heard) return;        // a delayed message of a process that was replaced
    if (peer.former.contains(process.pid)) return;  // two live processes of one name: the newer one counts
    if (peer.former.size() >= kMaxFormer) peer.former.erase(peer.former.begin());
    if (peer.pid) peer.former.insert(peer.pid);
    peer.pid = process.pid;
    peer.step = process.step;
  }
  if (process.step > peer.step) idle_timer_.reset();
  peer.state = process.state;
  peer.step = process.step;
  peer.heard = std::max(peer.heard, process.utime);
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

/// Why a request that has not been executed before is refused before its content is looked at; empty if it is not.
std::string SimulatorRole::why_not_now(const request_t& request, Micros now) const {
  if (config_.wall_offset != 0) {
    const Micros age = now + config_.wall_offset - request.utime;
    if (std::abs(age) > kMaxRequestAge)
      return fmt::format("its utime is {:.1f} s {} this host's clock, at most {:g} s are allowed",
                         std::abs(static_cast<double>(age)) * 1e-6, age > 0 ? "behind" : "ahead of",
                         kMaxRequestAge * 1e-6);
  }
  if (request.run == 0 && neighbour_heard_ && now - *neighbour_heard_ < kNeighbourStays)
    return fmt::format("another lab is on this bus: say which run is meant (this one is {:016x})",
                       static_cast<uint64_t>(config_.run_id));
  if (actions_.size() >= kMaxInputs)
    return fmt::format("busy: {} requests wait for the next step, try again", kMaxInputs);
  return {};
}

void SimulatorRole::on_request(const request_t& request, Micros now) {
  if (request.sender.size() > kMaxSender) {
    ++late_;
    return;
  }
  const bool urgent = request.action.verb == "estop";
  ReplyCache::Answer known = replies_.look_up(request.sender, request.id, urgent, now);
  if (known.reply) return publish_(Channel::Reply, *known.reply);

  reply_t reply{};
  reply.run = config_.run_id;
  reply.sender = request.sender;
  reply.id = request.id;
  reply.step = published_ + 1;
  reply.utime = utime(reply.step);
  reply.reason = known.refusal;
  if (reply.reason.empty() && !urgent) reply.reason = why_not_now(request, now);
  const bool passed = reply.reason.empty();
  if (passed) reply.reason = execute(request, now);
  if (reply.reason.size() > kMaxReason) reply.reason.resize(kMaxReason);
  reply.ok = reply.reason.empty();
  if (reply.ok && request.action.verb == "get") reply.reason = in_force();
  if (!reply.ok) {
    reply.step = -1;
    reply.utime = 0;
  }
  Bytes bytes = encode(reply);
  publish_(Channel::Reply, bytes);
  if (passed) replies_.remember(request.sender, request.id, std::move(bytes), now);
  take_due_steps(now);
}

/// Does what a request asks for. Returns why it is refused; empty if it is not.
std::string SimulatorRole::execute(const request_t& request, Micros now) {
  if (phase_ == Phase::Gathering) return "the run has not started";
  if (phase_ != Phase::Running || published_ >= last_step_) return "the run is ending";
  const Action action = to_signal(request.action);
  if (action.verb == "get") return {};  // answered with what is in force
  if (action.verb == "pause") {
    paused_ = true;
  } else if (action.verb == "resume") {
    paused_ = false;
    single_steps_ = 0;
    on_resume(now);
  } else if (action.verb == "step") {
    if (!paused_) return "the run is not paused";
    const double count = action.values.empty() ? 1 : action.values[0];
    single_steps_ += static_cast<int64_t>(std::clamp<double>(count, 0, static_cast<double>(kMaxSingleSteps)));
    single_steps_ = std::min(single_steps_, kMaxSingleSteps);
  } else if (action.verb == "reset") {
    restart_requested_ = config_.no_reset.empty();
    if (!restart_requested_) return config_.no_reset;
    on_reset(request.sender);
  } else if (action.verb == "estop" &&
             std::any_of(actions_.begin(), actions_.end(),
                         [](const Action& waiting) { return waiting.verb == "estop"; })) {
    // one is enough for the next step: a flood of them stays bounded
  } else {
    if (std::string why = why_not(action); !why.empty()) return why;
    accept_input(request, action);
  }
  return {};
}

std::string SimulatorRole::in_force() const {
  std::string text = config_.in_force ? config_.in_force() : "";
  text += "simulator.state\t" + (paused_ ? "PAUSED" : state()) + "\t\n";
  if (text.size() > kMaxAnswer) text.resize(kMaxAnswer);
  return text;
}

std::string SimulatorRole::why_not(const Action& action) {
  if (!config_.why_not) return {};
  const std::span<const uint8_t> bytes = newest_reference();
  if (bytes.empty()) return config_.why_not(action, nullptr);
  const Reference newest = to_signal(decode<reference_t>(bytes));
  return config_.why_not(action, &newest);
}

/// The action becomes an INPUT of the next step.
void SimulatorRole::accept_input(const request_t& request, const Action& action) {
  input_step_ = published_ + 1;
  input_t input{};
  input.utime = utime(input_step_);
  input.run = config_.run_id;
  input.step = input_step_;
  input.input_seq = ++input_seq_;
  input.sender = request.sender;
  input.id = request.id;
  input.action = request.action;
  actions_.push_back(action);
  const Bytes bytes = encode(input);
  on_input(input.step, bytes);
  publish_(Channel::Input, bytes);
}

// ---- phases -------------------------------------------------------------------------------------------------

void SimulatorRole::start_if_ready(Micros now) {
  if (phase_ != Phase::Gathering) return;
  for (const auto& name : config_.required)
    if (!peers_[name].ready) return;
  phase_ = Phase::Running;
  started_at_ = now;
  begin(now);
}

void SimulatorRole::compose(const StepResult& result, int64_t step, robot_state_t& message, const Put& put) {
  for (size_t i = 0; i < result.events.size(); ++i)
    put(Channel::Event, encode(to_message(result.events[i], kSimulator, step, utime(step), config_.run_id,
                                          static_cast<int64_t>(i))));
  to_message(result.state, message);
  message.utime = utime(step);
  message.run = config_.run_id;
  message.step = step;
  message.input_seq = input_seq_;
  message.extras = static_cast<int32_t>(actions_.size() + result.events.size());
  put(Channel::RobotState, encode(message));
  actions_.clear();
  published_ = step;
  mode_ = result.mode;
  idle_timer_.reset();
}

void SimulatorRole::tick(Micros now) {
  announce();
  idle_timer_.update(now);
  switch (phase_) {
    case Phase::Gathering:
      if (idle_timer_.elapsed() > config_.ready_deadline)
        fail(kNotReady,
             fmt::format("not ready in {:g} s: {}", config_.ready_deadline * 1e-6, missing_processes()), now);
      break;
    case Phase::Running:
      take_due_steps(now);
      break;
    case Phase::Ending:
      if (now >= next_end_) {
        publish_(Channel::End, end_);
        next_end_ = now + kRepeat;
      }
      finish_if_logs_closed();
      if (phase_ == Phase::Ending &&
          idle_timer_.elapsed() >
              (verdict_.exit_code == kOk ? config_.deadline : std::min(config_.deadline, 20 * kRepeat))) {
        if (verdict_.exit_code == kOk) verdict_ = {true, kTransport, open_log()};
        phase_ = Phase::Over;
        outcome_ = verdict_;
      }
      break;
    case Phase::Over:
      break;
  }
  introduce(now);
}

Micros SimulatorRole::wake() const {
  return phase_ == Phase::Running ? next_wake() : phase_ == Phase::Ending ? next_end_ : INT64_MAX;
}

/// Whose log is not closed in time.
std::string SimulatorRole::open_log() const {
  const auto open = std::find_if(config_.listeners.begin(), config_.listeners.end(),
                                 [&](const std::string& name) { return !closed_.contains(name); });
  return fmt::format("{} did not close its log in {:g} s", *open, config_.deadline * 1e-6);
}

std::string SimulatorRole::missing_processes() const {
  std::string text;
  for (const auto& name : config_.required) {
    const Peer& peer = peers_.at(name);
    if (peer.ready) continue;
    if (!text.empty()) text += ", ";
    text += fmt::format("{} ({})", name, peer.state.empty() ? "never heard" : peer.state);
  }
  return text;
}

// ---- end ----------------------------------------------------------------------------------------------------

void SimulatorRole::stop(Micros now) {
  if (phase_ == Phase::Gathering) return end(true, "stopped before step 0", now);
  if (phase_ != Phase::Running) return;
  last_step_ = std::max(published_, input_step_);
  paused_ = false;
  take_due_steps(now);
}

void SimulatorRole::fail(int exit_code, const std::string& reason, Micros now) {
  if (phase_ >= Phase::Ending) return;
  verdict_ = {true, exit_code, reason};
  end(true, reason, now);
}

void SimulatorRole::end(bool aborted, const std::string& reason, Micros now) {
  end_t end{};
  end.run = config_.run_id;
  end.aborted = aborted;
  end.reason = reason;
  end.step = published_;
  end.utime = utime(std::max<int64_t>(published_, 0));
  end.digest = digest_of_last();
  last_step_ = published_;
  end_ = encode(end);
  verdict_.ended = true;
  phase_ = Phase::Ending;
  idle_timer_.reset();
  publish_(Channel::End, end_);
  next_end_ = now + kRepeat;
  ended_at_ = now;
  finish_if_logs_closed();
}

void SimulatorRole::finish_if_logs_closed() {
  if (phase_ != Phase::Ending || closed_.size() < config_.listeners.size()) return;
  phase_ = Phase::Over;
  outcome_ = verdict_;
}

}  // namespace lab
