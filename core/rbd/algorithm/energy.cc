#include "rbd/algorithm/energy.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/whole_body.h"
#include "rbd/kernel/rotor_and_friction.h"

namespace rbd {

double computeKineticEnergy(const Model& model, Data& data, const ConstVectorRef& q,
                            const ConstVectorRef& v) {
  inner::checkInputs("computeKineticEnergy", model, data, q, "v", v);
  inner::worldPosesOf(model, data, q);
  inner::Scratch<double>& s = data.work().scratch;
  inner::momentum(model, data, v, nullptr);
  double twice = 0;
  for (int i = 1; i < model.tree().size(); ++i) {
    twice += dot(s.v[i], worldInertia(model.tree().joints[i], s.R[i], s.p[i]) * s.v[i]);
  }
  for (int k = 0; k < model.nv; ++k) twice += inner::rotorOf(model, k) * v[k] * v[k];
  return data.kinetic_energy = twice / 2;
}

double computePotentialEnergy(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("computePotentialEnergy", model, data, q);
  inner::worldPosesOf(model, data, q);
  const inner::Scratch<double>& s = data.work().scratch;
  const inner::Sum sum = inner::firstMoment(model, s);
  return data.potential_energy = -dot(inner::gravity<double>(model), sum.moment + s.centre * sum.mass);
}

double computeMechanicalEnergy(const Model& model, Data& data, const ConstVectorRef& q,
                               const ConstVectorRef& v) {
  return data.mechanical_energy =
             computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q);
}

}  // namespace rbd
