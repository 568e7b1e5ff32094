// Derivatives of velocities and accelerations of joints and frames in q, v and a: 6 x nv, angular rows first,
// tangent space. They are the derivatives of the very numbers that getVelocity, getAcceleration and their
// frame versions return in the reference asked for. Source: Carpentier, Mansard 2018; Singh, Russell, Wensing
// 2022.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// What all getters below need; also fills data.oMi, data.oMf, data.v, data.a. (They speak of data.oMi as it
// is when they are called.)
void computeForwardKinematicsDerivatives(const Model& model, Data& data, const ConstVectorRef& q,
                                         const ConstVectorRef& v, const ConstVectorRef& a);

void getJointVelocityDerivatives(const Model& model, const Data& data, JointIndex joint,
                                 ReferenceFrame reference, MatrixRef dv_dq, MatrixRef dv_dv);
void getFrameVelocityDerivatives(const Model& model, const Data& data, FrameIndex frame,
                                 ReferenceFrame reference, MatrixRef dv_dq, MatrixRef dv_dv);

// Of the spatial acceleration. (da_da is the Jacobian.)
void getJointAccelerationDerivatives(const Model& model, const Data& data, JointIndex joint,
                                     ReferenceFrame reference, MatrixRef dv_dq, MatrixRef da_dq,
                                     MatrixRef da_dv, MatrixRef da_da);
void getFrameAccelerationDerivatives(const Model& model, const Data& data, FrameIndex frame,
                                     ReferenceFrame reference, MatrixRef dv_dq, MatrixRef da_dq,
                                     MatrixRef da_dv, MatrixRef da_da);

}  // namespace rbd
