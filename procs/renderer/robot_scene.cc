#include "procs/renderer/robot_scene.h"

#include <rbd/algorithm/kinematics.h>

#include <algorithm>
#include <map>

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

}  // namespace

std::vector<render::Body> make_bodies(const Robot& robot, std::vector<std::string>& links, std::vector<std::string>& warnings) {
  std::vector<render::Body> bodies;
  std::map<std::string, render::MeshPtr> cache;
  for (rbd::JointIndex joint = 0; joint < static_cast<rbd::JointIndex>(robot.model.njoints); ++joint) {
    render::Body body;
    body.name = robot.model.names[joint];
    for (const auto& shape : robot.geometry.visual) {
      if (shape.parentJoint != joint) continue;
      body.parts.push_back(part_of(shape, cache, warnings));
      const std::string& link = robot.model.frames[shape.parentFrame].name;
      const auto known = std::find(links.begin(), links.end(), link);
      body.parts.back().id = static_cast<uint16_t>(known - links.begin());
      if (known == links.end()) links.push_back(link);
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

void pose_bodies(const rbd::Model& model, rbd::Data& data, const Eigen::VectorXd& q, std::vector<render::Body>& bodies) {
  rbd::forwardKinematics(model, data, q);
  for (size_t joint = 0; joint < bodies.size(); ++joint) bodies[joint].pose = isometry(data.oMi[joint]);
}

}  // namespace lab::renderer
