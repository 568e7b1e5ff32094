#include "rbd/urdf/build.h"

#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "rbd/urdf/rpy.h"

namespace rbd::urdf {
namespace {

SE3 pose_of(const Origin& origin) { return SE3(rpy_to_quaternion(origin.rpy), origin.xyz); }

Inertia inertia_of(const Inertial& body) {
  const SE3 pose = pose_of(body.origin);  // where the inertia's own axes stand in the link
  return pose.act(Inertia(body.mass, Eigen::Vector3d::Zero(), body.tensor));
}

// What a file writes for "no limit" would overflow where limits are subtracted.
double limit_of(double value) {
  return std::abs(value) < 1e100 ? value : std::copysign(std::numeric_limits<double>::infinity(), value);
}

JointModel kind_of(const Joint& joint) {
  switch (joint.type) {
    case JointType::Floating:
      return JointModelFreeFlyer();
    case JointType::Planar:
      return JointModelPlanar(joint.axis);
    case JointType::Prismatic:
      return JointModelPrismaticUnaligned(joint.axis);
    case JointType::Continuous:
      return JointModelContinuous(joint.axis);
    case JointType::Fixed:  // becomes a frame, not a joint
    case JointType::Revolute:
      break;
  }
  return JointModelRevoluteUnaligned(joint.axis);
}

// One number for all dofs of a joint, as for one.
JointLimits limits_of(const Joint& joint, int nv) {
  JointLimits limits;
  if (!joint.limit) return limits;
  const auto all = [&](double x) { return Eigen::VectorXd::Constant(nv, limit_of(x)); };
  limits.lowerEffort = all(-joint.limit->effort);
  limits.upperEffort = all(joint.limit->effort);
  limits.lowerVelocity = all(-joint.limit->velocity);
  limits.upperVelocity = all(joint.limit->velocity);
  if (joint.type == JointType::Revolute || joint.type == JointType::Prismatic) {
    limits.lowerPosition = all(joint.limit->lower);
    limits.upperPosition = all(joint.limit->upper);
  }
  return limits;
}

// Builds the tree below the root link; siblings alphabetical, depth first, without recursion.
class Builder {
 public:
  Builder(const Description& robot, Model& model) : robot_(robot), model_(model) {
    for (const auto& [name, joint] : robot.joints) below_[joint.parent.link].push_back(&joint);
  }

  void add_tree(const std::string& root, bool floating_base) {
    JointIndex carrier = 0;
    if (floating_base) carrier = model_.addJoint(0, JointModelFreeFlyer(), SE3::Identity(), "root_joint");
    add_link(root, carrier, SE3::Identity(), floating_base ? last_frame() : 0);
    while (!open_.empty()) {
      const Joint& joint = *open_.back();
      open_.pop_back();
      add_joint(joint);
    }
  }

  // Leaders may stand anywhere, so this waits until all joints are there.
  void follow_leaders() {
    for (JointIndex j = 1; j < model_.njoints; ++j) {
      const auto found = robot_.joints.find(model_.names[j]);
      if (found == robot_.joints.end()) continue;  // the root joint
      const Joint& joint = found->second;
      if (!joint.mimic) continue;
      const Mimic& mimic = *joint.mimic;
      model_.setMimic(j, model_.jointId(mimic.leader), mimic.multiplier, mimic.offset);
    }
  }

 private:
  FrameIndex last_frame() const { return model_.nframes - 1; }

  void add_joint(const Joint& joint) {
    const FrameIndex above = model_.getFrameId(joint.parent.link, BODY);
    const JointIndex carrier = model_.frames[above].parentJoint;
    const SE3 placement = model_.frames[above].placement * pose_of(joint.origin);
    if (joint.type == JointType::Fixed) {
      model_.addFrame(Frame(joint.name, carrier, above, placement, FIXED_JOINT));
      add_link(joint.child.link, carrier, placement, last_frame());
    } else {
      const JointIndex index = add_moving(joint, carrier, above, placement);
      add_link(joint.child.link, index, SE3::Identity(), last_frame());
    }
  }

  JointIndex add_moving(const Joint& joint, JointIndex carrier, FrameIndex above, const SE3& placement) {
    const JointModel kind = kind_of(joint);
    const int nv = kind.kind_nv();
    const JointIndex index =
        model_.addJoint(carrier, kind, placement, joint.name, limits_of(joint, nv), above);
    const int v = model_.joints[index].idx_v();
    model_.damping.segment(v, nv).setConstant(joint.damping);
    model_.friction.segment(v, nv).setConstant(joint.friction);
    return index;
  }

  void add_link(const std::string& name, JointIndex carrier, const SE3& placement, FrameIndex above) {
    const Link& link = robot_.links.at(name);
    const Inertia inertia = link.inertial ? inertia_of(*link.inertial) : Inertia::Zero();
    model_.addBodyFrame(name, carrier, placement, above, inertia);
    if (const auto below = below_.find(name); below != below_.end())
      open_.insert(open_.end(), below->second.rbegin(), below->second.rend());
  }

  const Description& robot_;
  Model& model_;
  std::map<std::string_view, std::vector<const Joint*>> below_;  // joints by parent link, alphabetical
  std::vector<const Joint*> open_;                               // still to be added, the next one last
};

}  // namespace

void build(const Description& robot, const std::string& root, const Options& options, Model& model) {
  model.name = robot.name;
  Builder builder(robot, model);
  builder.add_tree(root, options.floating_base);
  if (options.mimic) builder.follow_leaders();
}

}  // namespace rbd::urdf
