#pragma once
#include <rbd/rbd.h>

#include <vector>

#include "lab/evaluation/evaluate.h"

namespace lab::test {

/// Two joints about z, 1 m apart, that never move but have references, and so errors, of our choice; a tool 1 m
/// beyond the second. A step takes 0.1 s.
inline Run by_hand(const std::vector<double>& first, const std::vector<double>& second,
                   const char* second_name = "two") {
  Run run;
  const rbd::Inertia ball = rbd::Inertia::FromSphere(1, 0.1);
  const rbd::SE3 out(Eigen::Matrix3d::Identity(), Eigen::Vector3d(1, 0, 0));
  run.model.addJoint(0, rbd::JointModelRZ(), rbd::SE3(), "one");
  run.model.appendBodyToJoint(1, ball);
  run.model.addJoint(1, rbd::JointModelRZ(), out, second_name);
  run.model.appendBodyToJoint(2, ball);
  run.model.addFrame(rbd::Frame("upper", 1, out, rbd::BODY));
  run.model.addFrame(rbd::Frame("tip", 2, out, rbd::BODY));
  run.model.addFrame(rbd::Frame("screw", 2, rbd::SE3(), rbd::OP_FRAME));
  run.dt = 0.1;
  run.damping = run.friction = Eigen::VectorXd::Zero(2);
  run.last_step = static_cast<int64_t>(first.size()) - 1;
  for (size_t k = 0; k < first.size(); ++k) {
    RobotState s;
    s.step = static_cast<int64_t>(k);
    s.q = s.v = s.tau = Eigen::VectorXd::Zero(2);
    Reference r{.step = s.step, .q = Eigen::Vector2d(first[k], second[k]), .v = s.v, .a = s.v};
    run.states.push_back(s);
    run.references.push_back(r);
  }
  return run;
}

}  // namespace lab::test
