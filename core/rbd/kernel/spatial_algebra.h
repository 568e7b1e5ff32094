// Spatial vectors and inertias of the kernels. Names and rules as in Featherstone 2008, tables 2.1 to 2.3 and
// appendix A.
//
// Motion (w, v), Force (n, f), angular first. The rigid inertia is (m, h = m c, I about the ORIGIN): three
// terms that simply add when all bodies are expressed about one point in one set of axes.
#pragma once

#include "rbd/kernel/vec3.h"

namespace rbd::inner {

template <class Scalar>
struct SpatialForce {
  Vec3<Scalar> n, f;
  static SpatialForce zero() { return {Vec3<Scalar>::zero(), Vec3<Scalar>::zero()}; }
  friend SpatialForce operator+(const SpatialForce& a, const SpatialForce& b) {
    return {a.n + b.n, a.f + b.f};
  }
  friend SpatialForce operator-(const SpatialForce& a, const SpatialForce& b) {
    return {a.n - b.n, a.f - b.f};
  }
  friend SpatialForce operator*(const SpatialForce& a, Scalar s) { return {a.n * s, a.f * s}; }
};

template <class Scalar>
struct SpatialMotion {
  Vec3<Scalar> w, v;
  static SpatialMotion zero() { return {Vec3<Scalar>::zero(), Vec3<Scalar>::zero()}; }
  friend SpatialMotion operator+(const SpatialMotion& a, const SpatialMotion& b) {
    return {a.w + b.w, a.v + b.v};
  }
  friend SpatialMotion operator-(const SpatialMotion& a, const SpatialMotion& b) {
    return {a.w - b.w, a.v - b.v};
  }
  friend SpatialMotion operator*(const SpatialMotion& a, Scalar s) { return {a.w * s, a.v * s}; }
  friend Scalar dot(const SpatialMotion& m, const SpatialForce<Scalar>& f) {
    return dot2(m.w, f.n, m.v, f.f);
  }
  // v x m
  friend SpatialMotion cross(const SpatialMotion& a, const SpatialMotion& m) {
    return {cross(a.w, m.w), cross(a.w, m.v) + cross(a.v, m.w)};
  }
  // v x* f
  friend SpatialForce<Scalar> crossForce(const SpatialMotion& a, const SpatialForce<Scalar>& f) {
    return {cross(a.w, f.n) + cross(a.v, f.f), cross(a.w, f.f)};
  }
};

template <class Scalar>
struct RigidInertia {
  Mat3<Scalar> I;  // about the origin
  Vec3<Scalar> h;  // mass * centre of mass
  Scalar m;
  friend RigidInertia operator+(const RigidInertia& a, const RigidInertia& b) {
    return {a.I + b.I, a.h + b.h, a.m + b.m};
  }
  friend SpatialForce<Scalar> operator*(const RigidInertia& i, const SpatialMotion<Scalar>& v) {
    return {i.I * v.w + cross(i.h, v.v), v.v * i.m - cross(i.h, v.w)};
  }
};

// The Coriolis inertia of a moving body: B m = 1/2 (v x* I m + m x* I v - I (v x m)). Of its 6x6 entries only
// a 3x3 block N and the linear momentum p are nonzero: B m = (N w, -p x w). Coriolis inertias add like rigid
// ones. Source: Echeandia, Wensing, Numerical methods to compute the Coriolis matrix, 2021.
template <class Scalar>
struct CoriolisInertia {
  Mat3<Scalar> N;
  Vec3<Scalar> p;

  // Of a body of inertia I that moves with v. With J = sum of m r r', the second moments of its mass:
  // N x = -w x (J x) - h x (u x x), with u = v.v.
  static CoriolisInertia of(const RigidInertia<Scalar>& I, const SpatialMotion<Scalar>& v) {
    const Scalar o(0), half = (I.I.c0[0] + I.I.c1[1] + I.I.c2[2]) * Scalar(0.5), hu = dot(I.h, v.v);
    const auto column = [&](const Vec3<Scalar>& Ik, int k, const Vec3<Scalar>& e) {
      return cross(e * half - Ik, v.w) - v.v * I.h[k] + e * hu;
    };
    return {{column(I.I.c0, 0, Vec3<Scalar>::make(Scalar(1), o, o)),
             column(I.I.c1, 1, Vec3<Scalar>::make(o, Scalar(1), o)),
             column(I.I.c2, 2, Vec3<Scalar>::make(o, o, Scalar(1)))},
            v.v * I.m - cross(I.h, v.w)};
  }
  friend CoriolisInertia operator+(const CoriolisInertia& a, const CoriolisInertia& b) {
    return {a.N + b.N, a.p + b.p};
  }
  friend SpatialForce<Scalar> operator*(const CoriolisInertia& b, const SpatialMotion<Scalar>& m) {
    return {b.N * m.w, cross(m.w, b.p)};
  }
  // B' m, as a force: dot(a, B' m) = dot(m, B a).
  SpatialForce<Scalar> transposeTimes(const SpatialMotion<Scalar>& m) const {
    return {Vec3<Scalar>::make(dot(N.c0, m.w), dot(N.c1, m.w), dot(N.c2, m.w)) + cross(p, m.v),
            Vec3<Scalar>::zero()};
  }
};

// The articulated-body inertia: a full symmetric 6x6 as columns. (n; f) = [A B; B' M] (w; v).
// Both B and its transpose are stored, so that a product is twelve multiply-adds without any shuffle.
template <class Scalar>
struct ArticulatedInertia {
  Mat3<Scalar> A, B, Bt, M;

  static ArticulatedInertia rigid(const RigidInertia<Scalar>& r) {
    const Scalar o(0);
    const Mat3<Scalar> hx = {Vec3<Scalar>::make(o, r.h[2], -r.h[1]), Vec3<Scalar>::make(-r.h[2], o, r.h[0]),
                             Vec3<Scalar>::make(r.h[1], -r.h[0], o)};
    return {r.I,
            hx,
            {-hx.c0, -hx.c1, -hx.c2},
            {Vec3<Scalar>::make(r.m, o, o), Vec3<Scalar>::make(o, r.m, o), Vec3<Scalar>::make(o, o, r.m)}};
  }
  friend ArticulatedInertia operator+(const ArticulatedInertia& a, const ArticulatedInertia& b) {
    return {a.A + b.A, a.B + b.B, a.Bt + b.Bt, a.M + b.M};
  }
  friend SpatialForce<Scalar> operator*(const ArticulatedInertia& i, const SpatialMotion<Scalar>& v) {
    return {i.A * v.w + i.B * v.v, i.Bt * v.w + i.M * v.v};
  }
  // minus U U' / D
  void subtract(const SpatialForce<Scalar>& U, Scalar inverse_d) {
    const SpatialForce<Scalar> u = U * inverse_d;
    A = {A.c0 - U.n * u.n[0], A.c1 - U.n * u.n[1], A.c2 - U.n * u.n[2]};
    B = {B.c0 - U.n * u.f[0], B.c1 - U.n * u.f[1], B.c2 - U.n * u.f[2]};
    Bt = {Bt.c0 - U.f * u.n[0], Bt.c1 - U.f * u.n[1], Bt.c2 - U.f * u.n[2]};
    M = {M.c0 - U.f * u.f[0], M.c1 - U.f * u.f[1], M.c2 - U.f * u.f[2]};
  }
};

// A child frame in its parent: R takes child to parent coordinates, Rt back, p is the child's origin in the
// parent.
template <class Scalar>
struct Pose {
  Mat3<Scalar> R, Rt;
  Vec3<Scalar> p;
  // Motion from parent to child coordinates (Featherstone: X m).
  SpatialMotion<Scalar> toChild(const SpatialMotion<Scalar>& m) const {
    return {Rt * m.w, Rt * (m.v - cross(p, m.w))};
  }
  // Force from child to parent coordinates (Featherstone: X' f).
  SpatialForce<Scalar> toParent(const SpatialForce<Scalar>& f) const {
    const Vec3<Scalar> ff = R * f.f;
    return {R * f.n + cross(p, ff), ff};
  }
};

}  // namespace rbd::inner
