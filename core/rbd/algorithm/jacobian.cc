#include "rbd/algorithm/jacobian.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/to_user_frames.h"
#include "rbd/kernel/mimic.h"
#include "rbd/kernel/motion_rates.h"

namespace rbd {
namespace {

// A WORLD motion expressed in another reference; `pose` is the world pose of the requested frame.
Motion inReference(const Motion& world, const SE3& pose, ReferenceFrame reference) {
  if (reference == WORLD) return world;
  if (reference == LOCAL) return pose.actInv(world);
  return {world.angular(), world.linear() + world.angular().cross(pose.translation())};
}

// Its rate, when the motion changes by `rate` and the frame moves with `v` (both WORLD).
Motion rateInReference(const Motion& world, const Motion& rate, const SE3& pose, const Motion& v,
                       ReferenceFrame reference) {
  if (reference == WORLD) return rate;
  if (reference == LOCAL) return pose.actInv(rate - v.cross(world));
  const Eigen::Vector3d moves = v.linear() + v.angular().cross(pose.translation());
  return inReference(rate, pose, reference) + Motion(Eigen::Vector3d::Zero(), world.angular().cross(moves));
}

Motion column(const PaddedMatrix& J, int k) { return {J.col(k).head<3>(), J.col(k).tail<3>()}; }

// J := columnOf(k) for all dofs k between `joint` and the root, added up where dofs share a leader; zero
// elsewhere.
template <class ColumnOf>
void fillJacobian(const Model& model, JointIndex joint, MatrixRef J, ColumnOf&& columnOf) {
  J.setZero();
  const KernelTree& tree = model.tree();
  for (int body = tree.bodyOf[joint]; body > 0; body = tree.joints[body].parent) {
    const PackedJoint& above = tree.joints[body];
    for (int k = above.idx_v; k < above.idx_v + above.nv; ++k) {
      const Motion x = tree.mimic.v_ratio[k] * columnOf(k);
      J.block<3, 1>(0, tree.mimic.v_source[k]) += x.angular();
      J.block<3, 1>(3, tree.mimic.v_source[k]) += x.linear();
    }
  }
}

void fillJacobian(const Model& model, const Data& data, JointIndex joint, const SE3& pose,
                  ReferenceFrame reference, MatrixRef J) {
  const PaddedMatrix& all = model.tree().mimic.identity ? data.J : data.work().J;
  fillJacobian(model, joint, J, [&](int k) { return inReference(column(all, k), pose, reference); });
}

void fillJacobianRate(const Model& model, const Data& data, JointIndex joint, const SE3& pose,
                      ReferenceFrame reference, MatrixRef dJ) {
  const bool identity = model.tree().mimic.identity;
  const PaddedMatrix &all = identity ? data.J : data.work().J, &rates = identity ? data.dJ : data.work().dJ;
  const Motion v = data.oMi[joint].act(data.v[joint]);
  fillJacobian(model, joint, dJ,
               [&](int k) { return rateInReference(column(all, k), column(rates, k), pose, v, reference); });
}

// Shifts from the centre to the world's origin: v_origin = v_centre + centre x w.
void storeColumns(const std::vector<inner::SpatialMotion<double>>& columns, const inner::Vec3<double>& centre,
                  double* out) {
  for (const inner::SpatialMotion<double>& x : columns) {
    x.w.storeU(out);
    (x.v + cross(centre, x.w)).storeU(out + 3);
    out += 8;
  }
}

}  // namespace

const PaddedMatrix& computeJointJacobians(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("computeJointJacobians", model, data, q);
  inner::Workspace& work = data.work();
  inner::Scratch<double>& s = work.scratch;
  const double* const tree_q = inner::expandQ(model, work, q);
  inner::sinesAndCosines(model, tree_q, s);
  inner::worldPoses(model.tree().joints, tree_q, s);
  inner::worldSubspaces(model.tree().joints, s);
  inner::storeJointPoses(model, data);
  storeColumns(s.S, s.centre, inner::kernelOutput(model, work.J, data.J));
  inner::collapseColumns(model, work.J, data.J);
  return data.J;
}

void getJointJacobian(const Model& model, const Data& data, JointIndex joint, ReferenceFrame reference,
                      MatrixRef J) {
  inner::checkData("getJointJacobian", model, data);
  inner::checkJoint("getJointJacobian", model, joint);
  inner::checkOut("getJointJacobian", "J", J, 6, model.nv);
  fillJacobian(model, data, joint, data.oMi[joint], reference, J);
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
  fillJacobian(model, data, f.parentJoint, data.oMi[f.parentJoint] * f.placement, reference, J);
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

const PaddedMatrix& computeJointJacobiansTimeVariation(const Model& model, Data& data,
                                                       const ConstVectorRef& q, const ConstVectorRef& v) {
  inner::checkInputs("computeJointJacobiansTimeVariation", model, data, q, "v", v);
  inner::Workspace& work = data.work();
  inner::Scratch<double>& s = work.scratch;
  const double* const tree_q = inner::expandQ(model, work, q);
  inner::sinesAndCosines(model, tree_q, s);
  inner::worldPoses(model.tree().joints, tree_q, s);
  inner::motionRates(model.tree().joints, inner::expandV(model, work.v, v), nullptr,
                     inner::SpatialMotion<double>::zero(), s);
  inner::storeJointPoses(model, data);
  for (JointIndex j = 1; j < model.njoints; ++j) {
    const inner::SpatialMotion<double>& twist = s.v[model.tree().bodyOf[j]];
    data.v[j] = data.oMi[j].actInv(
        Motion(inner::toEigen(twist.w), inner::toEigen(twist.v + cross(s.centre, twist.w))));
  }
  storeColumns(s.S, s.centre, inner::kernelOutput(model, work.J, data.J));
  storeColumns(s.Sd, s.centre, inner::kernelOutput(model, work.dJ, data.dJ));
  inner::collapseColumns(model, work.J, data.J);
  inner::collapseColumns(model, work.dJ, data.dJ);
  return data.dJ;
}

void getJointJacobianTimeVariation(const Model& model, const Data& data, JointIndex joint,
                                   ReferenceFrame reference, MatrixRef dJ) {
  inner::checkData("getJointJacobianTimeVariation", model, data);
  inner::checkJoint("getJointJacobianTimeVariation", model, joint);
  inner::checkOut("getJointJacobianTimeVariation", "dJ", dJ, 6, model.nv);
  fillJacobianRate(model, data, joint, data.oMi[joint], reference, dJ);
}

Matrix6Xd getJointJacobianTimeVariation(const Model& model, const Data& data, JointIndex joint,
                                        ReferenceFrame reference) {
  Matrix6Xd dJ(6, model.nv);
  getJointJacobianTimeVariation(model, data, joint, reference, dJ);
  return dJ;
}

void getFrameJacobianTimeVariation(const Model& model, const Data& data, FrameIndex frame,
                                   ReferenceFrame reference, MatrixRef dJ) {
  inner::checkData("getFrameJacobianTimeVariation", model, data);
  inner::checkFrame("getFrameJacobianTimeVariation", model, frame);
  inner::checkOut("getFrameJacobianTimeVariation", "dJ", dJ, 6, model.nv);
  const Frame& f = model.frames[frame];
  fillJacobianRate(model, data, f.parentJoint, data.oMi[f.parentJoint] * f.placement, reference, dJ);
}

Matrix6Xd getFrameJacobianTimeVariation(const Model& model, const Data& data, FrameIndex frame,
                                        ReferenceFrame reference) {
  Matrix6Xd dJ(6, model.nv);
  getFrameJacobianTimeVariation(model, data, frame, reference, dJ);
  return dJ;
}

}  // namespace rbd
