#include "rbd/algorithm/coriolis.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/kernel/mimic.h"
#include "rbd/kernel/motion_rates.h"

namespace rbd {
namespace inner {
namespace {

// Echeandia, Wensing 2021, in world axes: I and B of everything behind a joint simply add. Entry (k, l) is
// zero where neither dof moves the other.
void coriolisKernel(const Model& model, const int* dof_parent, Scratch<double>& s, const double* q,
                    const double* qd, double* C, int stride) {
  const Joints& joints = model.tree().joints;
  const int nv = model.tree().nv;
  sinesAndCosines(model, q, s);
  worldPoses(joints, q, s);
  motionRates(joints, qd, nullptr, Motion<double>::zero(), s);
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
      const Motion<double>& S = s.column[k];
      const Force<double> momentum = s.I[i] * S;                    // of everything behind, along dof k
      const Force<double> force = s.I[i] * s.rate[k] + s.B[i] * S;  // that the rate of dof k asks for
      const Force<double> back = s.B[i].transposeTimes(S);
      for (int l = joint.idx_v; l < joint.idx_v + joint.nv; ++l) at(l, k) = dot(s.column[l], force);
      for (int l = dof_parent[joint.idx_v]; l >= 0; l = dof_parent[l]) {
        at(l, k) = dot(s.column[l], force);
        at(k, l) = dot(s.rate[l], momentum) + dot(s.column[l], back);
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
  inner::coriolisKernel(model, work.dofParent.data(), work.d, inner::treeQ(model, work, q),
                        inner::treeV(model, work.v, v), inner::treeOut(model, work.M, data.C), work.stride);
  inner::gatherBothSides(model, work.M, data.C);
  return data.C;
}

void computeCoriolisMatrix(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           MatrixRef C) {
  inner::checkOut("computeCoriolisMatrix", "C", C, model.nv, model.nv);
  C = computeCoriolisMatrix(model, data, q, v);
}

}  // namespace rbd
