// The joint kinds inside the kernels: pose, motion and effort of each. No other file of the kernels
// distinguishes kinds.
//
// Single-axis joints are aligned so that they move about or along their local z. TurnZ and SlideZ are by far
// the most frequent kinds and are tested first; the others define only the pose of the body for a given q
// (displacement) and its axes of motion (S). The switches have no default: a new kind compiles only when all
// of them handle it. The world-axes algorithms work dof by dof and do not depend on kinds. All motion
// subspaces here are constant in body axes: S_dot qd = v x S qd.
#pragma once

#include <cmath>

#include "rbd/kernel/sincos.h"
#include "rbd/kernel/workspace.h"

namespace rbd::inner {

// m * v for v in packed constants: scalars loaded from memory can be broadcast to all lanes directly.
template <class Scalar>
inline Vec3<Scalar> times(const Mat3<Scalar>& m, const double* v) {
  return m.c0 * Scalar(v[0]) + m.c1 * Scalar(v[1]) + m.c2 * Scalar(v[2]);
}

template <class Scalar>
inline Mat3<Scalar> timesMatrix(const Mat3<Scalar>& m, const double* b) {
  return {times(m, b), times(m, b + 4), times(m, b + 8)};
}

// R of a quaternion (x, y, z, w) of any nonzero length.
template <class Scalar>
inline Mat3<Scalar> quaternionMatrix(const Scalar* q) {
  const Scalar x = q[0], y = q[1], z = q[2], w = q[3];
  const Scalar s = Scalar(2) / (x * x + y * y + z * z + w * w);
  const Scalar o(1);
  return {Vec3<Scalar>::make(o - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
          Vec3<Scalar>::make(s * (x * y - z * w), o - s * (x * x + z * z), s * (y * z + x * w)),
          Vec3<Scalar>::make(s * (x * z + y * w), s * (y * z - x * w), o - s * (x * x + y * y))};
}

// Rotation about z from (cos, sin) of any nonzero length.
template <class Scalar>
inline Mat3<Scalar> planeMatrix(Scalar c, Scalar s) {
  using std::sqrt;
  const Scalar scale = Scalar(1) / sqrt(c * c + s * s), o(0);
  return {Vec3<Scalar>::make(c * scale, s * scale, o), Vec3<Scalar>::make(-s * scale, c * scale, o),
          Vec3<Scalar>::make(o, o, Scalar(1))};
}

// Pose of the body at q in its frame at q = 0. For TurnZ and SlideZ the callers have faster code.
template <class Scalar>
inline Pose<Scalar> displacement(const PackedJoint& joint, const Scalar* q, const Scratch<Scalar>& s) {
  const Scalar o(0);
  q += joint.idx_q;
  Pose<Scalar> X;
  X.R = Mat3<Scalar>::identity();
  X.p = Vec3<Scalar>::zero();
  switch (joint.kind) {
    case KernelKind::ScrewZ:
      X.R = planeMatrix(s.cosine[joint.idx_q], s.sine[joint.idx_q]);
      X.p = Vec3<Scalar>::make(o, o, q[0] * Scalar(joint.pitch));
      break;
    case KernelKind::Ball:
      X.R = quaternionMatrix(q);
      break;
    case KernelKind::Planar:
      X.R = planeMatrix(q[2], q[3]);
      X.p = Vec3<Scalar>::make(q[0], q[1], o);
      break;
    case KernelKind::Translate:
      X.p = Vec3<Scalar>::loadU(q);
      break;
    case KernelKind::Free:
      X.R = quaternionMatrix(q + 3);
      X.p = Vec3<Scalar>::loadU(q);
      break;
    case KernelKind::None:
    case KernelKind::TurnZ:
    case KernelKind::SlideZ:
      break;
  }
  return X;
}

// S rate, in the joint's own axes. For TurnZ and SlideZ the callers have faster code.
template <class Scalar>
inline SpatialMotion<Scalar> subspaceTimes(const PackedJoint& joint, const Scalar* rate) {
  const Scalar o(0);
  const Vec3<Scalar> zero = Vec3<Scalar>::zero();
  switch (joint.kind) {
    case KernelKind::ScrewZ:
      return {Vec3<Scalar>::make(o, o, rate[0]), Vec3<Scalar>::make(o, o, rate[0] * Scalar(joint.pitch))};
    case KernelKind::Ball:
      return {Vec3<Scalar>::loadU(rate), zero};
    case KernelKind::Planar:
      return {Vec3<Scalar>::make(o, o, rate[2]), Vec3<Scalar>::make(rate[0], rate[1], o)};
    case KernelKind::Translate:
      return {zero, Vec3<Scalar>::loadU(rate)};
    case KernelKind::Free:  // q has the position first, rates the angular part
      return {Vec3<Scalar>::loadU(rate), Vec3<Scalar>::loadU(rate + 3)};
    case KernelKind::None:
    case KernelKind::TurnZ:
    case KernelKind::SlideZ:
      break;
  }
  return SpatialMotion<Scalar>::zero();
}

// The same S, dof by dof, for the kinds whose dofs lie along single axes: 0-2 rotate about x y z, 3-5 slide. The first nv
// count.
inline const int* dofAxes(KernelKind kind) {
  static constexpr int turn_z[6] = {2}, slide_z[6] = {5}, ball[6] = {0, 1, 2}, planar[6] = {3, 4, 2},
                       translate[6] = {3, 4, 5}, free[6] = {0, 1, 2, 3, 4, 5};
  switch (kind) {
    case KernelKind::TurnZ:
      return turn_z;
    case KernelKind::SlideZ:
      return slide_z;
    case KernelKind::Ball:
      return ball;
    case KernelKind::Planar:
      return planar;
    case KernelKind::Translate:
      return translate;
    case KernelKind::Free:
      return free;
    case KernelKind::None:
    case KernelKind::ScrewZ:
      break;  // no dof; two axes at once
  }
  __builtin_unreachable();
}

// Largest distance (m) of the body's origin from its position at q = 0, for |q[k]| <= largest(k).
template <class Largest>
inline double largestDisplacement(const PackedJoint& joint, Largest&& largest) {
  const int q = joint.idx_q;
  switch (joint.kind) {
    case KernelKind::None:
    case KernelKind::TurnZ:
    case KernelKind::Ball:
      return 0;
    case KernelKind::SlideZ:
      return largest(q);
    case KernelKind::ScrewZ:
      return std::abs(joint.pitch) * largest(q);
    case KernelKind::Planar:
      return std::hypot(largest(q), largest(q + 1));
    case KernelKind::Translate:
    case KernelKind::Free:
      return std::hypot(largest(q), largest(q + 1), largest(q + 2));
  }
  __builtin_unreachable();
}

// Pose of joint i in its parent, with R and its transpose. Needs sine and cosine.
template <class Scalar>
inline void jointPose(const PackedJoint& joint, const Scalar* q, const Scratch<Scalar>& s, Pose<Scalar>& X) {
  const Mat3<Scalar> R_parent = Mat3<Scalar>::load(joint.R_parent);
  X.p = Vec3<Scalar>::load(joint.p_parent);
  if (joint.kind == KernelKind::TurnZ) {
    const Scalar sn = s.sine[joint.idx_q], cs = s.cosine[joint.idx_q];
    X.R = {R_parent.c0 * cs + R_parent.c1 * sn, R_parent.c1 * cs - R_parent.c0 * sn, R_parent.c2};
    X.Rt = X.R.transposed();
  } else if (joint.kind == KernelKind::SlideZ) {
    X.R = R_parent;
    X.Rt = Mat3<Scalar>::load(joint.R_parent_T);
    X.p = X.p + R_parent.c2 * q[joint.idx_q];
  } else {
    const Pose<Scalar> moved = displacement(joint, q, s);
    X.R = R_parent * moved.R;
    X.Rt = X.R.transposed();
    X.p = X.p + R_parent * moved.p;
  }
}

// m + S rate, in the joint's own axes.
template <class Scalar>
inline SpatialMotion<Scalar> plusS(const PackedJoint& joint, const SpatialMotion<Scalar>& m,
                                   const Scalar* rate) {
  const Scalar o(0);
  if (joint.kind == KernelKind::TurnZ) return {m.w + Vec3<Scalar>::make(o, o, rate[0]), m.v};
  if (joint.kind == KernelKind::SlideZ) return {m.w, m.v + Vec3<Scalar>::make(o, o, rate[0])};
  return m + subspaceTimes(joint, rate);
}

// v x S rate, in the joint's own axes.
template <class Scalar>
inline SpatialMotion<Scalar> crossS(const PackedJoint& joint, const SpatialMotion<Scalar>& v,
                                    const Scalar* rate) {
  if (joint.kind == KernelKind::TurnZ) return {crossZ(v.w, rate[0]), crossZ(v.v, rate[0])};
  if (joint.kind == KernelKind::SlideZ) return {Vec3<Scalar>::zero(), crossZ(v.w, rate[0])};
  return cross(v, subspaceTimes(joint, rate));
}

// S' f, in the joint's own axes.
template <class Scalar>
inline void transposeS(const PackedJoint& joint, const SpatialForce<Scalar>& f, Scalar* tau) {
  if (joint.kind == KernelKind::TurnZ) {
    tau[0] = f.n[2];
  } else if (joint.kind == KernelKind::SlideZ) {
    tau[0] = f.f[2];
  } else if (joint.kind == KernelKind::ScrewZ) {
    tau[0] = f.n[2] + f.f[2] * Scalar(joint.pitch);
  } else {
    const int* axis = dofAxes(joint.kind);
    for (int k = 0; k < joint.nv; ++k) tau[k] = axis[k] < 3 ? f.n[axis[k]] : f.f[axis[k] - 3];
  }
}

// World pose of joint i from its parent's. Needs sine and cosine.
template <class Scalar>
inline void worldPose(const PackedJoint& joint, int i, const Scalar* q, Scratch<Scalar>& s) {
  const Mat3<Scalar>& up = s.R[joint.parent];
  const Mat3<Scalar> T = timesMatrix(up, joint.R_parent);
  s.p[i] = s.p[joint.parent] + times(up, joint.p_parent);
  if (joint.kind == KernelKind::TurnZ) {
    const Scalar sn = s.sine[joint.idx_q], cs = s.cosine[joint.idx_q];
    s.R[i] = {T.c0 * cs + T.c1 * sn, T.c1 * cs - T.c0 * sn, T.c2};
  } else if (joint.kind == KernelKind::SlideZ) {
    s.R[i] = T;
    s.p[i] = s.p[i] + T.c2 * q[joint.idx_q];
  } else {
    const Pose<Scalar> moved = displacement(joint, q, s);
    s.R[i] = T * moved.R;
    s.p[i] = s.p[i] + T * moved.p;
  }
}

// The columns of S of joint i (one per dof), world axes.
template <class Scalar>
inline void worldSubspace(const PackedJoint& joint, int i, Scratch<Scalar>& s) {
  SpatialMotion<Scalar>* S = &s.S[joint.idx_v];
  const Mat3<Scalar>& R = s.R[i];
  const Vec3<Scalar>& p = s.p[i];
  const Vec3<Scalar> zero = Vec3<Scalar>::zero();
  if (joint.kind == KernelKind::TurnZ) {
    S[0] = {R.c2, cross(p, R.c2)};
  } else if (joint.kind == KernelKind::SlideZ) {
    S[0] = {zero, R.c2};
  } else if (joint.kind == KernelKind::ScrewZ) {
    S[0] = {R.c2, cross(p, R.c2) + R.c2 * Scalar(joint.pitch)};
  } else {
    const Vec3<Scalar> axes[] = {R.c0, R.c1, R.c2};
    const int* axis = dofAxes(joint.kind);
    for (int k = 0; k < joint.nv; ++k) {
      if (axis[k] < 3) {
        S[k] = {axes[axis[k]], cross(p, axes[axis[k]])};
      } else {
        S[k] = {zero, axes[axis[k] - 3]};
      }
    }
  }
}

}  // namespace rbd::inner
