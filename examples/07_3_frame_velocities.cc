// One velocity in three references, and forces beside it. docs/frames.md has the pictures.
#include <rbd/rbd.h>

#include <iostream>

#include "roads.h"

int main() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  rbd::Data data(model);
  const rbd::FrameIndex tool = model.frameId("effector_body");
  Eigen::VectorXd q(6), v(6);
  q << 0.4, -0.3, 0.6, 0.2, 0.8, -0.5;
  v << 1.0, 0.5, -0.2, 0.3, 0.1, 0.7;

  rbd::forwardKinematics(model, data, q, v);  // with v it fills data.v too
  const rbd::SE3 pose = data.oMf[tool];
  const rbd::Motion world = rbd::getFrameVelocity(model, data, tool, rbd::WORLD);
  const rbd::Motion local = rbd::getFrameVelocity(model, data, tool, rbd::LOCAL);
  const rbd::Motion aligned = rbd::getFrameVelocity(model, data, tool, rbd::LOCAL_WORLD_ALIGNED);
  std::cout << "                      angular | linear\n"
            << "WORLD                 " << world.angular().transpose() << " | " << world.linear().transpose()
            << "\n"
            << "LOCAL                 " << local.angular().transpose() << " | " << local.linear().transpose()
            << "\n"
            << "LOCAL_WORLD_ALIGNED   " << aligned.angular().transpose() << " | "
            << aligned.linear().transpose() << "\n";

  Roads roads;
  roads.compare("WORLD, LOCAL carried over by the pose", world.toVector(), pose.act(local).toVector(), 1e-14);
  roads.compare("aligned linear part, LOCAL turned", aligned.linear(), pose.rotation() * local.linear(),
                1e-14);
  // WORLD speaks of the body point that passes the world's origin, not of the tool
  roads.compare("WORLD linear part, tool's minus w x p", world.linear(),
                aligned.linear() - aligned.angular().cross(pose.translation()), 1e-14);

  // Jacobians give the same three velocities
  rbd::computeJointJacobians(model, data, q);
  for (const auto& [reference, velocity] : {std::pair(rbd::WORLD, world), std::pair(rbd::LOCAL, local),
                                            std::pair(rbd::LOCAL_WORLD_ALIGNED, aligned)}) {
    const rbd::Matrix6Xd J = rbd::getFrameJacobian(model, data, tool, reference);
    roads.compare("getFrameVelocity, Jacobian times v", velocity.toVector(), J * v, 1e-14);
  }

  // a push of 10 N along world x at the tool: its power is the same in every reference, and equals tau . v
  const rbd::Force push(Eigen::Vector3d::Zero(), Eigen::Vector3d(10, 0, 0));
  const rbd::Force push_local(Eigen::Vector3d::Zero(), pose.rotation().transpose() * push.linear());
  const Eigen::MatrixXd J = rbd::getFrameJacobian(model, data, tool, rbd::LOCAL_WORLD_ALIGNED);
  const double power = aligned.dot(push);
  std::cout << "the push gives " << power << " W\n";
  roads.compare("power, in LOCAL", power, local.dot(push_local), 1e-14);
  roads.compare("power, in WORLD", power, world.dot(pose.act(push_local)), 1e-14);
  roads.compare("power, by the joints' efforts J' f", power, v.dot(J.transpose() * push.toVector()), 1e-14);
  return roads.exit_code();
}
