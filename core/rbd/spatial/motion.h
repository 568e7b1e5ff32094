// Spatial motion (velocity or acceleration) and spatial force (wrench, momentum): plain pairs of vectors.
//
// Angular part first everywhere: constructors, toVector(), Jacobian rows. A Motion holds (w, v): rad/s and
// m/s (or their rates), v being the velocity of the body point at the frame's origin. A Force holds (n, f): N
// m about the frame's origin and N (or N m s and N s for a momentum). The function that returns it
// states the frame. Default construction gives zero. Source: Featherstone 2008, sections 2.2 to 2.9.
#pragma once

#include "rbd/spatial/so3.h"

namespace rbd {

// What Motion and Force have in common; `Derived` is one of them.
template <class Derived>
class Spatial {
 public:
  Spatial() : angular_(Eigen::Vector3d::Zero()), linear_(Eigen::Vector3d::Zero()) {}
  Spatial(const Eigen::Vector3d& angular, const Eigen::Vector3d& linear)
      : angular_(angular), linear_(linear) {}

  static Derived Zero() { return Derived(); }

  const Eigen::Vector3d& angular() const { return angular_; }
  const Eigen::Vector3d& linear() const { return linear_; }
  Eigen::Vector3d& angular() { return angular_; }
  Eigen::Vector3d& linear() { return linear_; }
  void angular(const Eigen::Vector3d& x) { angular_ = x; }
  void linear(const Eigen::Vector3d& x) { linear_ = x; }

  // (angular, linear) stacked.
  Vector6d toVector() const {
    Vector6d x;
    x.head<3>() = angular_;
    x.tail<3>() = linear_;
    return x;
  }

  Derived operator+(const Derived& b) const { return {angular_ + b.angular_, linear_ + b.linear_}; }
  Derived operator-(const Derived& b) const { return {angular_ - b.angular_, linear_ - b.linear_}; }
  Derived operator-() const { return {-angular_, -linear_}; }
  Derived operator*(double s) const { return {s * angular_, s * linear_}; }
  friend Derived operator*(double s, const Spatial& x) { return {s * x.angular_, s * x.linear_}; }
  Derived& operator+=(const Derived& b) { return self() = self() + b; }
  Derived& operator-=(const Derived& b) { return self() = self() - b; }
  bool operator==(const Spatial& b) const { return angular_ == b.angular_ && linear_ == b.linear_; }

  // Every entry within `tol` (absolute).
  bool isApprox(const Derived& b, double tol = 1e-12) const {
    return (toVector() - b.toVector()).template lpNorm<Eigen::Infinity>() <= tol;
  }

 protected:
  Derived& self() { return static_cast<Derived&>(*this); }
  Eigen::Vector3d angular_, linear_;
};

class Force : public Spatial<Force> {
 public:
  using Spatial::Spatial;
  explicit Force(const Vector6d& x) : Spatial(x.head<3>(), x.tail<3>()) {}
};

class Motion : public Spatial<Motion> {
 public:
  using Spatial::Spatial;
  explicit Motion(const Vector6d& x) : Spatial(x.head<3>(), x.tail<3>()) {}

  // v x m, the rate of a motion vector that is carried along by v.
  Motion cross(const Motion& m) const {
    return {angular_.cross(m.angular()), angular_.cross(m.linear()) + linear_.cross(m.angular())};
  }
  // v x* f, the same for a force vector.
  Force cross(const Force& f) const {
    return {angular_.cross(f.angular()) + linear_.cross(f.linear()), angular_.cross(f.linear())};
  }
  // Power of f along this motion.
  double dot(const Force& f) const { return angular_.dot(f.angular()) + linear_.dot(f.linear()); }
};

}  // namespace rbd
