#include "rbd/algorithm/configuration.h"

#include <algorithm>
#include <cmath>

#include "rbd/algorithm/inner/check.h"

// One function per operation, each with the kinds' differences in one place: a joint that is not a free-flyer
// adds and subtracts its numbers.

namespace rbd {
namespace {

Eigen::Quaterniond quaternion(const double* q) {
  return Eigen::Quaterniond(q[6], q[3], q[4], q[5]).normalized();
}

// Position and unit quaternion moved by the body twist v.
void integrateFree(const double* q, const double* v, double* out) {
  const Eigen::Vector3d w(v[0], v[1], v[2]), step = leftJacobian3(w) * Eigen::Vector3d(v[3], v[4], v[5]);
  const Eigen::Quaterniond start = quaternion(q), end = (start * exp3Quaternion(w)).normalized();
  const Eigen::Vector3d moved = Eigen::Vector3d(q[0], q[1], q[2]) + start * step;
  for (int k = 0; k < 3; ++k) {
    out[k] = moved[k];
    out[3 + k] = end.vec()[k];
  }
  out[6] = end.w();
}

// The body twist from q0 to q1 in unit time; through quaternions, which stay accurate up to half a turn.
void differenceFree(const double* q0, const double* q1, double* out) {
  const Eigen::Quaterniond start = quaternion(q0);
  const Eigen::Vector3d w = log3((start.conjugate() * quaternion(q1)).normalized());
  const Eigen::Vector3d way(q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]);
  const Eigen::Vector3d v = leftJacobian3Inverse(w) * (start.conjugate() * way);
  for (int k = 0; k < 3; ++k) {
    out[k] = w[k];
    out[3 + k] = v[k];
  }
}

void checkConfiguration(const char* function, const char* name, const Model& model, const ConstVectorRef& q) {
  inner::checkQ(function, name, model, q);
  if (model.nq != model.nv) inner::checkQuaternions(function, model, q);
}

// In [0, 1), from the top 53 bits: the same on every machine, unlike the standard's distributions.
double unit(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11) * 0x1p-53; }

double between(std::mt19937_64& engine, double lower, double upper, double fallback) {
  const double a = std::isfinite(lower) ? lower : std::min(-fallback, upper);
  const double b = std::isfinite(upper) ? upper : std::max(fallback, lower);
  return a + (b - a) * unit(engine);
}

// Shoemake 1992: even over all rotations.
Eigen::Quaterniond randomRotation(std::mt19937_64& engine) {
  const double u = unit(engine), a = 2 * PI<double>() * unit(engine), b = 2 * PI<double>() * unit(engine);
  const double s = std::sqrt(1 - u), t = std::sqrt(u);
  return {t * std::cos(b), s * std::sin(a), s * std::cos(a), t * std::sin(b)};
}

}  // namespace

void neutral(const Model& model, VectorRef q) {
  inner::checkOut("neutral", "q", model, q, model.nq, "nq");
  q.setZero();
  for (const JointModel& joint : model.joints) {
    if (joint.kind() == JointKind::FreeFlyer) q[joint.idx_q() + 6] = 1;
  }
}

Eigen::VectorXd neutral(const Model& model) {
  Eigen::VectorXd q(model.nq);
  neutral(model, q);
  return q;
}

void randomConfiguration(const Model& model, std::mt19937_64& engine, VectorRef q) {
  inner::checkOut("randomConfiguration", "q", model, q, model.nq, "nq");
  for (const JointModel& joint : model.joints) {
    const int at = joint.idx_q();
    const bool free = joint.kind() == JointKind::FreeFlyer;
    const bool metres = free || joint.kind() == JointKind::Prismatic;
    const int plain = free ? 3 : joint.nq();
    for (int k = at; k < at + plain; ++k) {
      q[k] = between(engine, model.lowerPositionLimit[k], model.upperPositionLimit[k],
                     metres ? 1 : PI<double>());
    }
    if (free) q.segment<4>(at + 3) = randomRotation(engine).coeffs();
  }
}

Eigen::VectorXd randomConfiguration(const Model& model, std::mt19937_64& engine) {
  Eigen::VectorXd q(model.nq);
  randomConfiguration(model, engine, q);
  return q;
}

Eigen::VectorXd randomConfiguration(const Model& model, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  return randomConfiguration(model, engine);
}

Eigen::VectorXd randomConfiguration(const Model& model) {
  thread_local std::mt19937_64 engine(20240229);
  return randomConfiguration(model, engine);
}

void integrate(const Model& model, const ConstVectorRef& q, const ConstVectorRef& v, VectorRef out) {
  checkConfiguration("integrate", "q", model, q);
  inner::checkV("integrate", "v", model, v);
  inner::checkOut("integrate", "out", model, out, model.nq, "nq");
  for (const JointModel& joint : model.joints) {
    const int iq = joint.idx_q(), iv = joint.idx_v();
    if (joint.kind() == JointKind::FreeFlyer) {
      integrateFree(q.data() + iq, v.data() + iv, out.data() + iq);
    } else {
      for (int k = 0; k < joint.nq(); ++k) out[iq + k] = q[iq + k] + v[iv + k];
    }
  }
}

Eigen::VectorXd integrate(const Model& model, const ConstVectorRef& q, const ConstVectorRef& v) {
  Eigen::VectorXd out(model.nq);
  integrate(model, q, v, out);
  return out;
}

void difference(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, VectorRef out) {
  checkConfiguration("difference", "q0", model, q0);
  checkConfiguration("difference", "q1", model, q1);
  inner::checkOut("difference", "out", model, out, model.nv, "nv");
  for (const JointModel& joint : model.joints) {
    const int iq = joint.idx_q(), iv = joint.idx_v();
    if (joint.kind() == JointKind::FreeFlyer) {
      differenceFree(q0.data() + iq, q1.data() + iq, out.data() + iv);
    } else {
      for (int k = 0; k < joint.nq(); ++k) out[iv + k] = q1[iq + k] - q0[iq + k];
    }
  }
}

Eigen::VectorXd difference(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1) {
  Eigen::VectorXd out(model.nv);
  difference(model, q0, q1, out);
  return out;
}

void interpolate(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, double s,
                 VectorRef out) {
  checkConfiguration("interpolate", "q0", model, q0);
  checkConfiguration("interpolate", "q1", model, q1);
  inner::checkOut("interpolate", "out", model, out, model.nq, "nq");
  for (const JointModel& joint : model.joints) {
    const int iq = joint.idx_q();
    if (joint.kind() == JointKind::FreeFlyer) {
      Vector6d twist;
      differenceFree(q0.data() + iq, q1.data() + iq, twist.data());
      twist *= s;
      integrateFree(q0.data() + iq, twist.data(), out.data() + iq);
    } else {
      for (int k = iq; k < iq + joint.nq(); ++k) out[k] = q0[k] + s * (q1[k] - q0[k]);
    }
  }
}

Eigen::VectorXd interpolate(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1,
                            double s) {
  Eigen::VectorXd out(model.nq);
  interpolate(model, q0, q1, s, out);
  return out;
}

void normalize(const Model& model, VectorRef q) {
  checkConfiguration("normalize", "q", model, q);
  for (const JointModel& joint : model.joints) {
    if (joint.kind() == JointKind::FreeFlyer) q.segment<4>(joint.idx_q() + 3).normalize();
  }
}

}  // namespace rbd
