#pragma once
#include <rbd/rbd.h>

#include <algorithm>
#include <cstdint>
#include <functional>
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
    run.steps.push_back({.state = s, .reference = r});
  }
  return run;
}

/// Changes the steps of a run, and keeps the first `count` of them.
inline void edit(Run& run, const std::function<void(size_t, RunStep&)>& change, size_t count = SIZE_MAX) {
  StepTable changed;
  for (size_t k = 0; k < std::min(count, run.steps.size()); ++k) {
    RunStep step = run.steps[k];
    change(k, step);
    changed.push_back(step);
  }
  run.steps = std::move(changed);
}
inline void edit(Run& run, size_t k, const std::function<void(RunStep&)>& change) {
  edit(run, [&](size_t i, RunStep& step) {
    if (i == k) change(step);
  });
}
inline void keep_first(Run& run, size_t count) {
  edit(run, [](size_t, RunStep&) {}, count);
}

}  // namespace lab::test
