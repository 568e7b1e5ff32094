// The Coriolis matrix: C(q, v) v = nle - g, and dM/dt - 2C is skew-symmetric (passivity). Damping and dry
// friction are not part of it. Source: Echeandia, Wensing 2021.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// data.C, nv x nv.
const PaddedMatrix& computeCoriolisMatrix(const Model& model, Data& data, const ConstVectorRef& q,
                                          const ConstVectorRef& v);
void computeCoriolisMatrix(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           MatrixRef C);

}  // namespace rbd
