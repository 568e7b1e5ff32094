#pragma once
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "lab/signals/signals.h"
#include "wire/protocol/role.h"
#include "wire/protocol/step_record.h"

namespace lab {

/// What a follower learns from RUN.
struct RunSetup {
  int64_t model_hash = 0;
  int nq = 0, nv = 0;
  double dt = 0;
  int64_t last_step = 0, lead = 0, every = 1;
  bool realtime = false;
  int64_t timeout = 0;  ///< real time: steps after which a reference is too old to follow
};
/// Makes a process ready for a run: loads the model, reads the experiment. Throws std::exception with one clear line.
using BeginRun = std::function<RunSetup(const run_t&)>;
/// Calls visit for each message of the whole steps of the run's log so far, in the log's order. May do nothing.
using ReadLog =
    std::function<void(int64_t run, const std::function<void(Channel, std::span<const uint8_t>)>& visit)>;

struct FollowerConfig {
  Micros deadline = 10'000'000, ready_deadline = 10'000'000;
  ReadLog read_log;  ///< lets the process join a run again after a restart; may be empty
};

/// What the planner and the controller have in common: they take ROBOT_STATE in the order of steps, each with every
/// INPUT up to its input_seq, give one message per step, and keep what they gave as long as it may be asked for.
class FollowerRole : public Role {
 public:
  FollowerRole(std::string name, Channel answer, FollowerConfig config, BeginRun begin, Publish publish);

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void tick(Micros now) override;
  Micros wake() const override { return setup_.realtime && newest_.empty() ? INT64_MAX : retry_timer_.due(); }
  Micros batch() const override { return setup_.realtime ? kNoSpin : 0; }
  int urgency() const override { return setup_.realtime ? 2 : 0; }
  void stop(Micros) override { outcome_.ended = true; }

  const Outcome& outcome() const override { return outcome_; }
  std::string state() const override;
  int64_t step() const override { return next_ - 1; }
  int64_t run() const override { return run_; }
  int64_t model_hash() const override { return setup_.model_hash; }
  int nq() const override { return setup_.nq; }
  int nv() const override { return setup_.nv; }

 protected:
  /// Called once when RUN is known, before any state.
  virtual void begin() {}
  /// True when nothing but ROBOT_STATE and INPUT is missing to handle this step.
  virtual bool can_handle(const StepRecord&) const { return true; }
  /// Handles one step: `actions` are the INPUTs applied since the step before.
  virtual void handle(const robot_state_t& state, const StepRecord& record,
                      std::span<const Action> actions) = 0;

  /// Real time: answers the newest state; false if it cannot, such as without a reference. `held`: the simulator holds
  /// the robot.
  virtual bool answer_newest(const robot_state_t& state, std::span<const Action> actions, bool held) = 0;
  /// Real time: keeps what else is needed.
  virtual void keep(Channel, std::span<const uint8_t>) {}

  /// Publishes the answer for `step` (events first) and keeps it.
  void give(int64_t step, std::vector<Bytes> events, Bytes main);
  void fail(int exit_code, const std::string& reason);
  int64_t utime(int64_t step) const;
  /// The EVENT messages of a step whose time is `at`.
  std::vector<Bytes> encoded(const std::vector<Event>& events, int64_t step, int64_t at) const;

  const std::string name_;
  RunSetup setup_;
  int64_t run_ = 0;

 private:
  struct Answer {
    int64_t step = -1;
    std::vector<Bytes> events;
    Bytes main;
    Micros resent = 0;
  };
  void on_run(std::span<const uint8_t> bytes, Micros now);
  void file(Channel channel, std::span<const uint8_t> bytes, Micros now);
  void handle_while_possible(Micros now);
  void receive_in_real_time(Channel channel, std::span<const uint8_t> bytes, Micros now);
  void answer_in_real_time(Micros now);
  std::vector<Action> take_inputs_to(int64_t seq);
  bool inputs_complete_to(int64_t seq) const;
  void ask(int64_t step);
  void publish(const Answer& answer);

  const Channel answer_channel_;
  FollowerConfig config_;
  BeginRun begin_;
  Publish publish_;
  Outcome outcome_;

  int64_t next_ = 0;       ///< the step to handle next
  int64_t input_seq_ = 0;  ///< last INPUT applied
  int64_t gap_at_ = -1;    ///< the step for which a gap has already been noticed
  bool folding_ = false;   ///< catching up from the log: answers are kept, not published
  StepRing ring_{2 * kWindow};
  std::map<int64_t, Bytes> inputs_;  ///< by number, not yet applied
  std::vector<Answer> answers_;
  robot_state_t state_;  ///< the one in hand; kept for its memory
  Bytes newest_;         ///< real time: the newest ROBOT_STATE, until it is answered
  Micros answered_at_ = 0;
  bool held_ = true;  ///< real time: the simulator is not RUNNING, by its PROCESS
  bool idle_ = true;  ///< real time: the newest state could not be answered, or none has come for long
  RetryTimer retry_timer_;
  IdleTimer idle_timer_;
};

/// What a reference is made from.
struct PlanInput {
  const RobotState* state = nullptr;  ///< newest; null before the first
  std::span<const Action> actions{};
  bool held = false;  ///< real time: the simulator holds the robot
};
/// Makes the reference for one step. Events say what is worth a line in the log.
using PlanStep = std::function<Reference(int64_t step, const PlanInput& input, std::vector<Event>& events)>;
/// Makes the effort for one state.
using ControlStep = std::function<Command(const RobotState& state, const Reference& reference,
                                          std::span<const Action> actions, std::vector<Event>& events)>;

/// REFERENCE 0..lead-1 on RUN, then REFERENCE k + lead on ROBOT_STATE k.
class PlannerRole : public FollowerRole {
 public:
  PlannerRole(FollowerConfig config, BeginRun begin, PlanStep plan, Publish publish)
      : FollowerRole(kPlanner, Channel::Reference, std::move(config), std::move(begin), std::move(publish)),
        plan_(std::move(plan)) {}

  /// References far ahead leave time to make several at once.
  Micros batch() const override { return setup_.realtime ? kNoSpin : setup_.lead >= 16 ? 100 : 0; }
  int urgency() const override { return setup_.realtime ? 1 : 0; }

 private:
  void begin() override;
  void handle(const robot_state_t& state, const StepRecord& record, std::span<const Action> actions) override;
  bool answer_newest(const robot_state_t& state, std::span<const Action> actions, bool held) override;
  void give_reference(int64_t step, int64_t at, const PlanInput& input);
  PlanStep plan_;
};

/// COMMAND k from ROBOT_STATE k and REFERENCE k, at every step that `every` divides.
class ControllerRole : public FollowerRole {
 public:
  ControllerRole(FollowerConfig config, BeginRun begin, ControlStep control, Publish publish)
      : FollowerRole(kController, Channel::Command, std::move(config), std::move(begin), std::move(publish)),
        control_(std::move(control)) {}

 private:
  bool due(int64_t step) const { return step % setup_.every == 0; }
  bool can_handle(const StepRecord& record) const override;
  void handle(const robot_state_t& state, const StepRecord& record, std::span<const Action> actions) override;
  bool answer_newest(const robot_state_t& state, std::span<const Action> actions, bool held) override;
  void keep(Channel channel, std::span<const uint8_t> bytes) override;
  void give_command(const robot_state_t& state, std::span<const Action> actions);
  ControlStep control_;
  reference_t reference_;  ///< the one in use
  bool have_reference_ = false;
  int64_t commanded_ = -1;       ///< step of the last command
  std::vector<Action> pending_;  ///< INPUTs of steps at which no COMMAND was due
};

}  // namespace lab
