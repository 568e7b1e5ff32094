#pragma once
#include <memory>

#include "procs/experiment/experiment.h"
#include "procs/experiment/robot.h"
#include "procs/wire/sequencer.h"

namespace lab::simulator {

/// The simulator's step as the sequencer of a lockstep run. Throws ExperimentError.
std::unique_ptr<Sequencer> make_role(const Experiment& experiment, const Robot& robot, int64_t nonce, Publish publish);

}  // namespace lab::simulator
