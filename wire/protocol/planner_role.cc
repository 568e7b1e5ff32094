#include "wire/protocol/planner_role.h"

#include <lab/reference_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/protocol/lockstep_follower.h"
#include "wire/protocol/realtime_follower.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

/// REFERENCE for `step`, whose time is `utime`, with its events.
Answer make_reference(const FollowerContext& context, const PlanStep& plan, int64_t step, int64_t utime,
                      const PlanInput& input) {
  std::vector<Event> events;
  const Reference reference = plan(step, input, events);
  reference_t message{};
  to_message(reference, message);
  message.utime = utime;
  message.run = context.run;
  message.step = step;
  message.extras = static_cast<int32_t>(events.size());
  return {step, context.encode_events(events, step, utime), encode(message)};
}

class LockstepPlanner : public LockstepFollower {
 public:
  LockstepPlanner(FollowerContext& context, PlanStep plan)
      : LockstepFollower(context), plan_(std::move(plan)) {}

  /// A long lead leaves time to make several references per wake-up.
  Micros batch() const override { return setup().lead >= 16 ? 100 : 0; }

 private:
  void begin() override {
    for (int64_t step = 0; step < setup().lead && step <= setup().last_step; ++step)
      publish_reference(step, {});
  }
  void handle(const robot_state_t& message, const StepRecord& record,
              std::span<const Action> actions) override {
    const RobotState state = to_signal(message);
    const int64_t step = record.step + setup().lead;
    if (step <= setup().last_step) publish_reference(step, {&state, actions});
  }
  void publish_reference(int64_t step, const PlanInput& input) {
    LockstepFollower::publish_answer(
        make_reference(context_, plan_, step, step_utime(step, setup().dt), input));
  }
  PlanStep plan_;
};

class RealtimePlanner : public RealtimeFollower {
 public:
  RealtimePlanner(FollowerContext& context, PlanStep plan)
      : RealtimeFollower(context), plan_(std::move(plan)) {}

  int urgency() const override { return 1; }

 private:
  /// The reference is for the next state: the controller has it when that state comes.
  bool answer(const robot_state_t& message, std::span<const Action> actions) override {
    const RobotState state = to_signal(message);
    const int64_t utime = message.utime + step_utime(1, setup().dt);
    context_.publish_answer(
        make_reference(context_, plan_, state.step + 1, utime, {&state, actions, held()}));
    return true;
  }
  PlanStep plan_;
};

}  // namespace

PlannerRole::PlannerRole(FollowerConfig config, BeginRun begin, PlanStep plan, Publish publish)
    : FollowerRole(
          kPlanner, Channel::Reference, std::move(config), std::move(begin),
          [plan = std::move(plan)](FollowerContext& context) -> std::unique_ptr<FollowerRun> {
            if (context.setup.realtime) return std::make_unique<RealtimePlanner>(context, plan);
            return std::make_unique<LockstepPlanner>(context, plan);
          },
          std::move(publish)) {}

}  // namespace lab
