// The simulator in real time: one step per tick of an absolute time grid.
#pragma once
#include <lab/command_t.hpp>
#include <string>
#include <vector>

#include "wire/protocol/lateness.h"
#include "wire/protocol/simulator_role.h"

namespace lab {

/// The simulator in real time: takes a step at every tick of an absolute grid, with the newest command. It waits for no
/// message and re-sends only RUN and INPUT. Late ticks are caught up at once; after a standstill of more than kSlip the
/// grid is shifted instead, with an EVENT.
class RealtimeSimulatorRole : public SimulatorRole {
 public:
  using SimulatorRole::SimulatorRole;
  static constexpr Micros kSlip = 100'000;

  void refused(const Refusal& refusal, Micros now) override;
  Micros batch() const override { return kNoSpin; }
  int urgency() const override { return 3; }
  const Lateness* lateness() const override { return &lateness_; }
  int64_t overruns() const override { return overruns_; }  ///< ticks later than one period

 private:
  void on_message(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void on_need(int64_t step, Micros now) override;
  void on_input(int64_t, const Bytes& input) override { inputs_.push_back(input); }
  void on_resume(Micros now) override { start_grid(now); }
  void on_reset(const std::string& sender) override;
  void begin(Micros now) override;
  void take_due_steps(Micros now) override;
  Micros next_wake() const override { return due(published_ + 1); }
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
  std::vector<Event> noticed_;        ///< events for the next state
  int64_t refused_at_ = -1'000'000;   ///< step of the last EVENT about a refused command
  std::vector<Bytes> inputs_;         ///< all of them, for processes that restart
  Lateness lateness_;
  int64_t overruns_ = 0;
};

}  // namespace lab
