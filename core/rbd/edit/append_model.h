// Two robots made one: an arm on a body, a hand on an arm.
#pragma once

#include <string>

#include "rbd/model/geometry.h"
#include "rbd/model/model.h"

namespace rbd {

// `model` with `other` behind it: other's universe is welded to the frame `parentFrame` of model, at
// `placement` in that frame; what stood on other's ground moves with it. other's joints and frames (but its
// frame "universe") come last, in their order, with `prefix` before their names, and keep all they have:
// mimic, limits, rotors, damping, friction, inertias. Name, gravity and terms are model's.
//
// Throws std::invalid_argument: a frame that does not exist, a placement that is no pose, a name that is used
// in both (the message lists them: give a prefix).
Model appendModel(const Model& model, const Model& other, FrameIndex parentFrame,
                  const SE3& placement = SE3::Identity(), const std::string& prefix = "");

// And the shapes of both; `out` is replaced (it may be one of the two).
Model appendModel(const Model& model, const GeometryModel& geometry, const Model& other,
                  const GeometryModel& other_geometry, FrameIndex parentFrame, const SE3& placement,
                  const std::string& prefix, GeometryModel& out);

}  // namespace rbd
