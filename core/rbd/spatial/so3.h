// Rotations: cross-product matrices, exponential and logarithm, quaternions, roll-pitch-yaw.
//
// A rotation R takes coordinates in the turned frame to the frame it was turned from. Quaternions are stored
// (x, y, z, w), as on the wire. Angles in radians. Source: Murray, Li, Sastry 1994, chapter 2; Shepperd 1978.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rbd {

// pi in the scalar type asked for: PI<double>().
template <class Scalar>
constexpr Scalar PI() {
  return static_cast<Scalar>(3.141592653589793238462643383279502884L);
}

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// skew(a) b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

// The vector of a skew matrix; the symmetric part of `m` is ignored.
Eigen::Vector3d unSkew(const Eigen::Matrix3d& m);

// Rotation by |w| about w. Exact at w = 0, relative error of a few eps everywhere.
Eigen::Matrix3d exp3(const Eigen::Vector3d& w);

// The rotation vector of R, |log3(R)| <= pi. At exactly pi either sign of the axis is right.
Eigen::Vector3d log3(const Eigen::Matrix3d& R);

// The same two maps for unit quaternions: well conditioned up to and at half a turn.
Eigen::Quaterniond exp3Quaternion(const Eigen::Vector3d& w);
Eigen::Vector3d log3(const Eigen::Quaterniond& q);

// Left Jacobian V of SO(3): the translation of exp6(w, v) is V(w) v. And its inverse.
Eigen::Matrix3d leftJacobian3(const Eigen::Vector3d& w);
Eigen::Matrix3d leftJacobian3Inverse(const Eigen::Vector3d& w);

// Rz(yaw) Ry(pitch) Rx(roll), as URDF's rpy.
Eigen::Matrix3d rpyToMatrix(double roll, double pitch, double yaw);
Eigen::Matrix3d rpyToMatrix(const Eigen::Vector3d& rpy);

// (roll, pitch, yaw) with |pitch| <= pi/2; at pitch = +-pi/2 roll is set to 0.
Eigen::Vector3d matrixToRpy(const Eigen::Matrix3d& R);

// A proper rotation: R^T R = 1 within `tol` per entry, det R > 0. False for NaN.
bool isRotation(const Eigen::Matrix3d& R, double tol = 1e-9);

// A rotation whose third column is the unit vector `axis`; a plain permutation for +x, +y, +z.
Eigen::Matrix3d rotationWithZ(const Eigen::Vector3d& axis);

}  // namespace rbd
