// Balance of energy and work over a run: what the integrator adds or loses.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "lab/evaluation/evaluate.h"

namespace lab {

struct EnergyBalance {
  std::vector<double> energy;  ///< J by step: kinetic and potential. Empty if steps are missing
  std::vector<double> work;    ///< J by step: done since step 0. Empty if steps are missing
  double drift = 0;            ///< J: largest |energy gained - work|; NaN if steps are missing
  double kinetic_peak = 0;     ///< J: largest kinetic energy; NaN if steps are missing
};

/// tau is constant over a step, so that its work is exactly tau times the displacement; the losses of damping and
/// friction are summed by the trapezoidal rule. Needs every step.
EnergyBalance energy_balance(const Run&);

/// Puts the metrics of energy into `out`.
void add_energy_metrics(nlohmann::json& out, const Run&);

}  // namespace lab
