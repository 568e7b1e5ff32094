#include "rbd/algorithm/coriolis.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/kernel/mimic.h"
#include "rbd/kernel/motion_rates.h"

namespace rbd {
namespace inner {
namespace {

// Echeandia, Wensing 2021, in world axes: I and B of the subtree of a joint are plain sums. Entry (k, l) is
// zero unless one of the two dofs is an ancestor of the other.
void coriolisKernel(const Model& model, const int* dof_parent, Scratch<double>& s, const double* q,
                    const double* qd, double* C, int stride) {
  const Joints& joints = model.tree().joints;
  const int nv = model.tree().nv;
  sinesAndCosines(model, q, s);
  worldPoses(joints, q, s);
  motionRates(joints, qd, nullptr, SpatialMotion<double>::zero(), s);
  for (int i = 1; i < model.tree().size(); ++i) {
    s.I[i] = worldInertia(joints[i], s.R[i], s.p[i]);
    s.B[i] = CoriolisInertia<double>::of(s.I[i], s.v[i]);
  }
  for (int k = 0; k < nv; ++k) std::fill_n(C + k * stride, nv, 0.0);

  s.I[0] = RigidInertia<double>{};
  s.B[0] = CoriolisInertia<double>{};
  for (int i = model.tree().size() - 1; i > 0; --i) {
    const PackedJoint& joint = joints[i];
    const auto at = [&](int row, int column) -> double& { return C[column * stride + row]; };
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) {
      const SpatialMotion<double>& S = s.S[k];
      const SpatialForce<double> momentum = s.I[i] * S;                  // of the subtree, for dof k moving
      const SpatialForce<double> force = s.I[i] * s.Sd[k] + s.B[i] * S;  // that the rate of dof k requires
      const SpatialForce<double> back = s.B[i].transposeTimes(S);
      for (int l = joint.idx_v; l < joint.idx_v + joint.nv; ++l) at(l, k) = dot(s.S[l], force);
      for (int l = dof_parent[joint.idx_v]; l >= 0; l = dof_parent[l]) {
        at(l, k) = dot(s.S[l], force);
        at(k, l) = dot(s.Sd[l], momentum) + dot(s.S[l], back);
      }
    }
    s.I[joint.parent] = s.I[joint.parent] + s.I[i];
    s.B[joint.parent] = s.B[joint.parent] + s.B[i];
  }
}

}  // namespace
}  // namespace inner

const PaddedMatrix& computeCoriolisMatrix(const Model& model, Data& data, const ConstVectorRef& q,
                                          const ConstVectorRef& v) {
  inner::checkInputs("computeCoriolisMatrix", model, data, q, "v", v);
  inner::Workspace& work = data.work();
  inner::coriolisKernel(model, work.dofParent.data(), work.scratch, inner::expandQ(model, work, q),
                        inner::expandV(model, work.v, v), inner::kernelOutput(model, work.M, data.C),
                        work.stride);
  inner::collapseBothSides(model, work.M, data.C);
  return data.C;
}

void computeCoriolisMatrix(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           MatrixRef C) {
  inner::checkOut("computeCoriolisMatrix", "C", C, model.nv, model.nv);
  C = computeCoriolisMatrix(model, data, q, v);
}

}  // namespace rbd
