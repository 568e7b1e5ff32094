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

/// The gains of the experiment. Throws ExperimentError for values that do not fit the model.
LiveGains live_gains(const Experiment&, const rbd::Model&);

/// kp, kd, ..: as `set controller` names them.
std::vector<std::string> gain_keys();

/// Of a key's unit, "pd: Nm/rad, N/m; computed_torque: 1/s2", what holds for a law; the first for a law that is not listed, a
/// unit for all laws as it is.
std::string unit_for_law(const std::string& unit, const std::string& law);

/// Why the gain action.key cannot have the action's values; empty if it can.
std::string gain_fault(const rbd::Model&, const Action&);

/// Sets the gain action.key to the action's values. Returns "", or why it is refused (gain_fault).
std::string set_gain(const rbd::Model&, LiveGains&, const Action&);

}  // namespace lab
