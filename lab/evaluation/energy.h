// Balance of energy and work over a run: what the integrator adds or loses.
#pragma once
#include <cmath>
#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "lab/evaluation/evaluate.h"

namespace lab {

/// NaN if steps are missing.
struct EnergyBalance {
  double first = NAN, last = NAN;  ///< J: kinetic and potential
  double work = NAN;               ///< J: done since step 0
  double drift = NAN;              ///< J: largest |energy gained - work|
  double kinetic_peak = NAN;       ///< J: largest kinetic energy
};

/// At one step: time in s, energy and the work done since step 0 in J.
using VisitEnergy = std::function<void(double time, double energy, double work)>;

/// tau is constant over a step, so that its work is exactly tau times the displacement; the losses of damping and
/// friction are summed by the trapezoidal rule. Needs every step: else nothing is visited.
EnergyBalance energy_balance(const Run&, const VisitEnergy& visit = {});

/// Puts the metrics of energy into `out`.
void add_energy_metrics(nlohmann::json& out, const Run&);

}  // namespace lab
