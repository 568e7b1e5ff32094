// Replays a run from its logged inputs: the true states behind what the sensors said, and the energy that pushes,
// payloads and soft stops brought or took.
#pragma once
#include <map>
#include <span>
#include <vector>

#include "procs/simulator/simulator.h"

namespace lab::simulator {

/// All inputs of a run, by the step that they led to.
struct SimulatorInputs {
  std::map<int64_t, Command> commands;  ///< new at that step
  std::map<int64_t, std::vector<Action>> actions;
};

/// The true states behind `logged` (from step 0 on, without gaps), by stepping the simulator through the inputs. Throws
/// std::runtime_error where the sensors' values differ from the logged ones in any bit.
std::vector<RobotState> true_states(const Config&, std::span<const RobotState> logged,
                                    const SimulatorInputs&);

/// Energy outside the nominal robot's own, one entry a state; empty when there is none.
struct ExternalEnergy {
  std::vector<double> stored;  ///< J: in what the robot carries, and in its soft stops
  /// J, over the step that led here: of pushes, brought by new payloads, less the soft stops' losses.
  std::vector<double> work;
};
/// `states` are the true ones, from step 0 on, without gaps (else the result is empty). Work of a torque and losses by
/// the trapezoidal rule, all else exact.
ExternalEnergy external_energy(const Config&, std::span<const RobotState> states, const SimulatorInputs&);

}  // namespace lab::simulator
