#include "rbd/algorithm/configuration.h"

#include <algorithm>
#include <cmath>

#include "rbd/algorithm/argument_checks.h"
#include "rbd/kernel/manifold.h"

namespace rbd {
namespace {

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

// f(x) for every entry x of difference(q0, q1).
template <class F>
void forEachDifference(const char* function, const Model& model, const ConstVectorRef& q0,
                       const ConstVectorRef& q1, F&& f) {
  checkConfiguration(function, "q0", model, q0);
  checkConfiguration(function, "q1", model, q1);
  inner::forEachBlock(
      model,
      [&](int iq, int, int n) {
        for (int k = iq; k < iq + n; ++k) f(q1[k] - q0[k]);
      },
      [&](const auto& space, int iq, int) {
        double d[6] = {0, 0, 0, 0, 0, 0};
        space.difference(q0.data() + iq, q1.data() + iq, d);
        for (const double x : d) f(x);
      });
}

}  // namespace

void neutral(const Model& model, VectorRef q) {
  inner::checkOut("neutral", "q", model, q, model.nq, "nq");
  q.setZero();
  for (const ConfigurationBlock& block : model.tree().blocks) {
    if (block.unit_size == 4) q[block.unit_at + 3] = 1;
    if (block.unit_size == 2) q[block.unit_at] = 1;
  }
}

Eigen::VectorXd neutral(const Model& model) {
  Eigen::VectorXd q(model.nq);
  neutral(model, q);
  return q;
}

void randomConfiguration(const Model& model, std::mt19937_64& engine, const ConstVectorRef& lower,
                         const ConstVectorRef& upper, VectorRef q) {
  const char* const name = "randomConfiguration";
  inner::checkOut(name, "q", model, q, model.nq, "nq");
  if (lower.size() != model.nq)
    inner::failVector(name, "lower", nullptr, lower.size(), model.nq, "nq", model);
  if (upper.size() != model.nq)
    inner::failVector(name, "upper", nullptr, upper.size(), model.nq, "nq", model);
  for (const JointModel& joint : model.joints) {
    const int at = joint.idx_q(), nq = joint.nq();
    if (nq == 0) continue;
    const int unit = joint.unit_part().size;
    const double fallback = joint.manifold() == Manifold::Angles ? PI<double>() : 1;
    for (int k = at; k < at + nq - unit; ++k) q[k] = between(engine, lower[k], upper[k], fallback);
    if (unit == 4) q.segment<4>(at + nq - 4) = randomRotation(engine).coeffs();
    if (unit == 2) {
      const double angle = between(engine, -PI<double>(), PI<double>(), 0);
      q[at + nq - 2] = std::cos(angle);
      q[at + nq - 1] = std::sin(angle);
    }
  }
}

void randomConfiguration(const Model& model, std::mt19937_64& engine, VectorRef q) {
  randomConfiguration(model, engine, model.lowerPositionLimit, model.upperPositionLimit, q);
}

Eigen::VectorXd randomConfiguration(const Model& model, std::mt19937_64& engine, const ConstVectorRef& lower,
                                    const ConstVectorRef& upper) {
  Eigen::VectorXd q(model.nq);
  randomConfiguration(model, engine, lower, upper, q);
  return q;
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
  inner::forEachBlock(
      model,
      [&](int iq, int iv, int n) {
        for (int k = 0; k < n; ++k) out[iq + k] = q[iq + k] + v[iv + k];
      },
      [&](const auto& space, int iq, int iv) {
        space.integrate(q.data() + iq, v.data() + iv, out.data() + iq);
      });
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
  inner::forEachBlock(
      model,
      [&](int iq, int iv, int n) {
        for (int k = 0; k < n; ++k) out[iv + k] = q1[iq + k] - q0[iq + k];
      },
      [&](const auto& space, int iq, int iv) {
        space.difference(q0.data() + iq, q1.data() + iq, out.data() + iv);
      });
}

void coordinateRate(const Model& model, const ConstVectorRef& x, const ConstVectorRef& v, VectorRef out) {
  inner::checkV("coordinateRate", "x", model, x);
  inner::checkV("coordinateRate", "v", model, v);
  inner::checkOut("coordinateRate", "out", model, out, model.nv, "nv");
  inner::forEachBlock(
      model,
      [&](int, int iv, int n) {
        for (int k = iv; k < iv + n; ++k) out[k] = v[k];
      },
      [&](const auto& space, int, int iv) {
        const Motion along = space.twist(x.data() + iv), rate = space.twist(v.data() + iv);
        const Motion once = along.cross(rate), twice = along.cross(once);
        const Vector6d more = 0.5 * once.toVector() + twice.toVector() / 12;
        space.add(v.data() + iv, more, out.data() + iv);
      });
}

Eigen::VectorXd coordinateRate(const Model& model, const ConstVectorRef& x, const ConstVectorRef& v) {
  Eigen::VectorXd out(model.nv);
  coordinateRate(model, x, v, out);
  return out;
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
  inner::forEachBlock(
      model,
      [&](int iq, int, int n) {
        for (int k = iq; k < iq + n; ++k) out[k] = q0[k] + s * (q1[k] - q0[k]);
      },
      [&](const auto& space, int iq, int) {
        double d[6] = {0, 0, 0, 0, 0, 0};
        space.difference(q0.data() + iq, q1.data() + iq, d);
        for (double& x : d) x *= s;
        space.integrate(q0.data() + iq, d, out.data() + iq);
      });
}

Eigen::VectorXd interpolate(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1,
                            double s) {
  Eigen::VectorXd out(model.nq);
  interpolate(model, q0, q1, s, out);
  return out;
}

double squaredDistance(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1) {
  double sum = 0;
  forEachDifference("distance", model, q0, q1, [&](double x) { sum += x * x; });
  return sum;
}

double distance(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1) {
  return std::sqrt(squaredDistance(model, q0, q1));
}

bool isSameConfiguration(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, double tol) {
  bool same = true;
  forEachDifference("isSameConfiguration", model, q0, q1,
                    [&](double x) { same = same && std::abs(x) <= tol; });
  return same;
}

void normalize(const Model& model, VectorRef q) {
  checkConfiguration("normalize", "q", model, q);
  for (const ConfigurationBlock& block : model.tree().blocks) {
    if (block.unit_size > 0) q.segment(block.unit_at, block.unit_size).normalize();
  }
}

bool isNormalized(const Model& model, const ConstVectorRef& q, double tol) {
  checkConfiguration("isNormalized", "q", model, q);
  for (const ConfigurationBlock& block : model.tree().blocks) {
    if (block.unit_size == 0) continue;
    if (std::abs(q.segment(block.unit_at, block.unit_size).norm() - 1) > tol) return false;
  }
  return true;
}

void dIntegrate(const Model& model, const ConstVectorRef& q, const ConstVectorRef& v, MatrixRef J,
                ArgumentPosition argument) {
  checkConfiguration("dIntegrate", "q", model, q);
  inner::checkV("dIntegrate", "v", model, v);
  inner::checkOut("dIntegrate", "J", J, model.nv, model.nv);
  J.setIdentity();
  inner::forEachBlock(
      model, [](int, int, int) {},
      [&](const auto& space, int, int iv) {
        const inner::SmallMatrix block =
            argument == ARG0 ? space.adjointInverse(v.data() + iv) : space.rightJacobian(v.data() + iv);
        J.block(iv, iv, block.rows(), block.cols()) = block;
      });
}

Eigen::MatrixXd dIntegrate(const Model& model, const ConstVectorRef& q, const ConstVectorRef& v,
                           ArgumentPosition argument) {
  Eigen::MatrixXd J(model.nv, model.nv);
  dIntegrate(model, q, v, J, argument);
  return J;
}

void dDifference(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, MatrixRef J,
                 ArgumentPosition argument) {
  checkConfiguration("dDifference", "q0", model, q0);
  checkConfiguration("dDifference", "q1", model, q1);
  inner::checkOut("dDifference", "J", J, model.nv, model.nv);
  // difference(q0, q1) = d: moving q1 is a change behind d, moving q0 one before it
  const double sign = argument == ARG1 ? 1 : -1;
  J.setZero();
  J.diagonal().setConstant(sign);
  inner::forEachBlock(
      model, [](int, int, int) {},
      [&](const auto& space, int iq, int iv) {
        double d[6] = {0, 0, 0, 0, 0, 0};
        space.difference(q0.data() + iq, q1.data() + iq, d);
        for (double& x : d) x *= sign;
        const inner::SmallMatrix block = sign * space.rightJacobianInverse(d);
        J.block(iv, iv, block.rows(), block.cols()) = block;
      });
}

Eigen::MatrixXd dDifference(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1,
                            ArgumentPosition argument) {
  Eigen::MatrixXd J(model.nv, model.nv);
  dDifference(model, q0, q1, J, argument);
  return J;
}

}  // namespace rbd
