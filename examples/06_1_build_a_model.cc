// A robot from nothing: three joints one behind the other, and a frame for the tip.
//
// addJoint takes the parent, the kind, the placement in the parent's frame and the name.
#include <rbd/rbd.h>

#include <iostream>

#include "roads.h"

using Eigen::Vector3d;
using rbd::SE3;

namespace {
SE3 shift(double x, double y, double z) { return SE3(Eigen::Matrix3d::Identity(), Vector3d(x, y, z)); }
SE3 turn(const Vector3d& axis, double angle) { return SE3(rbd::exp3(angle * axis), Vector3d::Zero()); }
}  // namespace

int main() {
  rbd::Model model;
  model.name = "three_axes";
  const rbd::JointIndex base = model.addJoint(0, rbd::JointModelRZ(), SE3::Identity(), "base_rotation");
  const rbd::JointIndex shoulder = model.addJoint(base, rbd::JointModelRY(), shift(0, 0, 0.5), "shoulder");
  const rbd::JointIndex elbow = model.addJoint(shoulder, rbd::JointModelRY(), shift(0, 0.4, 0), "elbow");
  // a tip does not move by itself: it is a frame on the last joint, not a joint
  const rbd::FrameIndex tip = model.addFrame(rbd::Frame("tip", elbow, shift(0, 0.3, 0), rbd::OP_FRAME));

  // at neutral nothing has turned, and the placements simply add up
  Roads roads;
  rbd::Data data(model);
  rbd::forwardKinematics(model, data, rbd::neutral(model));
  for (rbd::JointIndex i = 1; i < model.njoints; ++i) {
    std::cout << model.names[i] << " at " << data.oMi[i].translation().transpose() << "\n";
  }
  roads.compare("elbow at neutral, sum of placements", data.oMi[elbow].translation(), Vector3d(0, 0.4, 0.5),
                0);
  roads.compare("tip at neutral, sum of placements", data.oMf[tip].translation(), Vector3d(0, 0.7, 0.5),
                1e-14);

  // anywhere else: placement, turn, placement, turn, ..
  const Vector3d q(0.3, -0.7, 1.1);
  rbd::forwardKinematics(model, data, q);
  const SE3 by_hand = turn(Vector3d::UnitZ(), q[0]) * shift(0, 0, 0.5) * turn(Vector3d::UnitY(), q[1]) *
                      shift(0, 0.4, 0) * turn(Vector3d::UnitY(), q[2]) * shift(0, 0.3, 0);
  std::cout << "tip at " << data.oMf[tip].translation().transpose() << "\n";
  roads.compare("tip, product of placements and turns", data.oMf[tip].toHomogeneousMatrix(),
                by_hand.toHomogeneousMatrix(), 1e-14);
  // and since shoulder and elbow turn about the axis along which the arm lies, the tip never leaves its
  // circle
  roads.compare("height of the tip, always 0.5", data.oMf[tip].translation().z(), 0.5, 1e-14);
  return roads.exit_code();
}
