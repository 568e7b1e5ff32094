// The configuration spaces of joints, each with the same operations on plain arrays. traits() in
// model/joint.h assigns one to each joint kind.
//   twist(v):           v as a body twist; add(v, m): v plus the part of a twist m that lies in the space
//   adjointInverse(v):  Ad(exp v)^-1, the derivative of integrate(q, v) in q
//   rightJacobian(v):   the derivative of integrate(q, v) in v; and its inverse
// Source: Sola, Deray, Atchuthan, A micro Lie theory, 2018.
#pragma once

#include <algorithm>
#include <cmath>

#include "rbd/kernel/sincos.h"
#include "rbd/model/model.h"
#include "rbd/spatial/rotation_series.h"
#include "rbd/spatial/spatial.h"

namespace rbd::inner {

inline Eigen::Quaterniond quaternion(const double* q) {
  return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized();
}

// The rotation by |w| about w: exp3Quaternion(w) and leftJacobian3(w) x, both from one sine and cosine.
class RotationStep {
 public:
  explicit RotationStep(const double* w) : w_(w[0], w[1], w[2]) {
    const double t = w_.norm(), half = t / 2;
    double s[4], c[4];
    sincosAll(1, &half, s, c);
    cosine_ = c[0];
    sine_over_t_ = halfSineOverAngle(t, s[0]);
    second_ = secondTerm(t, 2 * s[0] * c[0]);
  }
  // q times this rotation. Its length differs from 1 only by rounding, so one Newton step normalises it.
  Eigen::Quaterniond appliedTo(const Eigen::Quaterniond& q) const {
    const Eigen::Vector3d xyz = sine_over_t_ * w_;
    const Eigen::Vector4d end = (q * Eigen::Quaterniond(cosine_, xyz.x(), xyz.y(), xyz.z())).coeffs();
    return Eigen::Quaterniond((1.5 - 0.5 * end.squaredNorm()) * end);
  }
  // Displacement, in the initial axes, of a body that moves with the constant body twist (w, x) for time 1.
  Eigen::Vector3d displacement(const Eigen::Vector3d& x) const {
    const Eigen::Vector3d wx = w_.cross(x);
    return x + 2 * sine_over_t_ * sine_over_t_ * wx + second_ * w_.cross(wx);
  }

 private:
  Eigen::Vector3d w_;
  double cosine_, sine_over_t_, second_;  // cos(t/2), sin(t/2) / t, (t - sin t) / t^3
};

using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

// Rotations: unit quaternions, velocities in body axes.
struct RotationSpace {
  static Eigen::Vector3d vec(const double* v) { return {v[0], v[1], v[2]}; }
  static Motion twist(const double* v) { return {vec(v), Eigen::Vector3d::Zero()}; }
  static void add(const double* v, const Vector6d& more, double* out) {
    for (int k = 0; k < 3; ++k) out[k] = v[k] + more[k];
  }
  static SmallMatrix adjointInverse(const double* v) { return exp3(-vec(v)); }
  static SmallMatrix rightJacobian(const double* v) { return leftJacobian3(-vec(v)); }
  static SmallMatrix rightJacobianInverse(const double* v) { return leftJacobian3Inverse(-vec(v)); }
  static void integrate(const double* q, const double* v, double* out) {
    const Eigen::Quaterniond end = RotationStep(v).appliedTo(quaternion(q));
    for (int k = 0; k < 4; ++k) out[k] = end.coeffs()[k];
  }
  static void difference(const double* q0, const double* q1, double* out) {
    const Eigen::Vector3d w = log3((quaternion(q0).conjugate() * quaternion(q1)).normalized());
    for (int k = 0; k < 3; ++k) out[k] = w[k];
  }
};

// Poses: position and unit quaternion, velocities are body twists.
struct PoseSpace {
  static Motion twist(const double* v) { return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; }
  static void add(const double* v, const Vector6d& more, double* out) {
    for (int k = 0; k < 6; ++k) out[k] = v[k] + more[k];
  }
  static Motion minus(const double* v) { return {{-v[0], -v[1], -v[2]}, {-v[3], -v[4], -v[5]}}; }
  static SmallMatrix adjointInverse(const double* v) { return exp6(minus(v)).toActionMatrix(); }
  static SmallMatrix rightJacobian(const double* v) { return leftJacobian6(minus(v)); }
  static SmallMatrix rightJacobianInverse(const double* v) { return leftJacobian6Inverse(minus(v)); }
  static void integrate(const double* q, const double* v, double* out) {
    const RotationStep step(v);
    const Eigen::Quaterniond start = quaternion(q + 3), end = step.appliedTo(start);
    const Eigen::Vector3d moved = start * step.displacement({v[3], v[4], v[5]});
    for (int k = 0; k < 3; ++k) out[k] = q[k] + moved[k];
    for (int k = 0; k < 4; ++k) out[3 + k] = end.coeffs()[k];
  }
  // through quaternions, which stay accurate up to half a turn
  static void difference(const double* q0, const double* q1, double* out) {
    RotationSpace::difference(q0 + 3, q1 + 3, out);
    const Eigen::Vector3d between(q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]);
    const Eigen::Vector3d v =
        leftJacobian3Inverse({out[0], out[1], out[2]}) * (quaternion(q0 + 3).conjugate() * between);
    for (int k = 0; k < 3; ++k) out[3 + k] = v[k];
  }
};

// Poses in a plane: x y cos sin, velocities (vx, vy, w) in body axes. PoseSpace with rotation about z only.
struct PlanarSpace {
  static constexpr int kAxis[] = {3, 4, 2};  // of (vx, vy, w) in a twist
  static SmallMatrix inPlane(const SmallMatrix& all) {
    SmallMatrix out(3, 3);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) out(r, c) = all(kAxis[r], kAxis[c]);
    }
    return out;
  }
  static Motion twist(const double* v) { return {{0, 0, v[2]}, {v[0], v[1], 0}}; }
  static void add(const double* v, const Vector6d& more, double* out) {
    for (int k = 0; k < 3; ++k) out[k] = v[k] + more[kAxis[k]];
  }
  struct Twist {
    explicit Twist(const double* v) : x{0, 0, v[2], v[0], v[1], 0} {}
    double x[6];
  };
  static SmallMatrix adjointInverse(const double* v) {
    return inPlane(PoseSpace::adjointInverse(Twist(v).x));
  }
  static SmallMatrix rightJacobian(const double* v) { return inPlane(PoseSpace::rightJacobian(Twist(v).x)); }
  static SmallMatrix rightJacobianInverse(const double* v) {
    return inPlane(PoseSpace::rightJacobianInverse(Twist(v).x));
  }
  static void lift(const double* q, double* pose) {
    // half-angle formulas without atan2: the larger of 1 + c and 1 - c is used, for precision
    const double n = std::hypot(q[2], q[3]), c = q[2] / n, s = q[3] / n;
    const double w = c >= 0 ? std::sqrt((1 + c) / 2) : std::abs(s) / std::sqrt(2 * (1 - c));
    const double z = c >= 0 ? s / (2 * w) : std::copysign(std::sqrt((1 - c) / 2), s);
    const double all[7] = {q[0], q[1], 0, 0, 0, z, w};
    std::copy(all, all + 7, pose);
  }
  static void integrate(const double* q, const double* v, double* out) {
    double pose[7], end[7];
    lift(q, pose);
    PoseSpace::integrate(pose, Twist(v).x, end);
    out[0] = end[0];
    out[1] = end[1];
    out[2] = 1 - 2 * end[5] * end[5];
    out[3] = 2 * end[5] * end[6];
  }
  static void difference(const double* q0, const double* q1, double* out) {
    double a[7], b[7], twist[6];
    lift(q0, a);
    lift(q1, b);
    PoseSpace::difference(a, b, twist);
    out[0] = twist[3];
    out[1] = twist[4];
    out[2] = twist[2];
  }
};

// For each block of q and v in order, calls numbers(idx_q, idx_v, count) or, for a rotation or a pose,
// space(space, idx_q, idx_v).
template <class Numbers, class Space>
inline void forEachBlock(const Model& model, Numbers&& numbers, Space&& space) {
  if (model.nq == model.nv) return numbers(0, 0, model.nv);
  for (const ConfigurationBlock& block : model.tree().blocks) {
    switch (block.manifold) {
      case Manifold::Angles:
      case Manifold::Lengths:
        numbers(block.idx_q, block.idx_v, block.nv);
        break;
      case Manifold::Rotation:
        space(RotationSpace(), block.idx_q, block.idx_v);
        break;
      case Manifold::PlanarPose:
        space(PlanarSpace(), block.idx_q, block.idx_v);
        break;
      case Manifold::Pose:
        space(PoseSpace(), block.idx_q, block.idx_v);
        break;
    }
  }
}

}  // namespace rbd::inner
