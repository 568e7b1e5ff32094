// Forward dynamics: articulated bodies.  a = M(q)^-1 (tau - nle(q, v)), without forming M.
// Source: Featherstone 2008, table 7.1.
//
// Models with mimic joints form M and factorise it instead: O(n^3), overwriting data.nle, data.M, data.U,
// data.D.
//
// Throws std::runtime_error naming the joint when its articulated inertia is singular (a massless tip, say).
#pragma once

#include "rbd/algorithm/external_wrench.h"

namespace rbd {

// Accelerations (nv): data.ddq.
const Eigen::VectorXd& aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau);
void aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
         const ConstVectorRef& tau, VectorRef ddq);

// With external wrenches.
const Eigen::VectorXd& aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau, const FrameWrenches& wrenches);
void aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
         const ConstVectorRef& tau, const FrameWrenches& wrenches, VectorRef ddq);

}  // namespace rbd
