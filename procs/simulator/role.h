// The simulator as the leader of a run, in lockstep or in real time.
#pragma once
#include <memory>

#include "lab/experiment/experiment.h"
#include "lab/experiment/robot.h"
#include "wire/protocol/simulator_role.h"

namespace lab::simulator {

/// The simulator's step in the role for the experiment's clock: lockstep or real time. Throws ExperimentError.
std::unique_ptr<SimulatorRole> make_role(const Experiment& experiment, const Robot& robot, int64_t nonce,
                                         Publish publish);

}  // namespace lab::simulator
