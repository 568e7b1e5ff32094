// What a robot looks like: shapes rigidly attached to the joints of a Model.
//
// Plain data, no algorithm: the renderer draws `visual`; `collision` is kept for other programs. With a
// Data after forwardKinematics, a shape stands in the world at  data.oMi[parentJoint] * placement.
//
// Units: metres, radians. Shapes sit in their own frame as in URDF: box centred; cylinder and capsule
// centred, along their z axis; sphere centred; mesh as the file has it, times `scale`.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rbd/model/joint.h"
#include "rbd/spatial/transform.h"

namespace rbd {

enum class Shape { Box, Cylinder, Sphere, Capsule, Mesh };

struct GeometryObject {
  std::string name;                 // "LINK_0", "LINK_1", ..: the link and a running number
  FrameIndex parentFrame = 0;       // of the link's BODY frame in Model::frames
  JointIndex parentJoint = 0;       // of the joint that carries it; 0 = the universe
  SE3 placement = SE3::Identity();  // pose of the shape in the frame of parentJoint

  Shape shape = Shape::Box;
  // Box: the three edges. Cylinder: radius, length, 0. Capsule: radius, length between the centres of its
  // two half spheres, 0. Sphere: radius, 0, 0. Mesh: unused (zero).
  Eigen::Vector3d size = Eigen::Vector3d::Zero();

  std::string mesh;     // file on disk; empty if it was not found (the loader warned) or not a mesh
  std::string meshUri;  // as written in the model: "package://robot/meshes/hand.dae"
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  // of the mesh, along its own axes; may mirror (negative)

  bool hasColor = false;  // false: the model names no colour; a mesh then uses its own
  Eigen::Vector4d rgba = Eigen::Vector4d(0.7, 0.7, 0.7, 1.0);  // each in 0..1
};

struct GeometryModel {
  std::vector<GeometryObject> visual;
  std::vector<GeometryObject> collision;
};

}  // namespace rbd
