#include "rbd/spatial/inertia.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace rbd {
namespace {

// m (|c|^2 1 - c c^T): what moving the reference point by c adds.
Eigen::Matrix3d steiner(double mass, const Eigen::Vector3d& c) {
  return mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
}

}  // namespace

Inertia::Inertia(double mass, const Eigen::Vector3d& lever, const Eigen::Matrix3d& inertia)
    : mass_(mass), lever_(lever), inertia_(0.5 * (inertia + inertia.transpose())) {
  if (!std::isfinite(mass) || !lever.allFinite() || !inertia.allFinite()) {
    throw std::invalid_argument("Inertia: mass, centre of mass and inertia must be finite numbers");
  }
  const double asymmetry = (inertia - inertia.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > 1e-9 * inertia.cwiseAbs().maxCoeff()) {
    throw std::invalid_argument("Inertia: the rotational inertia is not symmetric (entries differ by " +
                                std::to_string(asymmetry) + ")");
  }
}

Inertia Inertia::FromBox(double mass, double x, double y, double z) {
  const Eigen::Vector3d d(y * y + z * z, x * x + z * z, x * x + y * y);
  return Inertia(mass, Eigen::Vector3d::Zero(), (mass / 12 * d).asDiagonal());
}

Inertia Inertia::FromSphere(double mass, double radius) {
  return Inertia(mass, Eigen::Vector3d::Zero(), 0.4 * mass * radius * radius * Eigen::Matrix3d::Identity());
}

Inertia Inertia::FromCylinder(double mass, double radius, double length) {
  const double r2 = radius * radius, side = (3 * r2 + length * length) / 12;
  return Inertia(mass, Eigen::Vector3d::Zero(), (mass * Eigen::Vector3d(side, side, r2 / 2)).asDiagonal());
}

Inertia Inertia::operator+(const Inertia& b) const {
  const double m = mass_ + b.mass_;
  if (m == 0) return Inertia(0, Eigen::Vector3d::Zero(), inertia_ + b.inertia_);
  const Eigen::Vector3d c = (mass_ * lever_ + b.mass_ * b.lever_) / m;
  return Inertia(m, c, inertia_ + b.inertia_ + steiner(mass_, lever_ - c) + steiner(b.mass_, b.lever_ - c));
}

Force Inertia::operator*(const Motion& v) const {
  const Eigen::Vector3d f = mass_ * (v.linear() + v.angular().cross(lever_));
  return {inertia_ * v.angular() + lever_.cross(f), f};
}

Matrix6d Inertia::matrix() const {
  const Eigen::Matrix3d h = mass_ * skew(lever_);
  Matrix6d m;
  m << inertia_ + steiner(mass_, lever_), h, -h, mass_ * Eigen::Matrix3d::Identity();
  return m;
}

bool Inertia::isApprox(const Inertia& b, double tol) const {
  return std::abs(mass_ - b.mass_) <= tol && (lever_ - b.lever_).cwiseAbs().maxCoeff() <= tol &&
         (inertia_ - b.inertia_).cwiseAbs().maxCoeff() <= tol;
}

std::string Inertia::problem(double tol) const {
  std::ostringstream out;
  if (!(mass_ > 0)) {
    out << "mass must be positive (" << mass_ << ")";
    return out.str();
  }
  const Eigen::Vector3d d = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia_).eigenvalues();
  if (!(d[0] > 0)) {
    out << "inertia must be positive definite (principal moments " << d.transpose() << ")";
  } else if (d[0] + d[1] < d[2] * (1 - tol)) {
    out << "inertia breaks the triangle inequality (principal moments " << d.transpose() << ")";
  }
  return out.str();
}

}  // namespace rbd
