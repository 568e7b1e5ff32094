// What a joint kind means inside the kernels: its pose, its motion, its effort. Nowhere else do kernels know
// kinds.
//
// Every one-dof joint has been turned so that it moves about (kTurnZ) or along (kSlideZ) its local z. A kind
// of more dofs names its columns; the world-axes algorithms then take them one dof after the other and see no
// kind at all. All motion subspaces here are constant in the body: S_dot qd = v x S qd.
#pragma once

#include <cmath>

#include "rbd/algorithm/inner/check.h"
#include "rbd/algorithm/inner/sincos.h"
#include "rbd/algorithm/inner/workspace.h"

namespace rbd::inner {

// m * v for v read from packed constants: the scalars come from memory, ready to be spread over the lanes.
template <class S>
inline Vec3<S> times(const Mat3<S>& m, const double* v) {
  return m.c0 * S(v[0]) + m.c1 * S(v[1]) + m.c2 * S(v[2]);
}

template <class S>
inline Mat3<S> timesMatrix(const Mat3<S>& m, const double* b) {
  return {times(m, b), times(m, b + 4), times(m, b + 8)};
}

// R of a quaternion (x, y, z, w) of any length but zero.
template <class S>
inline Mat3<S> quaternionMatrix(const S* q) {
  const S x = q[0], y = q[1], z = q[2], w = q[3];
  const S s = S(2) / (x * x + y * y + z * z + w * w);
  const S o(1);
  return {Vec3<S>::make(o - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
          Vec3<S>::make(s * (x * y - z * w), o - s * (x * x + z * z), s * (y * z + x * w)),
          Vec3<S>::make(s * (x * z + y * w), s * (y * z - x * w), o - s * (x * x + y * y))};
}

// Pose of joint i in its parent, both ways. Needs sine and cosine.
template <class S>
inline void jointPose(const PackedJoint& joint, const S* q, const Scratch<S>& s, Pose<S>& X) {
  const Mat3<S> place = Mat3<S>::load(joint.place);
  X.p = Vec3<S>::load(joint.offset);
  if (joint.kind == kTurnZ) {
    const S sn = s.sine[joint.idx_q], cs = s.cosine[joint.idx_q];
    X.R = {place.c0 * cs + place.c1 * sn, place.c1 * cs - place.c0 * sn, place.c2};
    X.Rt = X.R.transposed();
  } else if (joint.kind == kSlideZ) {
    X.R = place;
    X.Rt = Mat3<S>::load(joint.placeT);
    X.p = X.p + place.c2 * q[joint.idx_q];
  } else {
    X.R = place * quaternionMatrix(q + joint.idx_q + 3);
    X.Rt = X.R.transposed();
    X.p = X.p + place * Vec3<S>::loadU(q + joint.idx_q);
  }
}

// m + S rate, in the joint's own axes.
template <class S>
inline Motion<S> plusJoint(const PackedJoint& joint, const Motion<S>& m, const S* rate) {
  const S o(0);
  if (joint.kind == kTurnZ) return {m.w + Vec3<S>::make(o, o, rate[0]), m.v};
  if (joint.kind == kSlideZ) return {m.w, m.v + Vec3<S>::make(o, o, rate[0])};
  return {m.w + Vec3<S>::loadU(rate), m.v + Vec3<S>::loadU(rate + 3)};
}

// v x S rate, in the joint's own axes.
template <class S>
inline Motion<S> crossJoint(const PackedJoint& joint, const Motion<S>& v, const S* rate) {
  if (joint.kind == kTurnZ) return {crossZ(v.w, rate[0]), crossZ(v.v, rate[0])};
  if (joint.kind == kSlideZ) return {Vec3<S>::zero(), crossZ(v.w, rate[0])};
  return cross(v, Motion<S>{Vec3<S>::loadU(rate), Vec3<S>::loadU(rate + 3)});
}

// S' f, in the joint's own axes.
template <class S>
inline void jointEffort(const PackedJoint& joint, const Force<S>& f, S* tau) {
  if (joint.kind == kTurnZ) {
    tau[0] = f.n[2];
  } else if (joint.kind == kSlideZ) {
    tau[0] = f.f[2];
  } else {
    f.n.storeU(tau);
    f.f.storeU(tau + 3);
  }
}

// World pose of joint i from its parent's. Needs sine and cosine.
template <class S>
inline void worldPose(const PackedJoint& joint, int i, const S* q, Scratch<S>& s) {
  const Mat3<S>& up = s.R[joint.parent];
  const Mat3<S> T = timesMatrix(up, joint.place);
  s.p[i] = s.p[joint.parent] + times(up, joint.offset);
  if (joint.kind == kTurnZ) {
    const S sn = s.sine[joint.idx_q], cs = s.cosine[joint.idx_q];
    s.R[i] = {T.c0 * cs + T.c1 * sn, T.c1 * cs - T.c0 * sn, T.c2};
  } else if (joint.kind == kSlideZ) {
    s.R[i] = T;
    s.p[i] = s.p[i] + T.c2 * q[joint.idx_q];
  } else {
    s.R[i] = T * quaternionMatrix(q + joint.idx_q + 3);
    s.p[i] = s.p[i] + T * Vec3<S>::loadU(q + joint.idx_q);
  }
}

// The columns of joint i (one per dof), world axes.
template <class S>
inline void worldColumns(const PackedJoint& joint, int i, Scratch<S>& s) {
  Motion<S>* column = &s.column[joint.idx_v];
  const Mat3<S>& R = s.R[i];
  const Vec3<S>& p = s.p[i];
  const Vec3<S> zero = Vec3<S>::zero();
  if (joint.kind == kTurnZ) {
    column[0] = {R.c2, cross(p, R.c2)};
  } else if (joint.kind == kSlideZ) {
    column[0] = {zero, R.c2};
  } else {
    column[0] = {R.c0, cross(p, R.c0)};
    column[1] = {R.c1, cross(p, R.c1)};
    column[2] = {R.c2, cross(p, R.c2)};
    column[3] = {zero, R.c0};
    column[4] = {zero, R.c1};
    column[5] = {zero, R.c2};
  }
}

}  // namespace rbd::inner
