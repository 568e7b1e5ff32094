#include "rbd/algorithm/crba.h"

#include "rbd/algorithm/inner/joint_terms.h"
#include "rbd/algorithm/inner/kernels.h"
#include "rbd/algorithm/inner/mimic.h"
#include "rbd/algorithm/inner/stages.h"

namespace rbd {
namespace inner {

// Featherstone 2008, table 6.2, written in world axes: composite inertias add without any transform, and one
// force F serves all ancestors. Entry (l, k) is the force along dof l that accelerating dof k asks for; it is
// zero where neither dof moves the other.
template <class S>
void crbaKernel(const Model& model, const int* dof_parent, Scratch<S>& s, const S* q, S* M, int stride) {
  const Joints& joints = model.tree().joints;
  const int nv = model.tree().nv;
  angles(model, q, s);
  worldPoses(joints, q, s);
  worldColumns(joints, s);
  worldInertias(joints, s);
  for (int k = 0; k < nv; ++k) {
    for (int l = 0; l < nv; ++l) M[k * stride + l] = S(0);
  }

  s.I[0] = RigidInertia<S>{};
  for (int i = model.tree().size() - 1; i > 0; --i) {
    const PackedJoint& joint = joints[i];
    // I[i] holds body i and all its children by now
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) {
      const Force<S> F = s.I[i] * s.column[k];
      M[k * stride + k] = dot(s.column[k], F);
      for (int l = dof_parent[k]; l >= 0; l = dof_parent[l]) {
        M[k * stride + l] = M[l * stride + k] = dot(s.column[l], F);
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
  inner::crbaKernel(model, work.dofParent.data(), work.d, inner::treeQ(model, work, q),
                    inner::treeColumns(model, work.M, data.M), work.stride);
  inner::gatherBothSides(model, work.M, data.M);
  for (int k = 0; k < model.nv; ++k) data.M(k, k) += inner::rotorOf(model, k);
  return data.M;
}

void crba(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef M) {
  inner::checkOut("crba", "M", M, model.nv, model.nv);
  M = crba(model, data, q);
}

}  // namespace rbd
