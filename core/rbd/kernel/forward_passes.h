// Outward passes that several algorithms start with. Each comment names the Scratch fields that are filled.
#pragma once

#include "rbd/kernel/joint_kinds.h"

namespace rbd::inner {

using Joints = std::vector<PackedJoint>;

template <class Scalar>
inline Vec3<Scalar> gravity(const Model& model) {
  const Eigen::Vector3d& g = model.gravity.linear();
  return Vec3<Scalar>::make(Scalar(g[0]), Scalar(g[1]), Scalar(g[2]));
}

// sine and cosine of all of q at once.
template <class Scalar>
inline void sinesAndCosines(const Model& model, const Scalar* q, Scratch<Scalar>& s) {
  sincosAll(model.tree().nq, q, s.sine.data(), s.cosine.data());
}

// R, p, centre, in world axes. p, S, inertias and wrenches are relative to the centre, the origin of joint 1,
// so that a robot far from the world's origin loses no precision.
template <class Scalar>
inline void worldPoses(const Joints& joints, const Scalar* q, Scratch<Scalar>& s) {
  const int n = static_cast<int>(joints.size());
  s.R[0] = Mat3<Scalar>::identity();
  s.p[0] = s.centre = Vec3<Scalar>::zero();
  if (n < 2) return;
  worldPose(joints[1], 1, q, s);
  s.centre = s.p[1];
  s.p[0] = -s.centre;
  s.p[1] = Vec3<Scalar>::zero();
  for (int i = 2; i < n; ++i) worldPose(joints[i], i, q, s);
}

template <class Scalar>
inline void worldSubspaces(const Joints& joints, Scratch<Scalar>& s) {
  for (int i = 1; i < static_cast<int>(joints.size()); ++i) worldSubspace(joints[i], i, s);
}

// Inertia of a joint's body about the centre, world axes: R I R' + m (c.c 1 - c c').
template <class Scalar>
inline RigidInertia<Scalar> worldInertia(const PackedJoint& joint, const Mat3<Scalar>& R,
                                         const Vec3<Scalar>& p) {
  const Mat3<Scalar> A = timesMatrix(R, joint.inertia);
  const Vec3<Scalar> c = p + times(R, joint.com);
  const Vec3<Scalar> h = c * Scalar(joint.mass);
  const Scalar hc = dot(h, c), o(0);
  const auto column = [&](int k, Vec3<Scalar> diagonal) {
    return A.c0 * R.c0[k] + A.c1 * R.c1[k] + A.c2 * R.c2[k] + diagonal - h * c[k];
  };
  return {{column(0, Vec3<Scalar>::make(hc, o, o)), column(1, Vec3<Scalar>::make(o, hc, o)),
           column(2, Vec3<Scalar>::make(o, o, hc))},
          h,
          Scalar(joint.mass)};
}

template <class Scalar>
inline void worldInertias(const Joints& joints, Scratch<Scalar>& s) {
  for (int i = 1; i < static_cast<int>(joints.size()); ++i) s.I[i] = worldInertia(joints[i], s.R[i], s.p[i]);
}

// S qd of one joint.
template <class Scalar>
inline SpatialMotion<Scalar> jointMotion(const PackedJoint& joint, const Scalar* qd,
                                         const Scratch<Scalar>& s) {
  SpatialMotion<Scalar> m = s.S[joint.idx_v] * qd[joint.idx_v];
  for (int k = joint.idx_v + 1; k < joint.idx_v + joint.nv; ++k) m = m + s.S[k] * qd[k];
  return m;
}

}  // namespace rbd::inner
