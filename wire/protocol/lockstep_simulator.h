// The simulator in lockstep: decides which step comes next and repairs lost messages.
#pragma once
#include <lab/command_t.hpp>
#include <map>
#include <string>

#include "wire/protocol/convert.h"
#include "wire/protocol/simulator_role.h"
#include "wire/protocol/step_record.h"

namespace lab {

/// The simulator in lockstep, the only sequencer and the only process that re-sends messages of others. Publishes
/// ROBOT_STATE k+1 once REFERENCE k and, when due, COMMAND k have arrived.
class LockstepSimulatorRole : public SimulatorRole {
 public:
  LockstepSimulatorRole(SimulatorConfig config, SimulateStep simulate, Publish publish);

  void refused(const Refusal& refusal, Micros now) override;
  void tick(Micros now) override;

 private:
  void on_message(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void on_ack(const std::string& process, int64_t complete_to) override;
  void on_need(int64_t step, Micros now) override;
  void on_input(int64_t step, const Bytes& input) override {
    ring_.at(step).store(Channel::Input, input, false);
  }
  void begin(Micros now) override;
  void take_due_steps(Micros now) override;
  Micros next_wake() const override { return retry_timer_.due(); }
  int64_t utime(int64_t step) const override { return step_utime(step, config_.dt); }
  int64_t digest_of_last() override;
  std::span<const uint8_t> newest_reference() override;

  void file(Channel channel, std::span<const uint8_t> bytes);
  bool answered(int64_t step);
  bool has_credit(int64_t step) const;
  bool publish_state(int64_t step, Micros now);
  void ask_for_answers();
  std::string missing_answer();
  bool command_due(int64_t step) const { return step % config_.every == 0; }
  void resend(const StepRecord& record);

  StepRing ring_{2 * kWindow};
  std::map<std::string, int64_t> acks_;
  std::string last_refusal_;
  RetryTimer retry_timer_;
  int asked_ = 0;
  std::map<int64_t, Micros> resent_;  ///< when a step was last re-sent
  command_t command_;                 ///< a member to reuse its memory
};

}  // namespace lab
