#include "wire/protocol/follower.h"

#include <fmt/format.h>

#include <lab/need_t.hpp>
#include <lab/process_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {

void FollowerContext::publish_answer(const Answer& answer) const {
  for (const Bytes& event : answer.events) publish(Channel::Event, event);
  publish(answer_channel, answer.main);
}

void FollowerContext::request(int64_t step) const {
  need_t need{};
  need.run = run;
  need.step = step;
  need.process = kSimulator;
  need.sender = name;
  publish(Channel::Need, encode(need));
}

std::vector<Bytes> FollowerContext::encode_events(const std::vector<Event>& events, int64_t step,
                                                  int64_t utime) const {
  std::vector<Bytes> out;
  for (size_t i = 0; i < events.size(); ++i)
    out.push_back(encode(to_message(events[i], name, step, utime, run, static_cast<int64_t>(i))));
  return out;
}

FollowerRole::FollowerRole(std::string name, Channel answer, FollowerConfig config, BeginRun begin,
                           MakeFollowerRun make_run, Publish publish)
    : context_{std::move(name), answer, std::move(publish)},
      config_(std::move(config)),
      begin_(std::move(begin)),
      make_run_(std::move(make_run)) {}

std::string FollowerRole::state() const {
  if (context_.outcome.exit_code != kOk) return "FAULT";
  return run_ ? run_->state() : "STARTING";
}

void FollowerRole::receive(Channel channel, std::span<const uint8_t> bytes, Micros now) {
  if (context_.outcome.ended) return;
  switch (channel) {
    case Channel::Run:
      if (!run_) on_run(bytes, now);
      break;
    case Channel::Process:
      if (const auto process = decode<process_t>(bytes); process.name == kSimulator) {
        if (!run_) {
          retry_timer_.trigger(now);  // its RUN may have come before its address was known
          break;
        }
        context_.idle_timer.reset();
        run_->on_simulator_state(process.state);
      }
      break;
    case Channel::End:
      context_.outcome.ended = run_ != nullptr;
      break;
    default:
      if (run_) run_->receive(channel, bytes, now);
  }
}

void FollowerRole::on_run(std::span<const uint8_t> bytes, Micros now) {
  const auto message = decode<run_t>(bytes);
  try {
    context_.setup = begin_(message);
  } catch (const std::exception& error) {
    return context_.fail(kBadConfig, error.what());
  }
  context_.run = message.run;
  context_.idle_timer.reset();
  run_ = make_run_(context_);
  run_->start(config_.read_log, now);
}

void FollowerRole::tick(Micros now) {
  if (context_.outcome.ended) return;
  IdleTimer& idle_timer = context_.idle_timer;
  idle_timer.update(now);
  if (run_)
    run_->tick(now);
  else if (retry_timer_.expired(now))
    context_.request(kBeforeStart);
  if (!run_ && idle_timer.elapsed() > config_.ready_deadline)
    context_.fail(kNotReady,
                  fmt::format("no RUN from the simulator in {:g} s", config_.ready_deadline * 1e-6));
  else if (run_ && idle_timer.elapsed() > config_.deadline)
    context_.fail(kTransport, fmt::format("nothing from the simulator in {:g} s after step {}",
                                          config_.deadline * 1e-6, run_->next() - 1));
}

}  // namespace lab
