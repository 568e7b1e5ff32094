// The planner or the controller in lockstep: answers every step in order, whatever the load or the losses.
#pragma once
#include <vector>

#include "wire/protocol/follower.h"
#include "wire/protocol/step_record.h"

namespace lab {

/// Takes ROBOT_STATE in the order of steps, each with every INPUT up to its input_seq, gives one answer per step, and
/// stores answers as long as they may be asked for.
class LockstepFollower : public FollowerRun {
 public:
  explicit LockstepFollower(FollowerContext& context);

  void start(const ReadLog& read_log, Micros now) override;
  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void tick(Micros now) override;
  Micros wake() const override { return retry_timer_.due(); }
  Micros batch() const override { return 0; }
  int urgency() const override { return 0; }
  std::string state() const override;

 protected:
  /// Called once, before any state.
  virtual void begin() {}
  /// True when nothing but ROBOT_STATE and INPUT is missing to handle this step.
  virtual bool can_handle(const StepRecord&) const { return true; }
  /// Handles one step: `actions` are the INPUTs applied since the step before.
  virtual void handle(const robot_state_t& state, const StepRecord& record,
                      std::span<const Action> actions) = 0;

  /// Publishes an answer and stores it.
  void publish_answer(Answer answer);

 private:
  struct Stored {
    Answer answer;
    Micros resent = 0;  ///< when it was last re-sent
  };
  void file(Channel channel, std::span<const uint8_t> bytes, Micros now);
  void handle_while_possible(Micros now);
  void resend(int64_t step, Micros now);

  StepRing ring_{2 * kWindow};
  std::vector<Stored> stored_;  ///< ring of the last answers, by step
  int64_t gap_at_ = -1;         ///< the step for which a gap was already noticed
  bool catching_up_ = false;    ///< from the log: answers are stored, not published
};

}  // namespace lab
