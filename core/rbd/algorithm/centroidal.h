// Centre of mass, total momentum and energies of the whole robot.
//
// All leave out the universe's own inertia (what is bolted to the ground). World axes; hg and dhg are about
// the centre of mass. Throws std::runtime_error when the total mass is zero. Source: Orin, Goswami, Lee 2013.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// World position (m): data.com[0]; total mass: data.mass[0]. With v also data.vcom[0].
const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q);
const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q,
                                    const ConstVectorRef& v);
void centerOfMass(const Model& model, Data& data, const ConstVectorRef& q, Eigen::Vector3d& com);

// 3 x nv, J v = velocity of the centre of mass: data.Jcom. Fills data.com[0] too.
const PaddedMatrix& jacobianCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q);
void jacobianCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef J);

// Momentum (N m s; N s): data.hg. Without q and v: those of the last forwardKinematics.
const Force& computeCentroidalMomentum(const Model& model, Data& data);
const Force& computeCentroidalMomentum(const Model& model, Data& data, const ConstVectorRef& q,
                                       const ConstVectorRef& v);
void computeCentroidalMomentum(const Model& model, Data& data, const ConstVectorRef& q,
                               const ConstVectorRef& v, Force& hg);

// Its rate (N m; N): data.dhg (and data.hg). Without arguments: those of the last forwardKinematics; a = 0 if
// it had none.
const Force& computeCentroidalMomentumTimeVariation(const Model& model, Data& data);
const Force& computeCentroidalMomentumTimeVariation(const Model& model, Data& data, const ConstVectorRef& q,
                                                    const ConstVectorRef& v, const ConstVectorRef& a);
void computeCentroidalMomentumTimeVariation(const Model& model, Data& data, const ConstVectorRef& q,
                                            const ConstVectorRef& v, const ConstVectorRef& a, Force& dhg);

// 1/2 v' M v, armature included: data.kinetic_energy (J).
double computeKineticEnergy(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v);
// - sum of m g . com, zero with everything at the world's origin: data.potential_energy (J).
double computePotentialEnergy(const Model& model, Data& data, const ConstVectorRef& q);

}  // namespace rbd
