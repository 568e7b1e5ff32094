#include "procs/wire/follower.h"

#include <fmt/format.h>

#include <lab/command_t.hpp>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>

#include "procs/wire/codec.h"
#include "procs/wire/convert.h"

namespace lab {

Follower::Follower(std::string name, Channel answer, FollowerConfig config, BeginRun begin, Publish publish)
    : name_(std::move(name)),
      answer_channel_(answer),
      config_(std::move(config)),
      begin_(std::move(begin)),
      publish_(std::move(publish)) {}

std::string Follower::state() const {
  if (outcome_.exit_code != kOk) return "FAULT";
  if (run_ == 0 || folding_) return "STARTING";
  return next_ == 0 ? "READY" : "RUNNING";
}

int64_t Follower::utime(int64_t step) const { return step_utime(step, setup_.dt); }

void Follower::fail(int exit_code, const std::string& reason) { outcome_ = {true, exit_code, reason}; }

void Follower::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  if (outcome_.ended) return;
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
      if (decode<process_t>(bytes).name == kSimulator) silence_.progress();
      break;
    case Channel::End: outcome_.ended = run_ != 0; break;
    default: break;
  }
}

void Follower::on_run(std::span<const uint8_t> bytes, Micros now) {
  const auto message = decode<run_t>(bytes);
  try {
    setup_ = begin_(message);
  } catch (const std::exception& error) {
    return fail(kBadConfig, error.what());
  }
  run_ = message.run;
  answers_.resize(std::max(setup_.lead, setup_.every) + 2);
  patience_.reset(now);
  folding_ = static_cast<bool>(config_.read_log);
  begin();
  if (folding_) {
    config_.read_log(run_, [&](Channel channel, std::span<const uint8_t> logged) {
      if (channel == Channel::RobotState || channel == Channel::Reference || channel == Channel::Input) receive(channel, logged, now);
    });
    folding_ = false;
    for (const Answer& kept : answers_)
      if (kept.step >= 0) publish(kept);
  }
}

void Follower::file(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  silence_.progress();
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
  const bool gap = channel == Channel::RobotState && step > next_ && hurried_ != next_;
  if (gap) hurried_ = next_, patience_.hurry(now);
}

bool Follower::inputs_complete_to(int64_t seq) const {
  for (int64_t i = input_seq_ + 1; i <= seq; ++i)
    if (!inputs_.contains(i)) return false;
  return true;
}

void Follower::handle_while_possible(Micros now) {
  while (!outcome_.ended) {
    const StepRecord* record = ring_.find(next_);
    if (!record || record->state.empty() || !can_handle(*record)) return;
    decode(record->state, state_);
    if (!inputs_complete_to(state_.input_seq)) return;
    std::vector<Action> actions;
    while (input_seq_ < state_.input_seq) {
      const auto node = inputs_.extract(++input_seq_);
      actions.push_back(to_signal(decode<input_t>(node.mapped()).action));
    }
    ++next_;
    handle(state_, *record, actions);
    patience_.reset(now);
  }
}

void Follower::give(int64_t step, std::vector<Bytes> events, Bytes main) {
  Answer& kept = answers_[step % answers_.size()];
  kept = {step, std::move(events), std::move(main), 0};
  if (!folding_) publish(kept);
}

void Follower::publish(const Answer& answer) {
  for (const Bytes& event : answer.events) publish_(Channel::Event, event);
  publish_(answer_channel_, answer.main);
}

void Follower::ask(int64_t step) {
  need_t need{};
  need.run = run_, need.step = step, need.process = kSimulator, need.sender = name_;
  publish_(Channel::Need, encode(need));
}

void Follower::tick(Micros now) {
  if (outcome_.ended) return;
  silence_.look(now);
  if (patience_.expired(now)) ask(run_ == 0 ? kBeforeStart : next_);
  if (run_ == 0 && silence_.total() > config_.ready_deadline)
    fail(kNotReady, fmt::format("no RUN from the simulator in {:g} s", config_.ready_deadline * 1e-6));
  else if (run_ != 0 && silence_.total() > config_.deadline)
    fail(kTransport, fmt::format("nothing from the simulator in {:g} s after step {}", config_.deadline * 1e-6, next_ - 1));
}

// ---- planner ------------------------------------------------------------------------------------------------

void PlannerRole::begin() {
  for (int64_t step = 0; step < setup_.lead && step <= setup_.last_step; ++step) give_reference(step, {});
}

void PlannerRole::handle(const robot_state_t&, const StepRecord& record, std::span<const Action> actions) {
  if (record.step + setup_.lead <= setup_.last_step) give_reference(record.step + setup_.lead, actions);
}

void PlannerRole::give_reference(int64_t step, std::span<const Action> actions) {
  std::vector<Event> events;
  const Reference reference = plan_(step, actions, events);
  reference_t message{};
  to_message(reference, message);
  message.utime = utime(step), message.run = run_, message.step = step;
  message.extras = static_cast<int32_t>(events.size());
  std::vector<Bytes> extras;
  for (size_t i = 0; i < events.size(); ++i)
    extras.push_back(encode(to_message(events[i], name_, step, utime(step), run_, static_cast<int64_t>(i))));
  give(step, std::move(extras), encode(message));
}

// ---- controller ---------------------------------------------------------------------------------------------

bool ControllerRole::can_handle(const StepRecord& record) const { return !due(record.step) || !record.reference.empty(); }

void ControllerRole::handle(const robot_state_t& state, const StepRecord& record, std::span<const Action> actions) {
  pending_.insert(pending_.end(), actions.begin(), actions.end());
  if (!due(record.step)) return;
  std::vector<Event> events;
  decode(record.reference, reference_);
  const Command command = control_(to_signal(state), to_signal(reference_), pending_, events);
  pending_.clear();
  for (Eigen::Index i = 0; i < command.tau.size(); ++i)
    if (!std::isfinite(command.tau[i]))
      return fail(kSafety, fmt::format("the effort for step {} is not finite: tau[{}] is {}; nothing was sent", record.step, i, command.tau[i]));

  command_t message{};
  to_message(command, message);
  message.utime = utime(record.step), message.run = run_, message.step = record.step;
  message.state_step = message.reference_step = record.step;
  message.input_seq = state.input_seq;
  message.extras = static_cast<int32_t>(events.size());
  std::vector<Bytes> extras;
  for (size_t i = 0; i < events.size(); ++i)
    extras.push_back(encode(to_message(events[i], name_, record.step, utime(record.step), run_, static_cast<int64_t>(i))));
  give(record.step, std::move(extras), encode(message));
}

}  // namespace lab
