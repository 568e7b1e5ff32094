// Copies joints, frames and bodies of one model into another: what buildReducedModel and appendModel share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rbd/model/geometry.h"
#include "rbd/model/model.h"

namespace rbd::inner {

struct CopyPlan {
  // what the source's universe becomes in the target
  JointIndex joint = 0;  // the joint that carries it
  SE3 pose;              // where it stands in that joint's frame
  FrameIndex frame = 0;  // the frame it is

  std::string prefix;  // of every name
  // Per joint of the source: the pose of its moving part, seen from neutral, if it is welded there. Followers
  // of a welded joint are welded too.
  std::vector<std::optional<SE3>> weld;
};

// Where the source's things are in the target.
struct CopyMap {
  std::vector<JointIndex> joint;  // per joint: the joint that carries its moving part
  std::vector<SE3> pose;          // per joint: its moving part in the frame of that carrier
  std::vector<FrameIndex> frame;  // per frame
};

// Adds the source behind what the target has. A welded joint becomes a frame of type FIXED_JOINT. Throws
// std::invalid_argument in the name of `function` when a vector that users write has the wrong size.
CopyMap copyModel(const char* function, const Model& source, const CopyPlan& plan, Model& target);

// Adds the source's shapes, moved along.
void copyShapes(const GeometryModel& source, const CopyMap& map, const std::string& prefix,
                GeometryModel& target);

}  // namespace rbd::inner
