#pragma once
#include <rbd/model/data.h>

#include <string>
#include <vector>

#include "procs/experiment/experiment.h"
#include "procs/experiment/robot.h"
#include "render/renderer.h"

namespace lab::renderer {

/// The robot's shapes as a scene: one body for each joint that carries some. A mesh that cannot be read becomes a
/// magenta box and a warning. In quality fine meshes are as the file has them, else decimated (parts.h).
render::Scene make_scene(const Robot& robot, const std::string& quality, std::vector<std::string>& warnings);

/// Moves the scene to a configuration.
void pose_scene(const rbd::Model& model, rbd::Data& data, const Eigen::VectorXd& q, render::Scene& scene);

/// Configurations that the experiment will pass near, known before it runs: start, way to the goal, ends of a sinusoid.
std::vector<Eigen::VectorXd> expected_poses(const Experiment& experiment, const rbd::Model& model);

/// Turns configurations of one robot into pictures. The camera is fixed by the experiment alone, so that a picture is
/// a function of experiment and configuration. Not for two threads.
class Painter {
 public:
  /// Throws std::runtime_error if OpenGL cannot be had, std::invalid_argument for an impossible size or view.
  Painter(const Robot& robot, const Experiment& experiment);

  render::Image draw(const Eigen::VectorXd& q);
  const std::string& gl_info() const { return renderer_.gl_info(); }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  rbd::Model model_;
  rbd::Data data_;
  std::vector<std::string> warnings_;
  render::Scene scene_;
  render::Camera camera_;
  render::Renderer renderer_;
};

}  // namespace lab::renderer
