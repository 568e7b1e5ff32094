// SE3: the pose of one frame in another; the exponential and logarithm of poses.
//
// aMb holds frame b as seen from a: a point with coordinates p in b has coordinates aMb.act(p) = R p + t in
// a. act() takes vectors from b to a, actInv() from a to b. Metres. Source: Featherstone 2008, table 2.1 and
// section 2.8.
#pragma once

#include "rbd/spatial/inertia.h"

namespace rbd {

class SE3 {
 public:
  SE3() : rotation_(Eigen::Matrix3d::Identity()), translation_(Eigen::Vector3d::Zero()) {}
  SE3(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
      : rotation_(rotation), translation_(translation) {}
  // The quaternion is normalised.
  SE3(const Eigen::Quaterniond& q, const Eigen::Vector3d& translation)
      : rotation_(q.normalized().toRotationMatrix()), translation_(translation) {}
  explicit SE3(const Eigen::Matrix4d& homogeneous)
      : rotation_(homogeneous.topLeftCorner<3, 3>()), translation_(homogeneous.topRightCorner<3, 1>()) {}

  static SE3 Identity() { return SE3(); }

  const Eigen::Matrix3d& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  Eigen::Matrix3d& rotation() { return rotation_; }
  Eigen::Vector3d& translation() { return translation_; }
  void rotation(const Eigen::Matrix3d& R) { rotation_ = R; }
  void translation(const Eigen::Vector3d& t) { translation_ = t; }

  SE3 operator*(const SE3& b) const {
    return {rotation_ * b.rotation_, rotation_ * b.translation_ + translation_};
  }
  SE3 inverse() const { return {rotation_.transpose(), -(rotation_.transpose() * translation_)}; }
  SE3 actInv(const SE3& b) const {
    return {rotation_.transpose() * b.rotation_, rotation_.transpose() * (b.translation_ - translation_)};
  }
  SE3 act(const SE3& b) const { return *this * b; }

  Eigen::Vector3d act(const Eigen::Vector3d& p) const { return rotation_ * p + translation_; }
  Eigen::Vector3d actInv(const Eigen::Vector3d& p) const {
    return rotation_.transpose() * (p - translation_);
  }
  Eigen::Vector3d actOnEigenObject(const Eigen::Vector3d& p) const { return act(p); }

  Motion act(const Motion& m) const {
    const Eigen::Vector3d w = rotation_ * m.angular();
    return {w, rotation_ * m.linear() + translation_.cross(w)};
  }
  Motion actInv(const Motion& m) const {
    return {rotation_.transpose() * m.angular(),
            rotation_.transpose() * (m.linear() - translation_.cross(m.angular()))};
  }
  Force act(const Force& x) const {
    const Eigen::Vector3d f = rotation_ * x.linear();
    return {rotation_ * x.angular() + translation_.cross(f), f};
  }
  Force actInv(const Force& x) const {
    return {rotation_.transpose() * (x.angular() - translation_.cross(x.linear())),
            rotation_.transpose() * x.linear()};
  }
  Inertia act(const Inertia& i) const {
    return Inertia(i.mass(), act(i.lever()), rotation_ * i.inertia() * rotation_.transpose());
  }
  Inertia actInv(const Inertia& i) const { return inverse().act(i); }

  Eigen::Matrix4d toHomogeneousMatrix() const;
  // 6x6 that does to a stacked motion what act() does.
  Matrix6d toActionMatrix() const;
  // Every entry within `tol` (absolute).
  bool isApprox(const SE3& b, double tol = 1e-12) const {
    return (rotation_ - b.rotation_).cwiseAbs().maxCoeff() <= tol &&
           (translation_ - b.translation_).cwiseAbs().maxCoeff() <= tol;
  }

 private:
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
};

// Moving with the constant body twist `v` for one unit of time; log6 is its inverse, |angular| <= pi.
SE3 exp6(const Motion& v);
Motion log6(const SE3& m);

// Left Jacobian of SE(3), angular first: exp6(v + dv) = exp6(J(v) dv) exp6(v) to first order. The right one
// is J(-v). And its inverse. Source: Barfoot, State Estimation for Robotics, 2017, eq. 7.86.
Matrix6d leftJacobian6(const Motion& v);
Matrix6d leftJacobian6Inverse(const Motion& v);

}  // namespace rbd
