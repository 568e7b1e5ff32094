// The joint-space inertia matrix M(q), rotors included as model.terms says, both sides filled.
// Source: composite rigid bodies, Featherstone 2008, table 6.2.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// data.M, nv x nv.
const PaddedMatrix& crba(const Model& model, Data& data, const ConstVectorRef& q);
void crba(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef M);

}  // namespace rbd
