#include "rbd/edit/append_model.h"

#include <stdexcept>
#include <utility>
#include <vector>

#include "rbd/algorithm/argument_checks.h"
#include "rbd/edit/model_copy.h"

namespace rbd {
namespace {

constexpr const char* kAppendModel = "appendModel";

// Joints and frames of `other` whose names would be there twice, a name once.
std::vector<std::string> clashes(const Model& model, const Model& other, const std::string& prefix) {
  std::vector<std::string> names;
  for (FrameIndex f = 1; f < other.nframes; ++f) {
    const Frame& frame = other.frames[f];
    const std::string name = prefix + frame.name;
    // every joint has a frame, but a frame of that name may be of another type
    if (model.existFrame(name, frame.type) || (frame.type == JOINT && model.existJointName(name))) {
      names.push_back(name);
    }
  }
  return names;
}

void refuseClashes(const Model& model, const Model& other, const std::string& prefix) {
  const std::vector<std::string> names = clashes(model, other, prefix);
  if (names.empty()) return;
  constexpr std::size_t kMost = 5;
  std::string list;
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) list += (i ? ", '" : "'") + names[i] + "'";
  if (names.size() > kMost) list += " and " + std::to_string(names.size() - kMost) + " more";
  throw std::invalid_argument(std::string(kAppendModel) + ": '" + model.name + "' and '" + other.name +
                              "' both have " + list + "; give " + (prefix.empty() ? "a" : "another") +
                              " prefix");
}

std::pair<Model, inner::CopyMap> append(const Model& model, const Model& other, FrameIndex parentFrame,
                                        const SE3& placement, const std::string& prefix) {
  inner::checkFrame(kAppendModel, model, parentFrame);
  if (!placement.translation().allFinite() || !isRotation(placement.rotation(), 1e-6)) {
    throw std::invalid_argument(std::string(kAppendModel) +
                                ": the placement is not a pose (finite translation, orthonormal rotation)");
  }
  refuseClashes(model, other, prefix);
  const Frame& parent = model.frames[parentFrame];
  inner::CopyPlan plan;
  plan.joint = parent.parentJoint;
  plan.pose = parent.placement * placement;
  plan.frame = parentFrame;
  plan.prefix = prefix;
  Model both = model;
  inner::CopyMap map = inner::copyModel(kAppendModel, other, plan, both);
  return {std::move(both), std::move(map)};
}

}  // namespace

Model appendModel(const Model& model, const Model& other, FrameIndex parentFrame, const SE3& placement,
                  const std::string& prefix) {
  return append(model, other, parentFrame, placement, prefix).first;
}

Model appendModel(const Model& model, const GeometryModel& geometry, const Model& other,
                  const GeometryModel& other_geometry, FrameIndex parentFrame, const SE3& placement,
                  const std::string& prefix, GeometryModel& out) {
  std::pair<Model, inner::CopyMap> both = append(model, other, parentFrame, placement, prefix);
  GeometryModel shapes = geometry;
  inner::copyShapes(other_geometry, both.second, prefix, shapes);
  out = std::move(shapes);
  return std::move(both.first);
}

}  // namespace rbd
