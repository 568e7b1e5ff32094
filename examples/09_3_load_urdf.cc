// A robot from a file. What is wrong in a file is said with its line; what comes out is a Model like any
// other.
//
// usage: 09_3_load_urdf [FILE]
#include <rbd/rbd.h>
#include <rbd/urdf/urdf.h>

#include <iostream>

#include "roads.h"

namespace {
rbd::SE3 up(double z) { return rbd::SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, z)); }
}  // namespace

int main(int argc, char** argv) {
  rbd::Model model;
  try {
    const auto notes =
        rbd::urdf::buildModel(argc > 1 ? argv[1] : LCMLAB_MODELS "/simple_3dof_arm.urdf", model);
    for (const rbd::urdf::Diagnostic& note : notes) std::cerr << note.text() << "\n";
  } catch (const rbd::urdf::Error& error) {
    std::cerr << error.what() << "\n";  // FILE:LINE: link 'x': what is wrong
    return 3;
  }
  std::cout << model.name << ": nq " << model.nq << "\n";
  for (rbd::JointIndex i = 1; i < model.njoints; ++i) {
    std::cout << "  " << model.names[i] << " " << model.joints[i].shortname() << " carries "
              << model.inertias[i].mass() << " kg\n";
  }
  for (const rbd::Frame& frame : model.frames) {
    std::cout << "  " << frame.name << " " << rbd::frameTypeName(frame.type) << "\n";
  }
  if (argc > 1) return 0;  // another robot: nothing to compare with

  // the same arm by hand: cylinders of 0.5 and 0.4 m, a ball at the tip
  rbd::Model by_hand;
  by_hand.addJoint(0, rbd::JointModelRZ(), up(0.05), "base");
  by_hand.addJoint(1, rbd::JointModelRY(), up(0.5), "shoulder");
  by_hand.addJoint(2, rbd::JointModelRY(), up(0.4), "elbow");
  by_hand.appendBodyToJoint(1, rbd::Inertia::FromCylinder(5, 0.05, 0.5), up(0.25));
  by_hand.appendBodyToJoint(2, rbd::Inertia::FromCylinder(3, 0.04, 0.4), up(0.2));
  by_hand.appendBodyToJoint(3, rbd::Inertia::FromSphere(0.5, 0.03));

  rbd::Data data(model), data_by_hand(by_hand);
  const double pi = rbd::PI<double>();
  const Eigen::Vector3d q(pi / 4, -pi / 3, pi / 6), v(0.3, -0.2, 0.5), a(1, 2, 3);
  rbd::forwardKinematics(model, data, q);
  const Eigen::Vector3d tip = data.oMf[model.frameId("end_effector")].translation();
  std::cout << "tip at " << tip.transpose() << "\n";

  Roads roads;
  const double radius = 0.4 * std::sin(q[1]);
  const Eigen::Vector3d trigonometry(radius * std::cos(q[0]), radius * std::sin(q[0]),
                                     0.55 + 0.4 * std::cos(q[1]));
  roads.compare("tip, trigonometry", tip, trigonometry, 1e-14);
  // the file gives inertias with nine digits
  roads.compare("efforts: of the file's arm, of the one by hand", rbd::rnea(model, data, q, v, a),
                rbd::rnea(by_hand, data_by_hand, q, v, a), 1e-8);
  return roads.exit_code();
}
