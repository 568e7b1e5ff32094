// Velocities, accelerations and the rates of columns, in world axes: the first step of all derivatives.
//
// Dof k moves its whole subtree. With S its column of the motion subspace, v the velocity of its body, and w
// and c the velocity and acceleration of the PARENT body:
//   Sd    = v x S               time derivative of the column
//   Psid  = w x S               for j in the subtree: dv_j/dq_k = S x v_j + Psid,
//   Psidd = c x S + w x Psid    da_j/dq_k = S x a_j + Psid x v_j + Psidd
// The first terms move the subtree as a whole and cancel in efforts. The names are those of the source,
// with d for a dot: Singh, Russell, Wensing, Efficient analytical derivatives of rigid-body dynamics using
// spatial vector algebra, 2022.
#pragma once

#include "rbd/kernel/forward_passes.h"

namespace rbd::inner {

// Fills S, v, a, Sd, Psid, Psidd. `base`: acceleration of the universe (minus gravity, or zero).
// Needs worldPoses. A null qdd means zero.
inline void motionRates(const Joints& joints, const double* qd, const double* qdd,
                        const SpatialMotion<double>& base, Scratch<double>& s) {
  s.v[0] = SpatialMotion<double>::zero();
  s.a[0] = base;
  for (int i = 1; i < static_cast<int>(joints.size()); ++i) {
    const PackedJoint& joint = joints[i];
    const SpatialMotion<double>&v = s.v[joint.parent], &a = s.a[joint.parent];
    worldSubspace(joint, i, s);
    const SpatialMotion<double> vJ = jointMotion(joint, qd, s);
    s.v[i] = v + vJ;
    s.a[i] = a + cross(v, vJ);
    if (qdd) s.a[i] = s.a[i] + jointMotion(joint, qdd, s);
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) {
      const SpatialMotion<double>& S = s.S[k];
      s.Psid[k] = cross(v, S);
      s.Psidd[k] = cross(a, S) + cross(v, s.Psid[k]);
      s.Sd[k] = joint.nv == 1 ? s.Psid[k] : cross(s.v[i], S);
    }
  }
}

}  // namespace rbd::inner
