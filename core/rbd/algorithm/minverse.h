// The inverse of the joint-space inertia matrix, both sides filled, without forming M.
// Source: Carpentier, Analytical inverse of the joint space inertia matrix, 2018.
//
// data.Minv IS M^-1: multiply by it (or call aba), do not solve with it.
// Throws std::runtime_error naming the joint when its articulated inertia is singular.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// data.Minv, nv x nv.
const PaddedMatrix& computeMinverse(const Model& model, Data& data, const ConstVectorRef& q);
void computeMinverse(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef Minv);

}  // namespace rbd
