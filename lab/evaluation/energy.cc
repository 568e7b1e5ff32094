#include "lab/evaluation/energy.h"

#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

#include "lab/evaluation/running_stats.h"

namespace lab {

EnergyBalance energy_balance(const Run& run) {
  EnergyBalance out{.energy = {}, .work = {}, .drift = NAN, .kinetic_peak = NAN};
  for (size_t k = 0; k < run.states.size(); ++k)
    if (run.states[k].step != static_cast<int64_t>(k)) return out;
  rbd::Data data(run.model);
  Eigen::VectorXd displacement(run.model.nv);
  const auto loss = [&](const Eigen::VectorXd& v) {
    double power = 0;
    for (Eigen::Index i = 0; i < v.size(); ++i)
      power += rbd::frictionEffort(run.damping[i], run.friction[i], v[i]) * v[i];
    return power;
  };
  double work = 0;
  out.drift = out.kinetic_peak = 0;
  for (size_t k = 0; k < run.states.size(); ++k) {
    const RobotState& s = run.states[k];
    const double kinetic = rbd::computeKineticEnergy(run.model, data, s.q, s.v);
    out.energy.push_back(kinetic + rbd::computePotentialEnergy(run.model, data, s.q));
    if (!run.stored_energy.empty()) out.energy.back() += run.stored_energy[k];
    if (!run.external_work.empty()) work += run.external_work[k];
    if (k > 0) {
      const RobotState& before = run.states[k - 1];
      rbd::difference(run.model, before.q, s.q, displacement);
      for (Eigen::Index i = 0; i < displacement.size(); ++i) work += s.tau[i] * displacement[i];
      work -= 0.5 * run.dt * (loss(before.v) + loss(s.v));
    }
    out.work.push_back(work);
    out.drift = std::max(out.drift, std::abs(out.energy.back() - out.energy.front() - work));
    out.kinetic_peak = std::max(out.kinetic_peak, kinetic);
  }
  return out;
}

void add_energy_metrics(nlohmann::json& out, const Run& run) {
  const EnergyBalance balance = energy_balance(run);
  const bool whole = !balance.energy.empty();
  put(out, "energy_first", whole ? balance.energy.front() : NAN);
  put(out, "energy_last", whole ? balance.energy.back() : NAN);
  put(out, "work", whole ? balance.work.back() : NAN);
  put(out, "energy_drift", balance.drift);
  put(out, "energy_drift_relative", balance.kinetic_peak > 0 ? balance.drift / balance.kinetic_peak : NAN);
}

}  // namespace lab
