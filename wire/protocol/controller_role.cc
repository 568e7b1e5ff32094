#include "wire/protocol/controller_role.h"

#include <fmt/format.h>

#include <cmath>
#include <lab/command_t.hpp>
#include <lab/reference_t.hpp>
#include <optional>

#include "wire/protocol/convert.h"
#include "wire/protocol/lockstep_follower.h"
#include "wire/protocol/realtime_follower.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

/// COMMAND for a state, with its events; none and a safety stop when the effort is not finite.
std::optional<Answer> make_command(FollowerContext& context, const ControlStep& control,
                                   const robot_state_t& state, const reference_t& reference,
                                   std::span<const Action> actions) {
  std::vector<Event> events;
  const Command command = control(to_signal(state), to_signal(reference), actions, events);
  for (Eigen::Index i = 0; i < command.tau.size(); ++i) {
    if (std::isfinite(command.tau[i])) continue;
    context.fail(kSafety, fmt::format("the effort for step {} is not finite: tau[{}] is {}; nothing was sent",
                                      state.step, i, command.tau[i]));
    return std::nullopt;
  }
  command_t message{};
  to_message(command, message);
  message.utime = state.utime;
  message.run = context.run;
  message.step = state.step;
  message.state_step = state.step;
  message.reference_step = reference.step;
  message.input_seq = state.input_seq;
  message.extras = static_cast<int32_t>(events.size());
  return Answer{state.step, context.encode_events(events, state.step, state.utime), encode(message)};
}

class LockstepController : public LockstepFollower {
 public:
  LockstepController(FollowerContext& context, ControlStep control)
      : LockstepFollower(context), control_(std::move(control)) {}

 private:
  bool due(int64_t step) const { return step % setup().every == 0; }
  bool can_handle(const StepRecord& record) const override {
    return !due(record.step) || !record.reference.empty();
  }
  void handle(const robot_state_t& state, const StepRecord& record,
              std::span<const Action> actions) override {
    pending_.insert(pending_.end(), actions.begin(), actions.end());
    if (!due(record.step)) return;
    decode(record.reference, reference_);
    if (auto command = make_command(context_, control_, state, reference_, std::exchange(pending_, {})))
      publish_answer(std::move(*command));
  }

  ControlStep control_;
  reference_t reference_;        ///< a member to reuse its memory
  std::vector<Action> pending_;  ///< INPUTs of steps at which no COMMAND was due
};

class RealtimeController : public RealtimeFollower {
 public:
  RealtimeController(FollowerContext& context, ControlStep control)
      : RealtimeFollower(context), control_(std::move(control)) {}

  int urgency() const override { return 2; }

 private:
  void receive_other(Channel channel, std::span<const uint8_t> bytes) override {
    if (channel != Channel::Reference || (have_reference_ && peek_step(bytes) <= reference_.step)) return;
    decode(bytes, reference_);
    have_reference_ = true;
  }
  /// Sends nothing without a fresh reference: then the simulator holds the robot.
  bool answer(const robot_state_t& state, std::span<const Action> actions) override {
    pending_.insert(pending_.end(), actions.begin(), actions.end());
    if (!have_reference_ || state.step - reference_.step >= setup().timeout) return false;
    if (commanded_ >= 0 && state.step < commanded_ + setup().every) return true;
    const auto command = make_command(context_, control_, state, reference_, std::exchange(pending_, {}));
    if (!command) return true;
    context_.publish_answer(*command);
    commanded_ = state.step;
    return true;
  }

  ControlStep control_;
  reference_t reference_;  ///< the newest
  bool have_reference_ = false;
  int64_t commanded_ = -1;       ///< step of the last command
  std::vector<Action> pending_;  ///< INPUTs of states without a command
};

}  // namespace

ControllerRole::ControllerRole(FollowerConfig config, BeginRun begin, ControlStep control, Publish publish)
    : FollowerRole(
          kController, Channel::Command, std::move(config), std::move(begin),
          [control = std::move(control)](FollowerContext& context) -> std::unique_ptr<FollowerRun> {
            if (context.setup.realtime) return std::make_unique<RealtimeController>(context, control);
            return std::make_unique<LockstepController>(context, control);
          },
          std::move(publish)) {}

}  // namespace lab
