// Inverse dynamics: recursive Newton-Euler.  tau = M(q) a + nle(q, v).  Source: Featherstone 2008, table 5.1.
//
// The references returned point into data and are overwritten by the next call; the twins write where you
// say. Armature is part of M. Damping and dry friction are not added.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// Efforts (nv) for the motion q, v, a: data.tau.
const Eigen::VectorXd& rnea(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a);
void rnea(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
          const ConstVectorRef& a, VectorRef tau);

// Efforts at a = 0: Coriolis, centrifugal and gravity: data.nle.
const Eigen::VectorXd& nonLinearEffects(const Model& model, Data& data, const ConstVectorRef& q,
                                        const ConstVectorRef& v);
void nonLinearEffects(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                      VectorRef nle);

// Efforts at v = a = 0, that hold the robot against gravity: data.g. Equals dU/dq.
const Eigen::VectorXd& computeGeneralizedGravity(const Model& model, Data& data, const ConstVectorRef& q);
void computeGeneralizedGravity(const Model& model, Data& data, const ConstVectorRef& q, VectorRef g);

}  // namespace rbd
