#include "procs/renderer/painter.h"

#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/kinematics.h>

#include "procs/experiment/joints.h"
#include "procs/renderer/parts.h"

namespace lab::renderer {
namespace {

render::Camera frame_camera(const Experiment& experiment, const rbd::Model& model, rbd::Data& data, render::Scene scene) {
  render::Bounds box;
  for (const Eigen::VectorXd& q : expected_poses(experiment, model)) {
    pose_scene(model, data, q, scene);
    box.extend(render::bounds(scene));
  }
  const auto& size = experiment.renderer.size;
  return render::auto_frame(box, experiment.renderer.camera, static_cast<double>(size[0]) / static_cast<double>(size[1]));
}

}  // namespace

render::Scene make_scene(const Robot& robot, const std::string& quality, std::vector<std::string>& warnings) {
  render::Scene scene;
  PartMaker maker(robot, quality, warnings);
  for (rbd::JointIndex joint = 0; joint < static_cast<rbd::JointIndex>(robot.model.njoints); ++joint) {
    render::Body body;
    body.name = robot.model.names[joint];
    for (const auto& shape : robot.geometry.visual)
      if (shape.parentJoint == joint) body.parts.push_back(maker.part(shape));
    scene.bodies.push_back(std::move(body));
  }
  return scene;
}

void pose_scene(const rbd::Model& model, rbd::Data& data, const Eigen::VectorXd& q, render::Scene& scene) {
  rbd::forwardKinematics(model, data, q);
  for (size_t joint = 0; joint < scene.bodies.size(); ++joint) scene.bodies[joint].pose = isometry(data.oMi[joint]);
}

std::vector<Eigen::VectorXd> expected_poses(const Experiment& experiment, const rbd::Model& model) {
  const Eigen::VectorXd neutral = rbd::neutral(model);
  const Eigen::VectorXd start = configuration(experiment, "simulator.q0", experiment.simulator.q0, model, neutral);
  std::vector<Eigen::VectorXd> poses{start};
  const auto& planner = experiment.planner;
  if (planner.goal.given()) {
    const Eigen::VectorXd goal = configuration(experiment, "planner.goal", planner.goal, model, start);
    for (int i = 1; i <= 8; ++i) poses.push_back(rbd::interpolate(model, start, goal, i / 8.0));
  }
  if (planner.amplitude.given() && model.nq == model.nv) {
    const Eigen::VectorXd amplitude = joint_vector(experiment, "planner.amplitude", planner.amplitude, model, 0.0);
    const Eigen::VectorXd centre = joint_vector(experiment, "planner.offset", planner.offset, model, start);
    for (double side : {-1.0, -0.5, 0.5, 1.0}) poses.push_back(centre + side * amplitude);
  }
  return poses;
}

Painter::Painter(const Robot& robot, const Experiment& experiment)
    : model_(robot.model),
      data_(model_),
      scene_(make_scene(robot, experiment.renderer.quality, warnings_)),
      camera_(frame_camera(experiment, model_, data_, scene_)),
      renderer_(static_cast<int>(experiment.renderer.size[0]), static_cast<int>(experiment.renderer.size[1]),
                render::quality_from_name(experiment.renderer.quality)) {}

render::Image Painter::draw(const Eigen::VectorXd& q) {
  pose_scene(model_, data_, q, scene_);
  return renderer_.draw(scene_, camera_);
}

}  // namespace lab::renderer
