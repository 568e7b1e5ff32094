#include "rbd/algorithm/jacobian.h"

#include "rbd/algorithm/inner/mimic.h"
#include "rbd/algorithm/inner/public_face.h"

namespace rbd {
namespace {

// A WORLD motion written in another reference; `pose` is the world pose of the frame asked for.
Motion columnIn(const Motion& world, const SE3& pose, ReferenceFrame reference) {
  if (reference == WORLD) return world;
  if (reference == LOCAL) return pose.actInv(world);
  return {world.angular(), world.linear() + world.angular().cross(pose.translation())};
}

// Columns of all dofs between `joint` and the root; the others are zero.
void fillJacobian(const Data& data, const Model& model, JointIndex joint, const SE3& pose,
                  ReferenceFrame reference, MatrixRef J) {
  J.setZero();
  const KernelTree& tree = model.tree();
  const PaddedMatrix& all = tree.mimic.identity ? data.J : data.work().J;
  for (int body = tree.bodyOf[joint]; body > 0; body = tree.joints[body].parent) {
    const PackedJoint& above = tree.joints[body];
    for (int k = above.idx_v; k < above.idx_v + above.nv; ++k) {
      const Motion world(all.col(k).head<3>(), all.col(k).tail<3>());
      const Motion column = tree.mimic.v_ratio[k] * columnIn(world, pose, reference);
      J.block<3, 1>(0, tree.mimic.v_source[k]) += column.angular();
      J.block<3, 1>(3, tree.mimic.v_source[k]) += column.linear();
    }
  }
}

}  // namespace

const PaddedMatrix& computeJointJacobians(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("computeJointJacobians", model, data, q);
  inner::Workspace& work = data.work();
  inner::Scratch<double>& s = work.d;
  const double* const tree_q = inner::treeQ(model, work, q);
  inner::angles(model, tree_q, s);
  inner::worldPoses(model.tree().joints, tree_q, s);
  inner::worldColumns(model.tree().joints, s);
  inner::storeJointPoses(model, data);
  // from the centre to the world's origin: v_origin = v_centre + centre x w
  double* const J = inner::treeColumns(model, work.J, data.J);
  for (int k = 0; k < model.tree().nv; ++k) {
    double* column = J + 8 * k;
    s.column[k].w.storeU(column);
    (s.column[k].v + cross(s.centre, s.column[k].w)).storeU(column + 3);
  }
  inner::gatherColumns(model, work.J, data.J);
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
