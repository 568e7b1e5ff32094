#include "rbd/algorithm/jacobian.h"

#include "rbd/algorithm/inner/public_face.h"

namespace rbd {
namespace {

// Column k of data.J written in another reference; `pose` is the world pose of the frame asked for.
Motion columnIn(const Data& data, int k, const SE3& pose, ReferenceFrame reference) {
  const Motion world(data.J.col(k).head<3>(), data.J.col(k).tail<3>());
  if (reference == WORLD) return world;
  if (reference == LOCAL) return pose.actInv(world);
  return {world.angular(), world.linear() + world.angular().cross(pose.translation())};
}

// Columns of all dofs between `joint` and the root; the others are zero.
void fillJacobian(const Data& data, const Model& model, JointIndex joint, const SE3& pose,
                  ReferenceFrame reference, MatrixRef J) {
  J.setZero();
  for (; joint > 0; joint = model.parents[joint]) {
    const JointModel& kind = model.joints[joint];
    for (int k = kind.idx_v(); k < kind.idx_v() + kind.nv(); ++k) {
      const Motion column = columnIn(data, k, pose, reference);
      J.block<3, 1>(0, k) = column.angular();
      J.block<3, 1>(3, k) = column.linear();
    }
  }
}

}  // namespace

const PaddedMatrix& computeJointJacobians(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("computeJointJacobians", model, data, q);
  inner::Scratch<double>& s = data.work().d;
  inner::angles(model, q.data(), s);
  inner::worldPoses(model.packed(), q.data(), s);
  inner::worldColumns(model.packed(), s);
  inner::storeJointPoses(model, data);
  // from the centre to the world's origin: v_origin = v_centre + centre x w
  for (int k = 0; k < model.nv; ++k) {
    double* column = data.J.data() + 8 * k;
    s.column[k].w.storeU(column);
    (s.column[k].v + cross(s.centre, s.column[k].w)).storeU(column + 3);
  }
  return data.J;
}

void getJointJacobian(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference,
                      MatrixRef J) {
  inner::checkData("getJointJacobian", model, data);
  inner::checkJoint("getJointJacobian", model, joint);
  inner::checkOut("getJointJacobian", "J", J, 6, model.nv);
  fillJacobian(data, model, joint, data.oMi[joint], reference, J);
}

Matrix6Xd getJointJacobian(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference) {
  Matrix6Xd J(6, model.nv);
  getJointJacobian(model, data, joint, reference, J);
  return J;
}

void getFrameJacobian(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference,
                      MatrixRef J) {
  inner::checkData("getFrameJacobian", model, data);
  inner::checkFrame("getFrameJacobian", model, frame);
  inner::checkOut("getFrameJacobian", "J", J, 6, model.nv);
  const Frame& f = model.frames[frame];
  fillJacobian(data, model, f.parentJoint, data.oMi[f.parentJoint] * f.placement, reference, J);
}

Matrix6Xd getFrameJacobian(const Model& model, const Data& data, FrameIndex frame, ReferenceFrame reference) {
  Matrix6Xd J(6, model.nv);
  getFrameJacobian(model, data, frame, reference, J);
  return J;
}

void computeFrameJacobian(const Model& model, Data& data, const ConstVectorRef& q, FrameIndex frame,
                          ReferenceFrame reference, MatrixRef J) {
  computeJointJacobians(model, data, q);
  getFrameJacobian(model, data, frame, reference, J);
}

Matrix6Xd computeFrameJacobian(const Model& model, Data& data, const ConstVectorRef& q, FrameIndex frame,
                               ReferenceFrame reference) {
  Matrix6Xd J(6, model.nv);
  computeFrameJacobian(model, data, q, frame, reference, J);
  return J;
}

}  // namespace rbd
