// The Jacobian: from joint velocities to the velocity of a body, and where it loses a direction.
//
// Rows 0-2 are angular, 3-5 linear. data.J holds one column per joint, in WORLD; the Jacobian of a frame is
// getFrameJacobian's. LOCAL_WORLD_ALIGNED is the one whose linear rows move the tool's point
// (docs/frames.md).
#include <rbd/rbd.h>

#include <Eigen/SVD>
#include <iostream>

#include "roads.h"

namespace {
// Singular values tell how fast the tool can go in its best and worst direction per unit of joint velocity.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& J) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
}
}  // namespace

int main() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  rbd::Data data(model);
  const rbd::FrameIndex tool = model.frameId("arm_tool_link");

  Eigen::VectorXd q(6), v(6);
  q << 0.4, -0.3, 0.6, 0.2, 0.8, -0.5;
  v << 1.0, 0.5, -0.2, 0.3, 0.1, 0.7;
  rbd::computeJointJacobians(model, data, q);
  const rbd::Matrix6Xd J = rbd::getFrameJacobian(model, data, tool, rbd::LOCAL_WORLD_ALIGNED);
  std::cout << "J =\n" << J << "\nJ v = " << (J * v).transpose() << "\n";

  // let time pass: the tool is a little further (central difference, error of order h^2)
  const double h = 1e-5;
  const auto tool_at = [&](double t) {
    rbd::forwardKinematics(model, data, q + t * v);
    return data.oMf[tool].translation();
  };
  Roads roads;
  roads.compare("J v, the way the tool went", J.bottomRows<3>() * v, (tool_at(h) - tool_at(-h)) / (2 * h),
                1e-9);

  // a column by hand: a turning joint gives (axis, axis x arm from the joint to the tool)
  rbd::forwardKinematics(model, data, q);
  const Eigen::Vector3d axis = data.oMi[2].rotation() * model.joints[2].axis();
  const Eigen::Vector3d arm = data.oMf[tool].translation() - data.oMi[2].translation();
  Eigen::VectorXd column(6);
  column << axis, axis.cross(arm);
  roads.compare("column of the shoulder, axis x arm", J.col(1), column, 1e-14);

  // with the wrist straight, joints 4 and 6 turn about one axis: a direction is gone
  q[4] = 0;
  const Eigen::VectorXd bent = singular_values(J);
  const Eigen::VectorXd straight =
      singular_values(rbd::computeFrameJacobian(model, data, q, tool, rbd::LOCAL_WORLD_ALIGNED));
  std::cout << "singular values, wrist bent: " << bent.transpose()
            << "\n  wrist straight: " << straight.transpose() << "\n";
  roads.compare("smallest singular value with a straight wrist, 0", straight[5], 0, 1e-14);
  // the rank does not depend on the reference: the three Jacobians differ by an invertible 6x6
  const Eigen::VectorXd local = singular_values(rbd::getFrameJacobian(model, data, tool, rbd::LOCAL));
  const Eigen::VectorXd world = singular_values(rbd::getFrameJacobian(model, data, tool, rbd::WORLD));
  roads.compare("the same in LOCAL", local[5], 0, 1e-14);
  roads.compare("the same in WORLD", world[5], 0, 1e-14);
  return roads.exit_code();
}
