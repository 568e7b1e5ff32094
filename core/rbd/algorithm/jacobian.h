// Jacobians: 6 x nv, rows 0-2 angular, 3-5 linear. J v = spatial velocity in the reference asked for.
//
// Columns of dofs that do not move the joint or frame are zero. Output arguments must be 6 x nv already.
// Source: Featherstone 2008, section 4.1.3 (columns are the world-frame motion subspaces).
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// Column k of data.J: the motion that dof k alone gives to what it carries, WORLD. Also fills data.oMi.
// Returns data.J. (Not the Jacobian of the last link: that one is getJointJacobian's.)
const PaddedMatrix& computeJointJacobians(const Model& model, Data& data, const ConstVectorRef& q);

// Of one joint's moving part, or of a frame. Need computeJointJacobians.
Matrix6Xd getJointJacobian(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference);
void getJointJacobian(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference,
                      MatrixRef J);
Matrix6Xd getFrameJacobian(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference);
void getFrameJacobian(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference,
                      MatrixRef J);

// Both steps in one call.
Matrix6Xd computeFrameJacobian(const Model& model, Data& data, const ConstVectorRef& q, FrameIndex frame,
                               ReferenceFrame reference);
void computeFrameJacobian(const Model& model, Data& data, const ConstVectorRef& q, FrameIndex frame,
                          ReferenceFrame reference, MatrixRef J);

// The rate of data.J while the robot moves with v: data.dJ, WORLD. Also fills data.J, data.oMi and data.v.
const PaddedMatrix& computeJointJacobiansTimeVariation(const Model& model, Data& data,
                                                       const ConstVectorRef& q, const ConstVectorRef& v);

// The rates of the Jacobians above: dJ v + J a is the rate of J v. For LOCAL that of its numbers in the
// moving axes, for LOCAL_WORLD_ALIGNED the classical acceleration. Need computeJointJacobiansTimeVariation.
Matrix6Xd getJointJacobianTimeVariation(const Model& model, const Data& data, JointIndex joint,
                                        ReferenceFrame reference);
void getJointJacobianTimeVariation(const Model& model, const Data& data, JointIndex joint,
                                   ReferenceFrame reference, MatrixRef dJ);
Matrix6Xd getFrameJacobianTimeVariation(const Model& model, const Data& data, FrameIndex frame,
                                        ReferenceFrame reference);
void getFrameJacobianTimeVariation(const Model& model, const Data& data, FrameIndex frame,
                                   ReferenceFrame reference, MatrixRef dJ);

}  // namespace rbd
