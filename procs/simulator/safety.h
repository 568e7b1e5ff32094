// Decides whether commands may move the robot: a state machine that counts steps and reads no clock. docs/safety.md
// has its diagram. simulator.cc computes the effort that holds the robot, and checks effort and speed limits.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lab/signals/signals.h"

namespace lab::safety {

enum class Mode {
  Waiting,  ///< no command yet: held
  Running,  ///< the newest command is in force
  Holding,  ///< no fresh command, or a joint would be too fast: held until `fresh_to_resume` fresh commands, or rearm
  Stopped,  ///< emergency stop: held until `rearm`
};

struct Config {
  int64_t timeout =
      0;  ///< steps after which a command is stale; 0 = no watchdog: lockstep waits for every command
  bool manual = false;           ///< Holding ends only after `rearm`
  int64_t fresh_to_resume = 20;  ///< fresh commands in a row that end Holding
};

struct State {
  Mode mode = Mode::Waiting;
  bool armed = true;           ///< no `rearm` is needed (any more)
  int64_t newest = -1;         ///< state that the newest fresh command was computed from
  int64_t fresh_in_a_row = 0;  ///< fresh commands in a row
};

/// Without a watchdog (lockstep) the simulator waits for every command, so the robot runs from the start.
inline State initial(const Config& config) {
  return {.mode = config.timeout > 0 ? Mode::Waiting : Mode::Running};
}

struct Input {
  int64_t step = 0;                     ///< the step that this effort leads to
  std::optional<int64_t> command_from;  ///< state that a new, valid command was computed from
  bool estop = false, rearm = false;    ///< requests of the operator
};

/// True if a command computed from that state is newer than all before it and younger than the timeout.
bool fresh(const Config&, const State&, int64_t step, int64_t command_from);

/// The mode for this step. Events say what has changed and why.
Mode step(const Config&, State&, const Input&, std::vector<Event>& events);

/// Running becomes Holding, because the current command would exceed a limit.
void trip(const Config&, State&, const std::string& who, const std::string& why, std::vector<Event>& events);

/// As in PROCESS: RUNNING, HOLDING, FAULT.
const char* name(Mode);

}  // namespace lab::safety
