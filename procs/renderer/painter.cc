#include "procs/renderer/painter.h"

#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/kinematics.h>

#include <map>

#include "procs/experiment/joints.h"

namespace lab::renderer {
namespace {

Eigen::Isometry3d isometry(const rbd::SE3& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = pose.rotation(), out.translation() = pose.translation();
  return out;
}

render::MeshPtr mesh_of(const rbd::GeometryObject& shape) {
  switch (shape.shape) {
    case rbd::Shape::Box: return render::make_box(shape.size);
    case rbd::Shape::Cylinder: return render::make_cylinder(shape.size[0], shape.size[1]);
    case rbd::Shape::Sphere: return render::make_sphere(shape.size[0]);
    case rbd::Shape::Capsule: return render::make_capsule(shape.size[0], shape.size[1]);
    case rbd::Shape::Mesh: break;
  }
  if (shape.mesh.empty()) throw std::runtime_error(shape.meshUri + ": not found");
  return render::load_mesh(shape.mesh);
}

render::Part part_of(const rbd::GeometryObject& shape, std::map<std::string, render::MeshPtr>& cache, std::vector<std::string>& warnings) {
  render::Part part;
  part.pose = isometry(shape.placement);
  if (shape.hasColor) part.rgba = shape.rgba.cast<float>();
  try {
    render::MeshPtr& cached = cache[shape.shape == rbd::Shape::Mesh ? shape.mesh : shape.name];
    if (!cached) cached = mesh_of(shape);
    part.mesh = cached;
    if (shape.shape == rbd::Shape::Mesh) part.scale = shape.scale;
  } catch (const std::exception& error) {
    warnings.push_back(shape.name + ": " + error.what() + "; drawn as a magenta box");
    part.mesh = render::make_box({0.1, 0.1, 0.1});
    part.rgba = {1, 0, 1, 1};
  }
  return part;
}

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

render::Scene make_scene(const Robot& robot, std::vector<std::string>& warnings) {
  render::Scene scene;
  std::map<std::string, render::MeshPtr> cache;
  for (rbd::JointIndex joint = 0; joint < static_cast<rbd::JointIndex>(robot.model.njoints); ++joint) {
    render::Body body;
    body.name = robot.model.names[joint];
    for (const auto& shape : robot.geometry.visual)
      if (shape.parentJoint == joint) body.parts.push_back(part_of(shape, cache, warnings));
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
      scene_(make_scene(robot, warnings_)),
      camera_(frame_camera(experiment, model_, data_, scene_)),
      renderer_(static_cast<int>(experiment.renderer.size[0]), static_cast<int>(experiment.renderer.size[1]),
                render::quality_from_name(experiment.renderer.quality)) {}

render::Image Painter::draw(const Eigen::VectorXd& q) {
  pose_scene(model_, data_, q, scene_);
  return renderer_.draw(scene_, camera_);
}

}  // namespace lab::renderer
