#include "lab/evaluation/energy.h"

#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

namespace lab {

Energy balance(const Run& run) {
  Energy out{.energy = {}, .work = {}, .drift = NAN, .scale = NAN};
  for (size_t k = 0; k < run.states.size(); ++k)
    if (run.states[k].step != static_cast<int64_t>(k)) return out;
  rbd::Data data(run.model);
  Eigen::VectorXd way(run.model.nv);
  const auto loss = [&](const Eigen::VectorXd& v) {
    double power = 0;
    for (Eigen::Index i = 0; i < v.size(); ++i)
      power += rbd::frictionEffort(run.damping[i], run.friction[i], v[i]) * v[i];
    return power;
  };
  double work = 0;
  out.drift = out.scale = 0;
  for (size_t k = 0; k < run.states.size(); ++k) {
    const RobotState& s = run.states[k];
    const double kinetic = rbd::computeKineticEnergy(run.model, data, s.q, s.v);
    out.energy.push_back(kinetic + rbd::computePotentialEnergy(run.model, data, s.q));
    if (!run.stored.empty()) out.energy.back() += run.stored[k];
    if (!run.external_work.empty()) work += run.external_work[k];
    if (k > 0) {
      const RobotState& before = run.states[k - 1];
      rbd::difference(run.model, before.q, s.q, way);
      for (Eigen::Index i = 0; i < way.size(); ++i) work += s.tau[i] * way[i];
      work -= 0.5 * run.dt * (loss(before.v) + loss(s.v));
    }
    out.work.push_back(work);
    out.drift = std::max(out.drift, std::abs(out.energy.back() - out.energy.front() - work));
    out.scale = std::max(out.scale, kinetic);
  }
  return out;
}

}  // namespace lab
