// Whether the robot may follow its controller: a state machine over steps, without clock. docs/safety.md has its
// table. simulator.cc turns holding into efforts.
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
  Holding,  ///< the controller was lost, or moved a joint too fast: held until `prove` fresh commands, or rearm
  Stopped,  ///< emergency stop: held until `rearm`
};

struct Config {
  int64_t timeout =
      0;  ///< steps after which a command is stale; 0 = no watchdog: lockstep waits for every command
  bool manual = false;  ///< only a person ends Holding
  int64_t prove = 20;   ///< fresh commands in a row that end Holding
};

struct State {
  Mode mode = Mode::Waiting;
  bool armed = true;    ///< Holding may end by itself
  int64_t newest = -1;  ///< state that the newest fresh command was made from
  int64_t proven = 0;   ///< fresh commands in a row
};

/// Without a watchdog every command is waited for, so the robot runs from the start.
inline State initial(const Config& config) {
  return {.mode = config.timeout > 0 ? Mode::Waiting : Mode::Running};
}

struct Input {
  int64_t step = 0;                     ///< that the effort leads to
  std::optional<int64_t> command_from;  ///< state of a new, valid command
  bool estop = false, rearm = false;    ///< actions of a person
};

/// True if a command made from that state is newer than all before it and not older than the timeout.
bool fresh(const Config&, const State&, int64_t step, int64_t command_from);

/// The mode for this step. Events say what has changed and why.
Mode step(const Config&, State&, const Input&, std::vector<Event>& events);

/// The command in force would break a bound: Running becomes Holding.
void trip(const Config&, State&, const std::string& who, const std::string& why, std::vector<Event>& events);

/// As in PROCESS: RUNNING, HOLDING, FAULT.
const char* name(Mode);

}  // namespace lab::safety
