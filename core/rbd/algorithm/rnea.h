// Inverse dynamics: recursive Newton-Euler.  tau = M(q) a + nle(q, v).  Source: Featherstone 2008, table 5.1.
//
// The references returned point into data and are overwritten by the next call; the overloads with an output
// argument write there. model.terms selects rotors, damping and dry friction.
#pragma once

#include "rbd/algorithm/external_wrench.h"

namespace rbd {

// Efforts (nv) for the motion q, v, a: data.tau.
const Eigen::VectorXd& rnea(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a);
void rnea(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
          const ConstVectorRef& a, VectorRef tau);

// With external wrenches: tau = M a + nle - sum of J' f.
const Eigen::VectorXd& rnea(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a, const FrameWrenches& wrenches);

// Efforts at a = 0: Coriolis, centrifugal, gravity, and friction as model.terms says: data.nle.
const Eigen::VectorXd& nonLinearEffects(const Model& model, Data& data, const ConstVectorRef& q,
                                        const ConstVectorRef& v);
void nonLinearEffects(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                      VectorRef nle);

// Efforts at v = a = 0, that hold the robot against gravity: data.g. Equals dU/dq.
const Eigen::VectorXd& computeGeneralizedGravity(const Model& model, Data& data, const ConstVectorRef& q);
void computeGeneralizedGravity(const Model& model, Data& data, const ConstVectorRef& q, VectorRef g);

// Efforts that hold the robot still against gravity and wrenches: data.tau. Overwrites data.g.
const Eigen::VectorXd& computeStaticTorque(const Model& model, Data& data, const ConstVectorRef& q,
                                           const FrameWrenches& wrenches);

}  // namespace rbd
