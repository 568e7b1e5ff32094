#include "procs/renderer/robot_scene.h"

#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/kinematics.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "procs/renderer/parts.h"

namespace lab::renderer {
namespace {

/// m: from corner to corner of the box around the robot's joints, at rest.
double size(const rbd::Model& model) {
  rbd::Data data(model);
  rbd::forwardKinematics(model, data, rbd::neutral(model));
  Eigen::AlignedBox3d box;
  for (const rbd::SE3& joint : data.oMi) box.extend(joint.translation());
  return std::max(0.25, box.diagonal().norm());
}

}  // namespace

std::vector<render::Body> make_bodies(const Robot& robot, const std::string& quality,
                                      std::vector<std::string>& links, std::vector<std::string>& warnings) {
  std::vector<render::Body> bodies;
  // of the robot's size: less than a pixel of a picture of 640 x 480 that shows all of it
  constexpr double kInvisible = 0.0025;
  PartMaker maker(robot, quality == "fine" ? 0 : kInvisible * size(robot.model), warnings);
  for (rbd::JointIndex joint = 0; joint < static_cast<rbd::JointIndex>(robot.model.njoints); ++joint) {
    render::Body body;
    body.name = robot.model.names[joint];
    for (const auto& shape : robot.geometry.visual) {
      if (shape.parentJoint != joint) continue;
      body.parts.push_back(maker.part(shape));
      const std::string& link = robot.model.frames[shape.parentFrame].name;
      const auto known = std::find(links.begin(), links.end(), link);
      body.parts.back().id = static_cast<uint16_t>(known - links.begin());
      if (known == links.end()) links.push_back(link);
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

void place_bodies(const rbd::Data& data, std::vector<render::Body>& bodies) {
  for (size_t joint = 0; joint < bodies.size(); ++joint) bodies[joint].pose = isometry(data.oMi[joint]);
}

void pose_bodies(const rbd::Model& model, rbd::Data& data, const Eigen::VectorXd& q,
                 std::vector<render::Body>& bodies) {
  rbd::forwardKinematics(model, data, q);
  place_bodies(data, bodies);
}

}  // namespace lab::renderer
