#pragma once
#include <lab/command_t.hpp>
#include <map>
#include <string>

#include "wire/protocol/convert.h"
#include "wire/protocol/leader.h"
#include "wire/protocol/step_record.h"

namespace lab {

/// The simulator's side of lockstep: the only one that decides which step comes next, and the only one that repairs
/// what others missed. Publishes ROBOT_STATE k+1 once REFERENCE k and, when due, COMMAND k are here.
class Sequencer : public Leader {
 public:
  Sequencer(LeaderConfig config, AdvanceStep advance, Publish publish);

  void refused(const Refusal& refusal, Micros now) override;
  void tick(Micros now) override;

 private:
  void on_message(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void on_ack(const std::string& process, int64_t complete_to) override;
  void on_need(int64_t step, Micros now) override;
  void on_input(int64_t step, const Bytes& input) override {
    ring_.at(step).file(Channel::Input, input, false);
  }
  void begin(Micros now) override;
  void go_on(Micros now) override;
  Micros next_look() const override { return patience_.due(); }
  int64_t utime(int64_t step) const override { return step_utime(step, config_.dt); }
  int64_t digest_of_last() override;

  void file(Channel channel, std::span<const uint8_t> bytes);
  bool answered(int64_t step);
  bool credit_for(int64_t step) const;
  bool publish_state(int64_t step, Micros now);
  void ask_for_answers();
  std::string silent_party();
  bool command_due(int64_t step) const { return step % config_.every == 0; }
  void resend(const StepRecord& record);

  StepRing ring_{2 * kWindow};
  std::map<std::string, int64_t> acks_;
  std::string last_refusal_;
  Patience patience_;
  int asked_ = 0;
  std::map<int64_t, Micros> resent_;  ///< when a step was last sent again
  command_t command_;                 ///< kept for its memory
};

}  // namespace lab
