// What a joint kind means inside the kernels: its pose, its motion, its effort. Nowhere else do kernels know
// kinds.
//
// Joints with one axis have been turned so that they move about or along their local z. kTurnZ and kSlideZ
// are nearly all there are and come first everywhere; the rest say where q puts the body (displacement),
// which axes it moves along (S) and no more. The world-axes algorithms take dofs one after the other and see
// no kind at all. All motion subspaces here are constant in the body: S_dot qd = v x S qd. In comments S is
// the book's motion subspace; in the code the type S is the scalar.
#pragma once

#include <cmath>

#include "rbd/kernel/sincos.h"
#include "rbd/kernel/workspace.h"

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

// cos and sin of any length but zero, as a rotation about z.
template <class S>
inline Mat3<S> planeMatrix(S c, S s) {
  using std::sqrt;
  const S scale = S(1) / sqrt(c * c + s * s), o(0);
  return {Vec3<S>::make(c * scale, s * scale, o), Vec3<S>::make(-s * scale, c * scale, o),
          Vec3<S>::make(o, o, S(1))};
}

// Where q puts the body of a joint that neither turns nor slides only, from its place at q = 0.
template <class S>
inline Pose<S> displacement(const PackedJoint& joint, const S* q, const Scratch<S>& s) {
  const S o(0);
  q += joint.idx_q;
  Pose<S> X;
  X.R = Mat3<S>::identity();
  X.p = Vec3<S>::zero();
  switch (joint.kind) {
    case kScrewZ:
      X.R = planeMatrix(s.cosine[joint.idx_q], s.sine[joint.idx_q]);
      X.p = Vec3<S>::make(o, o, q[0] * S(joint.pitch));
      break;
    case kBall:
      X.R = quaternionMatrix(q);
      break;
    case kPlanar:
      X.R = planeMatrix(q[2], q[3]);
      X.p = Vec3<S>::make(q[0], q[1], o);
      break;
    case kTranslate:
      X.p = Vec3<S>::loadU(q);
      break;
    default:
      X.R = quaternionMatrix(q + 3);
      X.p = Vec3<S>::loadU(q);
  }
  return X;
}

// S rate, in the joint's own axes.
template <class S>
inline Motion<S> subspaceTimes(const PackedJoint& joint, const S* rate) {
  const S o(0);
  const Vec3<S> zero = Vec3<S>::zero();
  switch (joint.kind) {
    case kScrewZ:
      return {Vec3<S>::make(o, o, rate[0]), Vec3<S>::make(o, o, rate[0] * S(joint.pitch))};
    case kBall:
      return {Vec3<S>::loadU(rate), zero};
    case kPlanar:
      return {Vec3<S>::make(o, o, rate[2]), Vec3<S>::make(rate[0], rate[1], o)};
    case kTranslate:
      return {zero, Vec3<S>::loadU(rate)};
    default:  // kFree: q has the position first, rates the angular part
      return {Vec3<S>::loadU(rate), Vec3<S>::loadU(rate + 3)};
  }
}

// The same S, dof by dof, for the kinds whose dofs lie along single axes: 0-2 turn about x y z, 3-5 slide.
inline const int* dofAxes(int kind) {
  static constexpr int ball[] = {0, 1, 2}, planar[] = {3, 4, 2}, translate[] = {3, 4, 5},
                       free[] = {0, 1, 2, 3, 4, 5};
  return kind == kBall ? ball : kind == kPlanar ? planar : kind == kTranslate ? translate : free;
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
    const Pose<S> moved = displacement(joint, q, s);
    X.R = place * moved.R;
    X.Rt = X.R.transposed();
    X.p = X.p + place * moved.p;
  }
}

// m + S rate, in the joint's own axes.
template <class S>
inline Motion<S> plusS(const PackedJoint& joint, const Motion<S>& m, const S* rate) {
  const S o(0);
  if (joint.kind == kTurnZ) return {m.w + Vec3<S>::make(o, o, rate[0]), m.v};
  if (joint.kind == kSlideZ) return {m.w, m.v + Vec3<S>::make(o, o, rate[0])};
  return m + subspaceTimes(joint, rate);
}

// v x S rate, in the joint's own axes.
template <class S>
inline Motion<S> crossS(const PackedJoint& joint, const Motion<S>& v, const S* rate) {
  if (joint.kind == kTurnZ) return {crossZ(v.w, rate[0]), crossZ(v.v, rate[0])};
  if (joint.kind == kSlideZ) return {Vec3<S>::zero(), crossZ(v.w, rate[0])};
  return cross(v, subspaceTimes(joint, rate));
}

// S' f, in the joint's own axes.
template <class S>
inline void transposeS(const PackedJoint& joint, const Force<S>& f, S* tau) {
  if (joint.kind == kTurnZ) {
    tau[0] = f.n[2];
  } else if (joint.kind == kSlideZ) {
    tau[0] = f.f[2];
  } else if (joint.kind == kScrewZ) {
    tau[0] = f.n[2] + f.f[2] * S(joint.pitch);
  } else {
    const int* axis = dofAxes(joint.kind);
    for (int k = 0; k < joint.nv; ++k) tau[k] = axis[k] < 3 ? f.n[axis[k]] : f.f[axis[k] - 3];
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
    const Pose<S> moved = displacement(joint, q, s);
    s.R[i] = T * moved.R;
    s.p[i] = s.p[i] + T * moved.p;
  }
}

// The columns of S of joint i (one per dof), world axes.
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
  } else if (joint.kind == kScrewZ) {
    column[0] = {R.c2, cross(p, R.c2) + R.c2 * S(joint.pitch)};
  } else {
    const Vec3<S> axes[] = {R.c0, R.c1, R.c2};
    const int* axis = dofAxes(joint.kind);
    for (int k = 0; k < joint.nv; ++k) {
      if (axis[k] < 3) {
        column[k] = {axes[axis[k]], cross(p, axes[axis[k]])};
      } else {
        column[k] = {zero, axes[axis[k] - 3]};
      }
    }
  }
}

}  // namespace rbd::inner
