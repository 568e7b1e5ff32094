#include "rbd/edit/model_copy.h"

#include <stdexcept>

namespace rbd::inner {
namespace {

// What a model says per entry of q, and per entry of v.
constexpr Eigen::VectorXd Model::* kPerQ[] = {&Model::lowerPositionLimit, &Model::upperPositionLimit};
constexpr Eigen::VectorXd Model::* kPerV[] = {&Model::lowerVelocityLimit,
                                              &Model::upperVelocityLimit,
                                              &Model::lowerEffortLimit,
                                              &Model::upperEffortLimit,
                                              &Model::armature,
                                              &Model::rotorInertia,
                                              &Model::rotorGearRatio,
                                              &Model::damping,
                                              &Model::friction};

// Users may write these vectors; a wrong size would be read beyond its end.
void requireSizes(const char* function, const Model& model) {
  const auto require = [&](const Eigen::VectorXd& x, int needed, const char* what) {
    if (x.size() == needed) return;
    throw std::invalid_argument(std::string(function) + ": a vector of model '" + model.name + "' has " +
                                std::to_string(x.size()) + " entries where " + std::to_string(needed) + " (" +
                                what + ") are needed: limits, rotors, damping, friction");
  };
  for (const auto list : kPerQ) require(model.*list, model.nq, "nq");
  for (const auto list : kPerV) require(model.*list, model.nv, "nv");
}

void copyNumbers(const Model& source, JointIndex from, Model& target, JointIndex to) {
  const JointModel &a = source.joints[from], &b = target.joints[to];
  for (const auto list : kPerQ)
    (target.*list).segment(b.idx_q(), b.nq()) = (source.*list).segment(a.idx_q(), a.nq());
  for (const auto list : kPerV)
    (target.*list).segment(b.idx_v(), b.nv()) = (source.*list).segment(a.idx_v(), a.nv());
}

// The frame that addJoint made.
bool isJointsOwn(const Model& model, const Frame& frame) {
  return frame.type == JOINT && frame.name == model.names[frame.parentJoint];
}

bool isNothing(const Inertia& body) { return body.mass() == 0 && body.inertia().isZero(0); }

// All bodies of the source go to their carriers. Sums are taken here: a model's inertias may hold more than
// its frames do, and what nothing is welded to stays the same to the last bit.
void copyBodies(const Model& source, const CopyMap& map, std::vector<Inertia> bodies, Model& target) {
  bodies.resize(static_cast<std::size_t>(target.njoints));
  for (JointIndex j = 0; j < source.njoints; ++j) {
    const Inertia body = map.pose[j].act(source.inertias[j]);
    Inertia& sum = bodies[static_cast<std::size_t>(map.joint[j])];
    if (isNothing(body)) continue;
    sum = isNothing(sum) ? body : sum + body;
  }
  for (JointIndex j = 0; j < target.njoints; ++j) target.setInertia(j, bodies[static_cast<std::size_t>(j)]);
}

}  // namespace

CopyMap copyModel(const char* function, const Model& source, const CopyPlan& plan, Model& target) {
  requireSizes(function, source);
  requireSizes(function, target);
  CopyMap map;
  map.joint.assign(static_cast<std::size_t>(source.njoints), plan.joint);
  map.pose.assign(static_cast<std::size_t>(source.njoints), plan.pose);
  map.frame.assign(static_cast<std::size_t>(source.nframes), plan.frame);
  const std::vector<Inertia> bodies = target.inertias;
  const int nbodies = target.nbodies + source.nbodies - 1;
  const auto welded = [&](JointIndex j) -> const SE3* {  // where; null: it moves
    if (plan.weld.empty()) return nullptr;
    const std::optional<SE3>& pose = plan.weld[j];
    return pose ? &*pose : nullptr;
  };

  // frames keep their order; a joint is made where its own frame stands, so parents come first
  for (FrameIndex f = 1; f < source.nframes; ++f) {
    Frame frame = source.frames[f];
    const JointIndex j = frame.parentJoint;
    const bool own = isJointsOwn(source, frame);
    frame.name = plan.prefix + frame.name;
    if (own) {
      const JointIndex parent = source.parents[j];
      const SE3 placement = map.pose[parent] * source.jointPlacements[j];
      const SE3* weld = welded(j);
      if (!weld) {
        map.joint[j] = target.addJoint(map.joint[parent], source.joints[j], placement, frame.name);
        map.pose[j] = SE3::Identity();
        map.frame[f] = target.nframes - 1;
        target.setFramePlacement(map.frame[f], frame.placement);
        continue;
      }
      map.joint[j] = map.joint[parent];
      map.pose[j] = placement * *weld;
      frame.type = FIXED_JOINT;
    }
    frame.placement = map.pose[j] * frame.placement;
    frame.parentJoint = map.joint[j];
    frame.parentFrame = map.frame[frame.parentFrame];
    map.frame[f] = target.addFrame(frame);
  }

  for (JointIndex j = 1; j < source.njoints; ++j) {
    const Mimic& mimic = source.mimic(j);
    if (mimic.leader >= 0 && !welded(j))
      target.setMimic(map.joint[j], map.joint[mimic.leader], mimic.multiplier, mimic.offset);
  }
  // only now: a joint that begins to follow moves everyone's place in q and v
  for (JointIndex j = 1; j < source.njoints; ++j) {
    if (!welded(j) && !source.joints[j].mimics()) copyNumbers(source, j, target, map.joint[j]);
  }
  copyBodies(source, map, bodies, target);
  target.nbodies = nbodies;
  return map;
}

void copyShapes(const GeometryModel& source, const CopyMap& map, const std::string& prefix,
                GeometryModel& target) {
  const auto copy = [&](const std::vector<GeometryObject>& from, std::vector<GeometryObject>& to) {
    for (GeometryObject shape : from) {
      shape.name = prefix + shape.name;
      shape.placement = map.pose[shape.parentJoint] * shape.placement;
      shape.parentFrame = map.frame[shape.parentFrame];
      shape.parentJoint = map.joint[shape.parentJoint];
      to.push_back(std::move(shape));
    }
  };
  copy(source.visual, target.visual);
  copy(source.collision, target.collision);
}

}  // namespace rbd::inner
