// A named frame that is rigidly attached to a joint's moving part: a link, a tool point, a sensor.
#pragma once

#include <string>

#include "rbd/model/joint.h"
#include "rbd/spatial/spatial.h"

namespace rbd {

// Bits, so that getFrameId can look for several types at once.
enum FrameType {
  OP_FRAME = 1,     // a point the user named
  JOINT = 2,        // made by addJoint, same name as the joint
  FIXED_JOINT = 4,  // a joint of the URDF that does not move
  BODY = 8,         // a link
  SENSOR = 16,
  ANY_FRAME = 31,
};

// "OP_FRAME", "JOINT", ..
const char* frameTypeName(FrameType type);

// In which axes and about which point a spatial vector is written.
//   WORLD                axes of the world, about the world's origin (linear velocity: of the body point there)
//   LOCAL                axes of the frame, about its origin
//   LOCAL_WORLD_ALIGNED  axes of the world, about the frame's origin: the velocity a bystander sees
enum ReferenceFrame { WORLD = 0, LOCAL = 1, LOCAL_WORLD_ALIGNED = 2 };

struct Frame {
  Frame() = default;
  Frame(const std::string& name, JointIndex parentJoint, const SE3& placement, FrameType type)
      : name(name), parentJoint(parentJoint), placement(placement), type(type) {}
  Frame(const std::string& name, JointIndex parentJoint, FrameIndex parentFrame, const SE3& placement,
        FrameType type, const Inertia& inertia = Inertia::Zero())
      : name(name),
        parentJoint(parentJoint),
        parentFrame(parentFrame),
        placement(placement),
        type(type),
        inertia(inertia) {}

  std::string name;
  JointIndex parentJoint = 0;  // the joint it moves with; 0 = the universe
  FrameIndex parentFrame =
      0;          // the frame it was attached to (a link's joint, a joint's link); for tree prints
  SE3 placement;  // in the frame of parentJoint
  FrameType type = OP_FRAME;
  Inertia inertia;  // of this body alone, in this frame (a link of the URDF); zero where there is none
};

}  // namespace rbd
