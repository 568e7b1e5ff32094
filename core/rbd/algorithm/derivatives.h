// Analytical derivatives of inverse and forward dynamics, in tangent space: entry (i, j) is how effort
// (acceleration) i changes when dof j moves along its own direction (or its rate changes). Free-flyers: body
// twists. Source: Singh, Russell, Wensing 2022; Carpentier, Mansard 2018.
//
// Damping and dry friction count as model.terms says. Wrenches from outside move as their references say:
// LOCAL ones with their frame, LOCAL_WORLD_ALIGNED ones with its origin only, WORLD ones not at all.
#pragma once

#include "rbd/algorithm/external_wrench.h"

namespace rbd {

// data.dtau_dq, data.dtau_dv (the derivative in a is M: crba).
void computeRNEADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a);
void computeRNEADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a, const FrameWrenches& wrenches);
void computeRNEADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a, MatrixRef dtau_dq, MatrixRef dtau_dv);

// data.ddq_dq, data.ddq_dv, data.Minv (the derivative in tau), data.ddq. Throws std::runtime_error naming the
// joint when M is singular.
void computeABADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau);
void computeABADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau, const FrameWrenches& wrenches);
void computeABADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau, MatrixRef ddq_dq, MatrixRef ddq_dv, MatrixRef ddq_dtau);

// How the efforts that hold the robot still change: nv x nv, data.dtau_dq. With wrenches: of
// computeStaticTorque.
const PaddedMatrix& computeGeneralizedGravityDerivatives(const Model& model, Data& data,
                                                         const ConstVectorRef& q);
const PaddedMatrix& computeStaticTorqueDerivatives(const Model& model, Data& data, const ConstVectorRef& q,
                                                   const FrameWrenches& wrenches);

}  // namespace rbd
