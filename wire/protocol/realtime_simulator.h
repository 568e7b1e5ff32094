// The simulator in real time: one step per tick of an absolute time grid.
#pragma once
#include <lab/command_t.hpp>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "wire/protocol/lateness.h"
#include "wire/protocol/simulator_role.h"

namespace lab {

/// How often strangers become an EVENT: one a second each, ten a second in all.
class StrangerLimit {
 public:
  bool allows(const std::string& who, Micros now);

 private:
  std::map<std::string, Micros> last_;
  Micros second_ = INT64_MIN / 2;  ///< when the present second began
  int count_ = 0;                  ///< in it
};

/// The simulator in real time: takes a step at every tick of an absolute grid, with the newest command. It waits for no
/// message and re-sends only RUN and INPUT. Late ticks are caught up at once; after a standstill of more than kSlip the
/// grid is shifted instead, with an EVENT.
class RealtimeSimulatorRole : public SimulatorRole {
 public:
  using SimulatorRole::SimulatorRole;
  static constexpr Micros kSlip = 100'000;
  static constexpr int kStepsPerTick = 16;  ///< so that messages are read in between, an estop above all
  static constexpr int kInputsPerTick = 8;  ///< re-sent
  static constexpr size_t kMaxKept = 1024;  ///< INPUTs that may be asked for again

  void refused(const Refusal& refusal, Micros now) override;
  void stranger(Channel channel, const std::string& reason, Micros now) override;
  void tick(Micros now) override;
  Micros batch() const override { return kNoSpin; }
  int urgency() const override { return 3; }
  const Lateness* lateness() const override { return &lateness_; }
  int64_t overruns() const override { return overruns_; }  ///< ticks later than one period

 private:
  void on_message(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void on_need(int64_t step, Micros now) override;
  void on_input(int64_t step, const Bytes& input) override;
  void on_resume(Micros now) override { start_grid(now); }
  void on_reset(const std::string& sender) override;
  void begin(Micros now) override;
  void take_due_steps(Micros now) override;
  std::span<const uint8_t> newest_reference() override { return reference_; }
  Micros next_wake() const override { return paused_ && single_steps_ > 0 ? 0 : due(published_ + 1); }
  int64_t utime(int64_t step) const override { return due(step) + config_.wall_offset; }

  Micros due(int64_t step) const {
    return grid_start_ + std::llround(static_cast<double>(step - grid_step_) * config_.dt * 1e6);
  }
  void start_grid(Micros now);
  void take_step(Micros now);
  static command_t no_command() {
    command_t command{};
    command.state_step = -1;
    return command;
  }

  int64_t grid_step_ = 0;  ///< the step that is due at grid_start_
  Micros grid_start_ = 0;
  bool fresh_ = false;                ///< command_ has not been used
  command_t command_ = no_command();  ///< the newest
  Bytes reference_;                   ///< the newest
  std::vector<Event> noticed_;        ///< events for the next state
  int64_t refused_at_ = -1'000'000;   ///< step of the last EVENT about a refused command
  /// The INPUTs that still count, for processes that restart: a later one of the same verb, target and key replaces an
  /// earlier one.
  std::map<int64_t, Bytes> kept_;  ///< by input_seq
  std::map<std::tuple<std::string, std::string, std::string>, int64_t> kept_seq_;
  int64_t resend_from_ = INT64_MAX;  ///< input_seq from which they are being re-sent
  StrangerLimit strangers_;
  Lateness lateness_;
  int64_t overruns_ = 0;
};

}  // namespace lab
