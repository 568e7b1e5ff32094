#include "rbd/algorithm/kinematics.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/to_user_frames.h"
#include "rbd/kernel/mimic.h"

namespace rbd {
namespace {

// Velocities, and accelerations without gravity, of every joint in its own axes. Featherstone 2008,
// table 5.1. Given null rates (qdd) they are left alone.
void localMotions(const Model& model, Data& data, const double* q, const double* qd, const double* qdd) {
  inner::Scratch<double>& s = data.work().scratch;
  const inner::Joints& joints = model.tree().joints;
  s.v[0] = s.a[0] = inner::SpatialMotion<double>::zero();
  for (int i = 1; i < model.tree().size(); ++i) {
    const PackedJoint& joint = joints[i];
    inner::jointPose(joint, q, s, s.X[i]);
    s.v[i] = inner::plusS(joint, s.X[i].toChild(s.v[joint.parent]), qd + joint.idx_v);
    if (!qdd) continue;
    const inner::SpatialMotion<double> carried =
        s.X[i].toChild(s.a[joint.parent]) + inner::crossS(joint, s.v[i], qd + joint.idx_v);
    s.a[i] = inner::plusS(joint, carried, qdd + joint.idx_v);
  }
  for (JointIndex j = 1; j < model.njoints; ++j) {
    const int body = model.tree().bodyOf[j];
    data.v[j] = inner::userMotion(joints[body], s.v[body]);
    if (qdd) data.a[j] = inner::userMotion(joints[body], s.a[body]);
  }
}

void poses(const Model& model, Data& data, const ConstVectorRef& q) {
  const double* const tree_q = inner::expandQ(model, data.work(), q);
  inner::sinesAndCosines(model, tree_q, data.work().scratch);
  inner::worldPoses(model.tree().joints, tree_q, data.work().scratch);
  inner::storeJointPoses(model, data);
  inner::storeFramePoses(model, data);
  data.q_in = q;
  data.kinematics_order = 0;
}

Motion inReference(const SE3& pose, const Motion& local, ReferenceFrame reference) {
  if (reference == WORLD) return pose.act(local);
  if (reference == LOCAL) return local;
  return {pose.rotation() * local.angular(), pose.rotation() * local.linear()};
}

Motion classical(const Motion& a, const Motion& v) {
  return {a.angular(), a.linear() + v.angular().cross(v.linear())};
}

}  // namespace

void forwardKinematics(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("forwardKinematics", model, data, q);
  poses(model, data, q);
}

void forwardKinematics(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v) {
  inner::checkInputs("forwardKinematics", model, data, q, "v", v);
  poses(model, data, q);
  inner::Workspace& work = data.work();
  localMotions(model, data, inner::expandQ(model, work, q), inner::expandV(model, work.v, v), nullptr);
  data.v_in = v;
  data.kinematics_order = 1;
}

void forwardKinematics(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                       const ConstVectorRef& a) {
  inner::checkInputs("forwardKinematics", model, data, q, "v", v, "a", a);
  poses(model, data, q);
  inner::Workspace& work = data.work();
  localMotions(model, data, inner::expandQ(model, work, q), inner::expandV(model, work.v, v),
               inner::expandV(model, work.a, a));
  data.v_in = v;
  data.a_in = a;
  data.kinematics_order = 2;
}

void framesForwardKinematics(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("framesForwardKinematics", model, data, q);
  poses(model, data, q);
}

void updateFramePlacements(const Model& model, Data& data) {
  inner::checkData("updateFramePlacements", model, data);
  inner::storeFramePoses(model, data);
}

const SE3& updateFramePlacement(const Model& model, Data& data, FrameIndex frame) {
  inner::checkData("updateFramePlacement", model, data);
  inner::checkFrame("updateFramePlacement", model, frame);
  return data.oMf[frame] = data.oMi[model.frames[frame].parentJoint] * model.frames[frame].placement;
}

Motion getFrameVelocity(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference) {
  inner::checkData("getFrameVelocity", model, data);
  inner::checkFrame("getFrameVelocity", model, frame);
  if (data.kinematics_order < 1) inner::failOrder("getFrameVelocity", "forwardKinematics(model, data, q, v)");
  const Frame& f = model.frames[frame];
  return inReference(data.oMi[f.parentJoint] * f.placement, f.placement.actInv(data.v[f.parentJoint]),
                     reference);
}

void getFrameVelocity(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference,
                      Motion& out) {
  out = getFrameVelocity(model, data, frame, reference);
}

Motion getVelocity(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference) {
  inner::checkData("getVelocity", model, data);
  inner::checkJoint("getVelocity", model, joint);
  if (data.kinematics_order < 1) inner::failOrder("getVelocity", "forwardKinematics(model, data, q, v)");
  return inReference(data.oMi[joint], data.v[joint], reference);
}

void getVelocity(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference,
                 Motion& out) {
  out = getVelocity(model, data, joint, reference);
}

Motion getAcceleration(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference) {
  inner::checkData("getAcceleration", model, data);
  inner::checkJoint("getAcceleration", model, joint);
  if (data.kinematics_order < 2)
    inner::failOrder("getAcceleration", "forwardKinematics(model, data, q, v, a)");
  return inReference(data.oMi[joint], data.a[joint], reference);
}

Motion getFrameAcceleration(const Model& model, const Data& data, FrameIndex frame,
                            ReferenceFrame reference) {
  inner::checkData("getFrameAcceleration", model, data);
  inner::checkFrame("getFrameAcceleration", model, frame);
  if (data.kinematics_order < 2) {
    inner::failOrder("getFrameAcceleration", "forwardKinematics(model, data, q, v, a)");
  }
  const Frame& f = model.frames[frame];
  return inReference(data.oMi[f.parentJoint] * f.placement, f.placement.actInv(data.a[f.parentJoint]),
                     reference);
}

Motion getClassicalAcceleration(const Model& model, const Data& data, JointIndex joint,
                                ReferenceFrame reference) {
  return classical(getAcceleration(model, data, joint, reference),
                   getVelocity(model, data, joint, reference));
}

Motion getFrameClassicalAcceleration(const Model& model, const Data& data, FrameIndex frame,
                                     ReferenceFrame reference) {
  return classical(getFrameAcceleration(model, data, frame, reference),
                   getFrameVelocity(model, data, frame, reference));
}

}  // namespace rbd
