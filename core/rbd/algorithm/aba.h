// Forward dynamics: articulated bodies.  a = M(q)^-1 (tau - nle(q, v)), without forming M.
// Source: Featherstone 2008, table 7.1.
//
// Throws std::runtime_error naming the joint when its articulated inertia is singular (a massless tip, say).
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// Accelerations (nv): data.ddq.
const Eigen::VectorXd& aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau);
void aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
         const ConstVectorRef& tau, VectorRef ddq);

}  // namespace rbd
