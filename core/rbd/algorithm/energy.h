// Energies of the whole robot (J). The universe's own inertia is left out.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// 1/2 v' M v, rotors included: data.kinetic_energy.
double computeKineticEnergy(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v);
// - sum of m g . com, zero with everything at the world's origin: data.potential_energy.
double computePotentialEnergy(const Model& model, Data& data, const ConstVectorRef& q);
// Their sum: data.mechanical_energy (and both parts).
double computeMechanicalEnergy(const Model& model, Data& data, const ConstVectorRef& q,
                               const ConstVectorRef& v);

}  // namespace rbd
