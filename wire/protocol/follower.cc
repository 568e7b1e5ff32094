#include "wire/protocol/follower.h"

#include <fmt/format.h>

#include <lab/command_t.hpp>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {

FollowerRole::FollowerRole(std::string name, Channel answer, FollowerConfig config, BeginRun begin,
                           Publish publish)
    : name_(std::move(name)),
      answer_channel_(answer),
      config_(std::move(config)),
      begin_(std::move(begin)),
      publish_(std::move(publish)) {}

std::string FollowerRole::state() const {
  if (outcome_.exit_code != kOk) return "FAULT";
  if (run_ == 0 || folding_) return "STARTING";
  if (setup_.realtime && next_ > 0 && idle_) return "HOLDING";
  return next_ == 0 ? "READY" : "RUNNING";
}

int64_t FollowerRole::utime(int64_t step) const { return step_utime(step, setup_.dt); }

void FollowerRole::fail(int exit_code, const std::string& reason) { outcome_ = {true, exit_code, reason}; }

void FollowerRole::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  if (outcome_.ended) return;
  if (setup_.realtime) return receive_in_real_time(channel, bytes, now);
  switch (channel) {
    case Channel::Run:
      if (run_ == 0) on_run(bytes, now);
      break;
    case Channel::RobotState:
    case Channel::Reference:
    case Channel::Input:
      if (run_ == 0) break;
      file(channel, bytes, now);
      handle_while_possible(now);
      break;
    case Channel::Need: {
      if (run_ == 0) break;
      const auto need = decode<need_t>(bytes);
      if (need.process != name_ || need.step < 0) break;
      Answer& kept = answers_[need.step % answers_.size()];
      if (kept.step != need.step || now - kept.resent < kFirstWait / 2) break;
      kept.resent = now;
      publish(kept);
      break;
    }
    case Channel::Process:
      if (decode<process_t>(bytes).name == kSimulator) idle_timer_.reset();
      break;
    case Channel::End:
      outcome_.ended = run_ != 0;
      break;
    default:
      break;
  }
}

void FollowerRole::on_run(std::span<const uint8_t> bytes, Micros now) {
  const auto message = decode<run_t>(bytes);
  try {
    setup_ = begin_(message);
  } catch (const std::exception& error) {
    return fail(kBadConfig, error.what());
  }
  run_ = message.run;
  answers_.resize(std::max(setup_.lead, setup_.every) + 2);
  retry_timer_.reset(now);
  folding_ = static_cast<bool>(config_.read_log) && !setup_.realtime;
  if (!setup_.realtime)
    begin();
  else
    ask(kBeforeStart);  // INPUTs of before
  if (folding_) {
    config_.read_log(run_, [&](Channel channel, std::span<const uint8_t> logged) {
      if (channel == Channel::RobotState || channel == Channel::Reference || channel == Channel::Input)
        receive(channel, logged, now);
    });
    folding_ = false;
    for (const Answer& kept : answers_)
      if (kept.step >= 0) publish(kept);
  }
}

void FollowerRole::file(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  idle_timer_.reset();
  if (channel == Channel::Input) {
    const auto input = decode<input_t>(bytes);
    if (input.input_seq > input_seq_) inputs_.try_emplace(input.input_seq, bytes.begin(), bytes.end());
    return;
  }
  const int64_t step = peek_step(bytes);
  if (step < next_ || step >= next_ + ring_.size()) {
    if (step < next_) ++late_;
    return;
  }
  ring_.at(step).file(channel, bytes, false);
  const bool gap = channel == Channel::RobotState && step > next_ && gap_at_ != next_;
  if (gap) {
    gap_at_ = next_;
    retry_timer_.trigger(now);
  }
}

bool FollowerRole::inputs_complete_to(int64_t seq) const {
  for (int64_t i = input_seq_ + 1; i <= seq; ++i)
    if (!inputs_.contains(i)) return false;
  return true;
}

void FollowerRole::handle_while_possible(Micros now) {
  while (!outcome_.ended) {
    const StepRecord* record = ring_.find(next_);
    if (!record || record->state.empty() || !can_handle(*record)) return;
    decode(record->state, state_);
    if (!inputs_complete_to(state_.input_seq)) return;
    const std::vector<Action> actions = take_inputs_to(state_.input_seq);
    ++next_;
    handle(state_, *record, actions);
    retry_timer_.reset(now);
  }
}

std::vector<Action> FollowerRole::take_inputs_to(int64_t seq) {
  std::vector<Action> actions;
  while (input_seq_ < seq) {
    const auto node = inputs_.extract(++input_seq_);
    actions.push_back(to_signal(decode<input_t>(node.mapped()).action));
  }
  return actions;
}

// ---- real time: the newest state counts, nothing is made up for ----------------------------------------------

void FollowerRole::receive_in_real_time(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  switch (channel) {
    case Channel::RobotState:
      idle_timer_.reset();
      if (const int64_t step = peek_step(bytes); step < next_)
        ++late_;
      else if (newest_.empty() || step > peek_step(newest_))
        newest_.assign(bytes.begin(), bytes.end());
      break;
    case Channel::Input:
      file(channel, bytes, now);
      break;
    case Channel::Process:
      if (const auto process = decode<process_t>(bytes); process.name == kSimulator) {
        held_ = process.state != "RUNNING";
        idle_timer_.reset();
      }
      break;
    case Channel::End:
      outcome_.ended = true;
      break;
    default:
      keep(channel, bytes);
  }
}

void FollowerRole::answer_in_real_time(Micros now) {
  if (newest_.empty()) {
    if (now - answered_at_ > std::llround(static_cast<double>(setup_.timeout) * setup_.dt * 1e6))
      idle_ = true;
    return;
  }
  decode(newest_, state_);
  if (!inputs_complete_to(state_.input_seq)) {
    if (retry_timer_.expired(now)) ask(state_.step - 2 * kWindow);
    return;
  }
  newest_.clear();
  idle_ = !answer_newest(state_, take_inputs_to(state_.input_seq), held_);
  next_ = state_.step + 1;
  answered_at_ = now;
  retry_timer_.reset(now);
}

void FollowerRole::give(int64_t step, std::vector<Bytes> events, Bytes main) {
  Answer& kept = answers_[step % answers_.size()];
  kept = {step, std::move(events), std::move(main), 0};
  if (!folding_) publish(kept);
}

std::vector<Bytes> FollowerRole::encoded(const std::vector<Event>& events, int64_t step, int64_t at) const {
  std::vector<Bytes> out;
  for (size_t i = 0; i < events.size(); ++i)
    out.push_back(encode(to_message(events[i], name_, step, at, run_, static_cast<int64_t>(i))));
  return out;
}

void FollowerRole::publish(const Answer& answer) {
  for (const Bytes& event : answer.events) publish_(Channel::Event, event);
  publish_(answer_channel_, answer.main);
}

void FollowerRole::ask(int64_t step) {
  need_t need{};
  need.run = run_;
  need.step = step;
  need.process = kSimulator;
  need.sender = name_;
  publish_(Channel::Need, encode(need));
}

void FollowerRole::tick(Micros now) {
  if (outcome_.ended) return;
  idle_timer_.update(now);
  if (setup_.realtime)
    answer_in_real_time(now);
  else if (retry_timer_.expired(now))
    ask(run_ == 0 ? kBeforeStart : next_);
  if (run_ == 0 && idle_timer_.elapsed() > config_.ready_deadline)
    fail(kNotReady, fmt::format("no RUN from the simulator in {:g} s", config_.ready_deadline * 1e-6));
  else if (run_ != 0 && idle_timer_.elapsed() > config_.deadline)
    fail(kTransport, fmt::format("nothing from the simulator in {:g} s after step {}",
                                 config_.deadline * 1e-6, next_ - 1));
}

// ---- planner ------------------------------------------------------------------------------------------------

void PlannerRole::begin() {
  for (int64_t step = 0; step < setup_.lead && step <= setup_.last_step; ++step)
    give_reference(step, utime(step), {});
}

void PlannerRole::handle(const robot_state_t& message, const StepRecord& record,
                         std::span<const Action> actions) {
  const RobotState state = to_signal(message);
  const int64_t step = record.step + setup_.lead;
  if (step <= setup_.last_step) give_reference(step, utime(step), {&state, actions});
}

/// For the next state; the controller has it when that comes.
bool PlannerRole::answer_newest(const robot_state_t& message, std::span<const Action> actions, bool held) {
  const RobotState state = to_signal(message);
  give_reference(state.step + 1, message.utime + step_utime(1, setup_.dt), {&state, actions, held});
  return true;
}

void PlannerRole::give_reference(int64_t step, int64_t at, const PlanInput& input) {
  std::vector<Event> events;
  const Reference reference = plan_(step, input, events);
  reference_t message{};
  to_message(reference, message);
  message.utime = at;
  message.run = run_;
  message.step = step;
  message.extras = static_cast<int32_t>(events.size());
  give(step, encoded(events, step, at), encode(message));
}

// ---- controller ---------------------------------------------------------------------------------------------

bool ControllerRole::can_handle(const StepRecord& record) const {
  return !due(record.step) || !record.reference.empty();
}

void ControllerRole::handle(const robot_state_t& state, const StepRecord& record,
                            std::span<const Action> actions) {
  pending_.insert(pending_.end(), actions.begin(), actions.end());
  if (!due(record.step)) return;
  decode(record.reference, reference_);
  give_command(state, std::exchange(pending_, {}));
}

void ControllerRole::keep(Channel channel, std::span<const uint8_t> bytes) {
  if (channel != Channel::Reference || (have_reference_ && peek_step(bytes) <= reference_.step)) return;
  decode(bytes, reference_);
  have_reference_ = true;
}

/// Silent without a reference that is fresh: then the simulator holds the robot.
bool ControllerRole::answer_newest(const robot_state_t& state, std::span<const Action> actions, bool) {
  pending_.insert(pending_.end(), actions.begin(), actions.end());
  if (!have_reference_ || state.step - reference_.step >= setup_.timeout) return false;
  if (commanded_ < 0 || state.step >= commanded_ + setup_.every)
    give_command(state, std::exchange(pending_, {}));
  return true;
}

void ControllerRole::give_command(const robot_state_t& state, std::span<const Action> actions) {
  std::vector<Event> events;
  const Command command = control_(to_signal(state), to_signal(reference_), actions, events);
  for (Eigen::Index i = 0; i < command.tau.size(); ++i)
    if (!std::isfinite(command.tau[i]))
      return fail(kSafety,
                  fmt::format("the effort for step {} is not finite: tau[{}] is {}; nothing was sent",
                              state.step, i, command.tau[i]));

  command_t message{};
  to_message(command, message);
  message.utime = state.utime;
  message.run = run_;
  message.step = state.step;
  message.state_step = state.step;
  message.reference_step = reference_.step;
  message.input_seq = state.input_seq;
  message.extras = static_cast<int32_t>(events.size());
  give(state.step, encoded(events, state.step, state.utime), encode(message));
  commanded_ = state.step;
}

}  // namespace lab
