// Replays a run from its logged inputs: the true states behind the sensor values, and the energy that pushes, payloads
// and soft stops added or removed.
#pragma once
#include <map>
#include <span>
#include <vector>

#include "procs/simulator/simulator.h"

namespace lab::simulator {

/// All inputs of a run, by the step that they lead to.
struct SimulatorInputs {
  std::map<int64_t, Command> commands;  ///< new at that step
  std::map<int64_t, std::vector<Action>> actions;
};

/// The true states behind `logged` (from step 0 on, without gaps), by stepping the simulator through the inputs. Throws
/// std::runtime_error where a replayed sensor value differs from the logged one in any bit.
std::vector<RobotState> true_states(const Config&, std::span<const RobotState> logged,
                                    const SimulatorInputs&);

/// Energy that is not the nominal robot's own, one entry per state; empty without disturbances.
struct ExternalEnergy {
  std::vector<double> stored;  ///< J: of the payloads, and in the soft stops
  /// J, over the step to this state: work of pushes plus energy of new payloads minus losses in soft stops.
  std::vector<double> work;
};
/// `states` are the true ones, from step 0 on, without gaps (else the result is empty). Work of a torque and losses by
/// the trapezoidal rule, all else exact.
ExternalEnergy external_energy(const Config&, std::span<const RobotState> states, const SimulatorInputs&);

}  // namespace lab::simulator
