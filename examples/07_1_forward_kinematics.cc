// Forward kinematics: from joint angles to where everything is.
//
// data.oMi[joint] and data.oMf[frame] are poses in the world. Between any two frames the world cancels:
// aMb = oMa^-1 * oMb.
#include <rbd/rbd.h>

#include <iostream>

#include "roads.h"

int main() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  rbd::Data data(model);

  Eigen::VectorXd q = rbd::neutral(model);
  rbd::forwardKinematics(model, data, q);
  const rbd::FrameIndex base = model.frameId("arm_base_link"), tool = model.frameId("arm_tool_link");
  std::cout << "tool at neutral: " << data.oMf[tool].translation().transpose() << "\n";

  // by hand from docs/sample_models.md: up 0.15 + 0.15 + 0.45, then along x 0.20 + 0.20 + 0.10 + 0.08
  Roads roads;
  roads.compare("tool at neutral, lengths added", data.oMf[tool].translation(),
                Eigen::Vector3d(0.58, 0, 0.75), 1e-14);

  // another q, the same Data: old answers are overwritten
  q.head<3>() << rbd::PI<double>() / 4, -rbd::PI<double>() / 3, rbd::PI<double>() / 6;
  rbd::forwardKinematics(model, data, q);
  for (rbd::JointIndex i = 1; i < model.njoints; ++i) {
    std::cout << model.names[i] << " at " << data.oMi[i].translation().transpose() << "\n";
  }
  std::cout << "tool in the world:\n" << data.oMf[tool].toHomogeneousMatrix() << "\n";

  // upper arm and forearm move in a vertical plane that joint 1 turns: radius and height by plain
  // trigonometry
  const double forearm = 0.58, upper = 0.45, tilt = q[1], bend = q[1] + q[2];
  const double radius = upper * std::sin(tilt) + forearm * std::cos(bend);
  const double height = 0.30 + upper * std::cos(tilt) - forearm * std::sin(bend);
  const Eigen::Vector3d by_hand(radius * std::cos(q[0]), radius * std::sin(q[0]), height);
  roads.compare("tool, trigonometry in the arm's plane", data.oMf[tool].translation(), by_hand, 1e-14);

  // base to tool: the base does not move, so joint by joint from it
  const rbd::SE3 base_to_tool = data.oMf[base].inverse() * data.oMf[tool];
  const rbd::SE3 tool_to_base = data.oMf[tool].inverse() * data.oMf[base];
  rbd::SE3 chain = model.frames[base].placement.inverse();
  for (rbd::JointIndex i = 1; i < model.njoints; ++i) {
    const rbd::JointModel& joint = model.joints[i];
    chain = chain * model.jointPlacements[i] *
            rbd::SE3(rbd::exp3(q[joint.idx_q()] * joint.axis()), Eigen::Vector3d::Zero());
  }
  chain = chain * model.frames[tool].placement;
  roads.compare("base to tool, joint by joint", base_to_tool.toHomogeneousMatrix(),
                chain.toHomogeneousMatrix(), 1e-14);
  // the other order is the way back
  roads.compare("tool to base, inverse of base to tool", tool_to_base.toHomogeneousMatrix(),
                base_to_tool.inverse().toHomogeneousMatrix(), 1e-14);
  return roads.exit_code();
}
