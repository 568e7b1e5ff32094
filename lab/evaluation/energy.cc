#include "lab/evaluation/energy.h"

#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

#include "lab/evaluation/running_stats.h"

namespace lab {

EnergyBalance energy_balance(const Run& run, const VisitEnergy& visit) {
  StepReader steps(run.steps);
  for (size_t k = 0; k < run.steps.size(); ++k)
    if (steps.at(k).state.step != static_cast<int64_t>(k)) return {};
  rbd::Data data(run.model);
  Eigen::VectorXd displacement(run.model.nv);
  const auto loss = [&](const Eigen::VectorXd& v) {
    double power = 0;
    for (Eigen::Index i = 0; i < v.size(); ++i)
      power += rbd::frictionEffort(run.damping[i], run.friction[i], v[i]) * v[i];
    return power;
  };
  EnergyBalance out;
  out.work = out.drift = out.kinetic_peak = 0;
  RobotState before;
  for (size_t k = 0; k < run.steps.size(); ++k) {
    const RunStep& step = steps.at(k);
    const RobotState& s = step.state;
    const double kinetic = rbd::computeKineticEnergy(run.model, data, s.q, s.v);
    out.last = kinetic + rbd::computePotentialEnergy(run.model, data, s.q) + step.stored_energy;
    out.work += step.external_work;
    if (k == 0) {
      out.first = out.last;
    } else {
      rbd::difference(run.model, before.q, s.q, displacement);
      for (Eigen::Index i = 0; i < displacement.size(); ++i) out.work += s.tau[i] * displacement[i];
      out.work -= 0.5 * run.dt * (loss(before.v) + loss(s.v));
    }
    before = s;
    out.drift = std::max(out.drift, std::abs(out.last - out.first - out.work));
    out.kinetic_peak = std::max(out.kinetic_peak, kinetic);
    if (visit) visit(static_cast<double>(s.step) * run.dt, out.last, out.work);
  }
  return out;
}

void add_energy_metrics(nlohmann::json& out, const Run& run) {
  const EnergyBalance balance = energy_balance(run);
  put(out, "energy_first", balance.first);
  put(out, "energy_last", balance.last);
  put(out, "work", balance.work);
  put(out, "energy_drift", balance.drift);
  put(out, "energy_drift_relative", balance.kinetic_peak > 0 ? balance.drift / balance.kinetic_peak : NAN);
}

}  // namespace lab
