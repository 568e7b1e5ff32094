#pragma once
#include <rbd/algorithm/configuration.h>

#include "lab/experiment/experiment_yaml.h"
#include "procs/renderer/run_scene.h"

/// A motion of the sample arm, known in closed form, for tests of its pictures.
namespace lab::renderer {

inline Experiment sample_experiment(const std::string& renderer = "{}") {
  return parse_experiment(
      "robot: {model: 'builtin:manipulator'}\n"
      "simulator: {dt: 0.01, duration: 2, q0: [-0.5, 0.6, -1.0, 0, 0.4, 0]}\n"
      "planner: {kind: quintic, goal: [0.7, 0.9, -0.7, 0.3, 0.2, 0.5], duration: 1.5}\n"
      "renderer: " +
          renderer + "\n",
      "sample");
}

/// The planned pose, with something added to the first joint: what a tracking error would do.
inline Snapshot sample_moment(const rbd::Model& model, int64_t step, double error = 0) {
  const double s = std::min(static_cast<double>(step) * 0.01 / 1.5, 1.0);
  const double blend = s * s * s * (10 - 15 * s + 6 * s * s);
  Eigen::VectorXd start(6), goal(6);
  start << -0.5, 0.6, -1.0, 0, 0.4, 0;
  goal << 0.7, 0.9, -0.7, 0.3, 0.2, 0.5;
  Snapshot snapshot;
  snapshot.step = step;
  snapshot.time = static_cast<double>(step) * 0.01;
  snapshot.reference = start + blend * (goal - start);
  snapshot.q = snapshot.reference;
  snapshot.q[0] += error;
  snapshot.v = Eigen::VectorXd::Zero(model.nv);
  return snapshot;
}

}  // namespace lab::renderer
