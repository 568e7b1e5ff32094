// Total momentum about the centre of mass, and the matrices that give it from the joints' rates. World axes;
// the universe's own inertia is left out. Throws std::runtime_error when the total mass is zero. Source:
// Orin, Goswami, Lee, Centroidal dynamics of a humanoid robot, 2013.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

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

// The centroidal map, 6 x nv: hg = Ag v. Fills data.Ag, data.com[0].
const PaddedMatrix& computeCentroidalMap(const Model& model, Data& data, const ConstVectorRef& q);
void computeCentroidalMap(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef Ag);
// With v: data.Ag and data.hg.
const PaddedMatrix& ccrba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v);

// Its rate: dhg = Ag a + dAg v. Fills data.dAg, and data.Ag, data.hg, data.com[0], data.vcom[0].
const PaddedMatrix& computeCentroidalMapTimeVariation(const Model& model, Data& data, const ConstVectorRef& q,
                                                      const ConstVectorRef& v);
const PaddedMatrix& dccrba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v);

}  // namespace rbd
