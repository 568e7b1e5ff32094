// The tree, taken apart: every joint knows its parent, every frame knows the joint that carries it.
#include <rbd/rbd.h>

#include <iostream>
#include <string>

#include "roads.h"

int main() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  rbd::Data data(model);
  const Eigen::VectorXd q = rbd::randomConfiguration(model, 7);
  rbd::forwardKinematics(model, data, q);

  for (rbd::JointIndex i = 1; i < model.njoints; ++i) {
    std::cout << "joint " << model.names[i] << ": parent " << model.names[model.parents[i]] << ", stands at "
              << model.jointPlacements[i].translation().transpose() << " in it; q there takes "
              << data.joints[i].joint_q().size() << " number: " << data.joints[i].joint_q() << "\n";
  }

  // a name that exists has an index below nframes; a name that does not gives nframes
  const rbd::FrameIndex tool = model.getFrameId("arm_tool_link");
  std::cout << "arm_tool_link is frame " << tool << "; 'hand' gives " << model.getFrameId("hand") << " of "
            << model.nframes << "\n";
  try {
    model.frameId("arm_tool");  // the strict sister throws, and knows names that are close
  } catch (const std::out_of_range& error) {
    std::cout << error.what() << "\n";
  }

  // from every frame up to the universe, multiplying on the way: the world pose that forwardKinematics found
  Roads roads;
  for (const rbd::Frame& frame : model.frames) {
    rbd::SE3 pose = frame.placement;
    for (rbd::JointIndex i = frame.parentJoint; i != 0; i = model.parents[i]) {
      const rbd::JointModel& joint = model.joints[i];
      const rbd::SE3 moved(rbd::exp3(q[joint.idx_q()] * joint.axis()), Eigen::Vector3d::Zero());
      pose = model.jointPlacements[i] * moved * pose;
    }
    const rbd::FrameIndex f = model.getFrameId(frame.name);
    roads.compare(("pose of " + frame.name + ", climbing the tree").c_str(),
                  data.oMf[f].toHomogeneousMatrix(), pose.toHomogeneousMatrix(), 1e-14);
  }
  roads.compare("'hand' gives nframes", model.getFrameId("hand"), model.nframes, 0);
  return roads.exit_code();
}
