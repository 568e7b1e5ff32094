// The inertia of one rigid body: mass, centre of mass (lever), rotational inertia about that centre.
//
// All three are given in one frame: lever() from the frame's origin, inertia() about the CENTRE OF MASS along
// the frame's axes. kg, m, kg m^2. Source: Featherstone 2008, section 2.13.
#pragma once

#include <string>

#include "rbd/spatial/motion.h"

namespace rbd {

class Inertia {
 public:
  Inertia() : mass_(0), lever_(Eigen::Vector3d::Zero()), inertia_(Eigen::Matrix3d::Zero()) {}
  // Throws std::invalid_argument when an entry is not finite or `inertia` is not symmetric (1e-9 relative).
  // Physical sense (positive mass, triangle inequality) is asked with problem(), not enforced.
  Inertia(double mass, const Eigen::Vector3d& lever, const Eigen::Matrix3d& inertia);

  static Inertia Zero() { return Inertia(); }
  // Solid bodies of even density, centred at the origin; a cylinder's axis is z.
  static Inertia FromBox(double mass, double x, double y, double z);
  static Inertia FromSphere(double mass, double radius);
  static Inertia FromCylinder(double mass, double radius, double length);

  double mass() const { return mass_; }
  const Eigen::Vector3d& lever() const { return lever_; }
  const Eigen::Matrix3d& inertia() const { return inertia_; }

  // The two bodies welded together, both given in the same frame.
  Inertia operator+(const Inertia& b) const;
  Inertia& operator+=(const Inertia& b) { return *this = *this + b; }
  // Scales mass and rotational inertia; the centre of mass stays.
  Inertia operator*(double s) const { return Inertia(s * mass_, lever_, s * inertia_); }

  // Momentum of the body that moves with v, about the frame's origin.
  Force operator*(const Motion& v) const;
  // v . I v, twice the kinetic energy.
  double vtiv(const Motion& v) const { return v.dot(*this * v); }
  // 6x6, angular first, about the frame's origin.
  Matrix6d matrix() const;

  bool isApprox(const Inertia& b, double tol = 1e-12) const;
  // "" for a body that can exist (mass > 0, principal moments > 0, triangle inequality within `tol`
  // relative), else what is wrong, with the value seen.
  std::string problem(double tol = 1e-9) const;

 private:
  double mass_;
  Eigen::Vector3d lever_;
  Eigen::Matrix3d inertia_;
};

}  // namespace rbd
