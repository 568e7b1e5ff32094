// From the kernels' frames and types to the user's: rotates results into user frames, fills Eigen types.
#pragma once

#include "rbd/algorithm/data.h"
#include "rbd/kernel/forward_passes.h"

namespace rbd::inner {

inline void storePose(const Mat3<double>& R, const Vec3<double>& p, SE3& out) {
  double* m = out.rotation().data();
  R.c0.storeU(m);
  R.c1.storeU(m + 3);
  R.c2.storeU(m + 6);
  p.storeU(out.translation().data());
}

inline Vec3<double> fromEigen(const Eigen::Vector3d& x) { return Vec3<double>::make(x[0], x[1], x[2]); }
inline Eigen::Vector3d toEigen(const Vec3<double>& x) { return {x[0], x[1], x[2]}; }

// Rotates a motion from a joint's kernel axes to the user's axes of that joint.
inline rbd::Motion userMotion(const PackedJoint& joint, const SpatialMotion<double>& m) {
  const Mat3<double> R_user = Mat3<double>::load(joint.R_user);
  return {toEigen(R_user * m.w), toEigen(R_user * m.v)};
}

// data.oMi from R, p, centre.
inline void storeJointPoses(const Model& model, Data& data) {
  const Scratch<double>& s = data.work().scratch;
  for (int i = 1; i < model.njoints; ++i) {
    const int body = model.tree().bodyOf[i];
    storePose(timesMatrix(s.R[body], model.tree().joints[body].R_user_T), s.centre + s.p[body], data.oMi[i]);
  }
}

// data.oMf from data.oMi.
inline void storeFramePoses(const Model& model, Data& data) {
  for (int i = 0; i < model.nframes; ++i) {
    const Frame& frame = model.frames[i];
    const SE3& joint = data.oMi[frame.parentJoint];
    const double *m = joint.rotation().data(), *b = frame.placement.rotation().data();
    const Mat3<double> R = {Vec3<double>::loadU(m), Vec3<double>::loadU(m + 3), Vec3<double>::loadU(m + 6)};
    storePose(
        {times(R, b), times(R, b + 3), times(R, b + 6)},
        Vec3<double>::loadU(joint.translation().data()) + times(R, frame.placement.translation().data()),
        data.oMf[i]);
  }
}

}  // namespace rbd::inner
