// Velocities, accelerations and the rates of columns, in world axes: what all derivatives begin with.
//
// Turning dof k moves everything behind it. With S its column, v and a of its body, and w, c (velocity and
// acceleration) of the body BEFORE its joint:
//   rate  = v x S               how the column itself changes
//   rest  = w x S               a velocity behind the joint changes by S x v_j + rest,
//   rest2 = c x S + w x rest    an acceleration by S x a_j + rest x v_j + rest2
// The first terms are the body being carried along; in efforts they cancel. Source: Singh, Russell, Wensing,
// Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra, 2022.
#pragma once

#include "rbd/kernel/forward_passes.h"

namespace rbd::inner {

// Fills column, v, a, rate, rest, rest2. `base`: acceleration of the universe (minus gravity, or zero).
// Needs worldPoses. Given null qdd: zero.
inline void motionRates(const Joints& joints, const double* qd, const double* qdd, const Motion<double>& base,
                        Scratch<double>& s) {
  s.v[0] = Motion<double>::zero();
  s.a[0] = base;
  for (int i = 1; i < static_cast<int>(joints.size()); ++i) {
    const PackedJoint& joint = joints[i];
    const Motion<double>&v = s.v[joint.parent], &a = s.a[joint.parent];
    worldColumns(joint, i, s);
    const Motion<double> vJ = jointMotion(joint, qd, s);
    s.v[i] = v + vJ;
    s.a[i] = a + cross(v, vJ);
    if (qdd) s.a[i] = s.a[i] + jointMotion(joint, qdd, s);
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) {
      const Motion<double>& S = s.column[k];
      s.rest[k] = cross(v, S);
      s.rest2[k] = cross(a, S) + cross(v, s.rest[k]);
      s.rate[k] = joint.nv == 1 ? s.rest[k] : cross(s.v[i], S);
    }
  }
}

}  // namespace rbd::inner
