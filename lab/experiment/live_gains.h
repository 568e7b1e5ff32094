// Where a gain changes live: `set controller KEY=..` is checked by gain_fault and carried out by set_gain. The gains
// themselves are the table in gains.h.
#pragma once
#include <rbd/model/model.h>

#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/experiment/gains.h"
#include "lab/signals/signals.h"

namespace lab {

using LiveGains = GainValues<Eigen::VectorXd>;

/// The experiment's. Throws ExperimentError for values that do not fit the model.
LiveGains live_gains(const Experiment&, const rbd::Model&);

/// kp, kd, ..: as `set controller` names them.
std::vector<std::string> gain_keys();

/// Why these numbers cannot be this gain; empty if they can.
std::string gain_fault(const rbd::Model&, const Action&);

/// Gives the gain action.key the action's values. Returns why not (gain_fault), or "".
std::string set_gain(const rbd::Model&, LiveGains&, const Action&);

}  // namespace lab
