// Joint mechanics in the dynamics, as selected by model.terms: rotors, damping, dry friction.
#pragma once

#include <cmath>

#include "rbd/kernel/workspace.h"
#include "rbd/model/friction.h"
#include "rbd/spatial/vector_ref.h"

namespace rbd::inner {

// Rotor inertia reflected to the joint: of dof k; of all nv dofs.
inline double rotorOf(const Model& model, int k) {
  return (model.terms.armature ? model.armature[k] : 0.0) +
         (model.terms.rotor ? model.rotorGearRatio[k] * model.rotorGearRatio[k] * model.rotorInertia[k]
                            : 0.0);
}
inline const double* rotors(const Model& model, Workspace& work) {
  for (int k = 0; k < model.nv; ++k) work.rotor[k] = rotorOf(model, k);
  return work.rotor.data();
}
inline void addRotorEfforts(const Model& model, const ConstVectorRef& a, Eigen::VectorXd& tau) {
  for (int k = 0; k < model.nv; ++k) tau[k] += rotorOf(model, k) * a[k];
}

// tau += sign * (damping v + dry friction).
inline void addFrictionEfforts(const Model& model, const ConstVectorRef& v, double sign,
                               Eigen::VectorXd& tau) {
  if (model.terms.damping) tau += sign * model.damping.cwiseProduct(v);
  if (!model.terms.friction) return;
  for (int k = 0; k < model.nv; ++k) tau[k] += sign * model.friction[k] * std::tanh(v[k] / kSlipSpeed);
}

// Derivative of that effort in v, for dof k.
inline double frictionSlope(const Model& model, int k, double v) {
  const double damping = model.terms.damping ? model.damping[k] : 0.0;
  return model.terms.friction ? rbd::frictionSlope(damping, model.friction[k], v) : damping;
}

}  // namespace rbd::inner
