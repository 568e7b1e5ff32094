// Pass 2 (inward) of the articulated-body algorithm, shared by aba and computeMinverse. Source: Featherstone
// 2008, table 7.1.
#pragma once

#include <algorithm>

#include "rbd/kernel/forward_passes.h"

namespace rbd::inner {

// `rotor`: inertia of the rotor of each dof. Needs IA[i] = rigid inertias, f[i], S. Fills U, inverseD;
// IA and f of children are added to their parents. `eachDof(i, k)` is called for each dof k of joint i
// once U[k] and inverseD[k] are known. Returns the dof whose inertia D is singular, or -1.
// Singular means D <= 1e-14 times the largest D in the subtree, the rounding error of an exact zero.
template <class Scalar, class EachDof>
inline int articulate(const Joints& joints, const double* rotor, Scratch<Scalar>& s, Scalar& D,
                      EachDof&& eachDof) {
  std::fill(s.largestD.begin(), s.largestD.end(), Scalar(0));
  for (int i = static_cast<int>(joints.size()) - 1; i > 0; --i) {
    const PackedJoint& joint = joints[i];
    ArticulatedInertia<Scalar>& IA = s.IA[i];
    for (int k = joint.idx_v + joint.nv - 1; k >= joint.idx_v; --k) {
      s.U[k] = IA * s.S[k];
      D = dot(s.S[k], s.U[k]) + Scalar(rotor[k]);
      if (!(D > Scalar(1e-14) * s.largestD[i])) return k;  // not <=: catches nan too
      s.largestD[i] = std::max(s.largestD[i], D);
      s.inverseD[k] = Scalar(1) / D;
      eachDof(i, k);
      IA.subtract(s.U[k], s.inverseD[k]);
    }
    if (joint.parent > 0) {
      s.IA[joint.parent] = s.IA[joint.parent] + IA;
      s.f[joint.parent] = s.f[joint.parent] + s.f[i];
      s.largestD[joint.parent] = std::max(s.largestD[joint.parent], s.largestD[i]);
    }
  }
  return -1;
}

}  // namespace rbd::inner
