#include <Eigen/Geometry>

#include "procs/experiment/robot.h"

namespace lab {
namespace {

rbd::SE3 motion_of(const rbd::JointModel& joint, double q) {
  if (joint.kind() == rbd::JointKind::Prismatic) return {Eigen::Matrix3d::Identity(), q * joint.axis()};
  return {Eigen::AngleAxisd(q, joint.axis()).toRotationMatrix(), Eigen::Vector3d::Zero()};
}

}  // namespace

void lock_joints(rbd::Model& model, rbd::GeometryModel& geometry,
                 const std::map<std::string, double>& where) {
  const rbd::Model old = std::move(model);
  rbd::Model out;
  out.name = old.name;
  out.gravity = old.gravity;

  // where each old joint's moving part is found now: a joint, and a pose in it
  struct Home {
    rbd::JointIndex joint = 0;
    rbd::SE3 pose;
  };
  std::vector<Home> home(old.njoints);
  std::vector<int> frame(old.nframes, 0);
  const auto copy_joint = [&](int j) {
    const rbd::JointModel& joint = old.joints[j];
    const Home& parent = home[old.parents[j]];
    const rbd::SE3 placement = parent.pose * old.jointPlacements[j];
    if (const auto lock = where.find(old.names[j]); lock != where.end()) {
      home[j] = {parent.joint, placement * motion_of(joint, lock->second)};
      return false;
    }
    const int q = joint.idx_q(), nq = joint.nq(), v = joint.idx_v(), nv = joint.nv();
    home[j].joint = out.addJoint(parent.joint, joint, placement, old.names[j], old.upperEffortLimit.segment(v, nv),
                                 old.upperVelocityLimit.segment(v, nv), old.lowerPositionLimit.segment(q, nq),
                                 old.upperPositionLimit.segment(q, nq));
    out.armature.tail(nv) = old.armature.segment(v, nv);
    out.damping.tail(nv) = old.damping.segment(v, nv);
    out.friction.tail(nv) = old.friction.segment(v, nv);
    return true;
  };

  // frames keep their order; a joint is made where its own frame stands, so parents come first
  for (int f = 1; f < old.nframes; ++f) {
    rbd::Frame copy = old.frames[f];
    if (copy.type == rbd::JOINT) {
      if (copy_joint(copy.parentJoint)) {
        frame[f] = out.nframes - 1;
        continue;
      }
      copy.type = rbd::FIXED_JOINT;
    }
    const Home& carrier = home[copy.parentJoint];
    copy.placement = carrier.pose * copy.placement;
    copy.parentJoint = carrier.joint;
    copy.parentFrame = frame[copy.parentFrame];
    frame[f] = out.addFrame(copy);
  }
  for (int j = 0; j < old.njoints; ++j)
    if (old.inertias[j].mass() > 0) out.appendBodyToJoint(home[j].joint, old.inertias[j], home[j].pose);
  out.nbodies = old.nbodies;

  for (std::vector<rbd::GeometryObject>* shapes : {&geometry.visual, &geometry.collision})
    for (rbd::GeometryObject& shape : *shapes) {
      const Home& carrier = home[shape.parentJoint];
      shape.placement = carrier.pose * shape.placement;
      shape.parentJoint = carrier.joint;
      shape.parentFrame = frame[shape.parentFrame];
    }
  model = std::move(out);
}

}  // namespace lab
