// The steps that several algorithms begin with. Each says what it fills in Scratch.
#pragma once

#include "rbd/kernel/joint_kinds.h"

namespace rbd::inner {

using Joints = std::vector<PackedJoint>;

template <class S>
inline Vec3<S> gravity(const Model& model) {
  const Eigen::Vector3d& g = model.gravity.linear();
  return Vec3<S>::make(S(g[0]), S(g[1]), S(g[2]));
}

// sine and cosine of all of q at once.
template <class S>
inline void sinesAndCosines(const Model& model, const S* q, Scratch<S>& s) {
  sincosAll(model.tree().nq, q, s.sine.data(), s.cosine.data());
}

// R, p, centre. World axes, but p, columns, inertias and wrenches are all taken about the centre: the origin
// of joint 1 (a robot far from the world's origin loses no digits).
template <class S>
inline void worldPoses(const Joints& joints, const S* q, Scratch<S>& s) {
  const int n = static_cast<int>(joints.size());
  s.R[0] = Mat3<S>::identity();
  s.p[0] = s.centre = Vec3<S>::zero();
  if (n < 2) return;
  worldPose(joints[1], 1, q, s);
  s.centre = s.p[1];
  s.p[0] = -s.centre;
  s.p[1] = Vec3<S>::zero();
  for (int i = 2; i < n; ++i) worldPose(joints[i], i, q, s);
}

template <class S>
inline void worldColumns(const Joints& joints, Scratch<S>& s) {
  for (int i = 1; i < static_cast<int>(joints.size()); ++i) worldColumns(joints[i], i, s);
}

// Inertia of a joint's body about the centre, world axes: R I R' + m (c.c 1 - c c').
template <class S>
inline RigidInertia<S> worldInertia(const PackedJoint& joint, const Mat3<S>& R, const Vec3<S>& p) {
  const Mat3<S> A = timesMatrix(R, joint.inertia);
  const Vec3<S> c = p + times(R, joint.com);
  const Vec3<S> h = c * S(joint.mass);
  const S hc = dot(h, c), o(0);
  const auto column = [&](int k, Vec3<S> diagonal) {
    return A.c0 * R.c0[k] + A.c1 * R.c1[k] + A.c2 * R.c2[k] + diagonal - h * c[k];
  };
  return {{column(0, Vec3<S>::make(hc, o, o)), column(1, Vec3<S>::make(o, hc, o)),
           column(2, Vec3<S>::make(o, o, hc))},
          h,
          S(joint.mass)};
}

template <class S>
inline void worldInertias(const Joints& joints, Scratch<S>& s) {
  for (int i = 1; i < static_cast<int>(joints.size()); ++i) s.I[i] = worldInertia(joints[i], s.R[i], s.p[i]);
}

// Sum of column * qd over the dofs of one joint.
template <class S>
inline Motion<S> jointMotion(const PackedJoint& joint, const S* qd, const Scratch<S>& s) {
  Motion<S> m = s.column[joint.idx_v] * qd[joint.idx_v];
  for (int k = joint.idx_v + 1; k < joint.idx_v + joint.nv; ++k) m = m + s.column[k] * qd[k];
  return m;
}

}  // namespace rbd::inner
