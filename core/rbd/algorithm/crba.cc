#include "rbd/algorithm/crba.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/kernels.h"
#include "rbd/kernel/forward_passes.h"
#include "rbd/kernel/mimic.h"
#include "rbd/kernel/rotor_and_friction.h"

namespace rbd {
namespace inner {

// Featherstone 2008, table 6.2, in world axes: composite inertias add without any transform, and one force F
// is used for all ancestors. Entry (l, k) is the effort at dof l that a unit acceleration of dof k requires;
// it is zero unless one of the two is an ancestor of the other. s.S[k] is the table's S, dof by dof;
// dof_parent[k] is its lambda: the previous dof of the same joint or of an ancestor; -1 = none.
template <class Scalar>
void crbaKernel(const Model& model, const int* dof_parent, Scratch<Scalar>& s, const Scalar* q, Scalar* M,
                int stride) {
  const Joints& joints = model.tree().joints;
  const int nv = model.tree().nv;
  sinesAndCosines(model, q, s);
  worldPoses(joints, q, s);
  worldSubspaces(joints, s);
  worldInertias(joints, s);
  for (int k = 0; k < nv; ++k) {
    for (int l = 0; l < nv; ++l) M[k * stride + l] = Scalar(0);
  }

  s.I[0] = RigidInertia<Scalar>{};  // accumulated like the others, never read
  for (int i = model.tree().size() - 1; i > 0; --i) {
    const PackedJoint& joint = joints[i];
    // I[i] is now the table's Ic: body i and its whole subtree
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) {
      const SpatialForce<Scalar> F = s.I[i] * s.S[k];
      M[k * stride + k] = dot(s.S[k], F);
      for (int l = dof_parent[k]; l >= 0; l = dof_parent[l]) {
        M[k * stride + l] = M[l * stride + k] = dot(s.S[l], F);
      }
    }
    s.I[joint.parent] = s.I[joint.parent] + s.I[i];
  }
}

template void crbaKernel(const Model&, const int*, Scratch<double>&, const double*, double*, int);
template void crbaKernel(const Model&, const int*, Scratch<long double>&, const long double*, long double*,
                         int);

}  // namespace inner

const PaddedMatrix& crba(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("crba", model, data, q);
  inner::Workspace& work = data.work();
  // expand, collapse: the map of mimic joints (kernel/mimic.h); no-ops without mimic joints
  inner::crbaKernel(model, work.dofParent.data(), work.scratch, inner::expandQ(model, work, q),
                    inner::kernelOutput(model, work.M, data.M), work.stride);
  inner::collapseBothSides(model, work.M, data.M);
  for (int k = 0; k < model.nv; ++k) data.M(k, k) += inner::rotorOf(model, k);
  return data.M;
}

void crba(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef M) {
  inner::checkOut("crba", "M", M, model.nv, model.nv);
  M = crba(model, data, q);
}

}  // namespace rbd
