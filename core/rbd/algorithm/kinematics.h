// Forward kinematics: poses, velocities and accelerations of joints and frames.
//
// q: nq, v and a: nv numbers (model.h); units SI; world frame unless said. Errors: std::invalid_argument
// naming the function, what was given and what was needed. Source: Featherstone 2008, section 4.1.3 and
// table 5.1 (pass 1).
#pragma once

#include "rbd/algorithm/data.h"
#include "rbd/spatial/vector_ref.h"

namespace rbd {

// Poses of all joints and frames: data.oMi, data.oMf. Remembers q in data.q_in.
void forwardKinematics(const Model& model, Data& data, const ConstVectorRef& q);
// And data.v (LOCAL).
void forwardKinematics(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v);
// And data.a (LOCAL, spatial, gravity not included).
void forwardKinematics(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                       const ConstVectorRef& a);

// data.oMf from data.oMi. Only needed where a program has changed oMi itself: forwardKinematics fills both.
void updateFramePlacements(const Model& model, Data& data);
// One frame only; returns data.oMf[frame].
const SE3& updateFramePlacement(const Model& model, Data& data, FrameIndex frame);
// Another name of forwardKinematics(model, data, q).
void framesForwardKinematics(const Model& model, Data& data, const ConstVectorRef& q);

// Velocity of a frame or a joint in the reference asked for. Needs forwardKinematics with v.
Motion getFrameVelocity(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference);
void getFrameVelocity(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference,
                      Motion& out);
Motion getVelocity(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference);
void getVelocity(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference,
                 Motion& out);

// Spatial acceleration of a frame or a joint, gravity not included: the rate of its spatial velocity as seen
// in a frame at rest (LOCAL: written in the moving axes). Needs forwardKinematics with v and a.
Motion getFrameAcceleration(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference);
Motion getAcceleration(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference);

// Classical acceleration: linear() is the acceleration of the point itself, spatial + w x v. What an
// accelerometer at the frame measures, less gravity; in LOCAL_WORLD_ALIGNED the second derivative of the
// frame's position.
Motion getFrameClassicalAcceleration(const Model& model, const Data& data, FrameIndex frame,
                                     ReferenceFrame reference);
Motion getClassicalAcceleration(const Model& model, const Data& data, JointIndex joint,
                                ReferenceFrame reference);

}  // namespace rbd
