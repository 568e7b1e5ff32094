#pragma once
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "procs/simulator/simulator.h"

/// A run seen from behind: what its log leaves out but its commands imply.
namespace lab::simulator {

/// What the simulator was told, by the step that it led to.
struct Told {
  std::map<int64_t, Command> commands;  ///< new at that step
  std::map<int64_t, std::vector<Action>> actions;
};

/// The true states behind `logged` (from step 0 on, without gaps): the step, folded over what it was told. Throws
/// std::runtime_error where what the sensors would have said is not what was logged, to the last bit.
std::vector<RobotState> true_states(const Config&, std::span<const RobotState> logged, const Told&);

/// The energy that the nominal robot's own figures do not show, one entry a state; empty when there is none.
struct Ledger {
  std::vector<double> stored;  ///< J: in what the robot carries, and in its soft stops
  std::vector<double>
      work;  ///< J, over the step that led here: of pushes, brought by new payloads, less what the stops took
};
/// `states` are the true ones, from step 0 on, without gaps (else the ledger is empty). Work of a torque and losses by
/// the trapezoidal rule, all else exact.
Ledger ledger(const Config&, std::span<const RobotState> states, const Told&);

}  // namespace lab::simulator
