#include "rbd/model/model.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "rbd/model/near_names.h"

namespace rbd {
namespace {

[[noreturn]] void fail(const std::string& text) { throw std::invalid_argument(text); }

void requirePose(const std::string& what, const SE3& pose) {
  if (!pose.translation().allFinite() || !isRotation(pose.rotation(), 1e-6)) {
    fail(what + ": the placement is not a pose (finite translation, orthonormal rotation)");
  }
}

void append(Eigen::VectorXd& all, const Eigen::VectorXd& tail) {
  const Eigen::Index n = all.size();
  all.conservativeResize(n + tail.size());
  all.tail(tail.size()) = tail;
}

void erase(Eigen::VectorXd& all, int at) {
  const Eigen::Index rest = all.size() - at - 1;
  all.segment(at, rest) = Eigen::VectorXd(all.tail(rest));
  all.conservativeResize(all.size() - 1);
}

// `limit` with `n` entries that are not NaN; an empty one becomes n times `fallback`.
Eigen::VectorXd bound(const std::string& joint, const char* what, const Eigen::VectorXd& limit, int n,
                      double fallback) {
  if (limit.size() == 0) return Eigen::VectorXd::Constant(n, fallback);
  if (limit.size() != n) {
    fail("addJoint '" + joint + "': " + what + " limit has " + std::to_string(limit.size()) +
         " entries, the joint needs " + std::to_string(n));
  }
  if (limit.hasNaN()) fail("addJoint '" + joint + "': " + what + " limit must not be nan");
  return limit;
}

struct Bounds {
  Eigen::VectorXd lower, upper;
};

Bounds bounds(const std::string& joint, const std::string& what, const Eigen::VectorXd& lower,
              const Eigen::VectorXd& upper, int n) {
  const double inf = std::numeric_limits<double>::infinity();
  const Bounds both = {bound(joint, ("lower " + what).c_str(), lower, n, -inf),
                       bound(joint, ("upper " + what).c_str(), upper, n, inf)};
  for (int k = 0; k < n; ++k) {
    if (both.lower[k] > both.upper[k]) {
      fail("addJoint '" + joint + "': lower " + what + " limit " + std::to_string(both.lower[k]) +
           " is above upper " + what + " limit " + std::to_string(both.upper[k]));
    }
  }
  return both;
}

}  // namespace

Model::Model() : gravity(Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, -9.81)) {
  joints.items_.emplace_back();
  names.items_.emplace_back("universe");
  parents.items_.push_back(0);
  jointPlacements.items_.emplace_back();
  inertias.items_.emplace_back();
  frames.items_.emplace_back("universe", 0, SE3::Identity(), FIXED_JOINT);
  jointByName_["universe"] = 0;
  frameByName_["universe"] = 0;
  mimics_.resize(1);
  tree_.bodyOf.push_back(0);
  tree_.joints.resize(1);
  pack(0);
}

Model::~Model() = default;
Model::Model(const Model& other) = default;
Model::Model(Model&& other) noexcept = default;
Model& Model::operator=(const Model& other) = default;
Model& Model::operator=(Model&& other) noexcept = default;

void Model::requireJoint(const char* function, JointIndex joint) const {
  if (joint < 0 || joint >= njoints) {
    fail(std::string(function) + ": joint index " + std::to_string(joint) + " does not exist, model '" +
         name + "' has " + std::to_string(njoints) + " joints (0 = universe)");
  }
}

JointIndex Model::addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                           const std::string& joint_name) {
  return addJoint(parent, joint, placement, joint_name, JointLimits{});
}

JointIndex Model::addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                           const std::string& joint_name, const Eigen::VectorXd& effort,
                           const Eigen::VectorXd& velocity, const Eigen::VectorXd& lower,
                           const Eigen::VectorXd& upper) {
  for (const auto& [what, limit] : {std::pair("effort", &effort), std::pair("velocity", &velocity)}) {
    for (const double x : *limit) {
      if (x < 0) fail("addJoint '" + joint_name + "': " + what + " limit must not be " + std::to_string(x));
    }
  }
  return addJoint(parent, joint, placement, joint_name,
                  JointLimits{lower, upper, -velocity, velocity, -effort, effort});
}

JointIndex Model::addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                           const std::string& joint_name, const JointLimits& limits, FrameIndex parentFrame) {
  // check everything first, so that a refused joint leaves no trace
  requireJoint("addJoint", parent);
  if (joint.kind() == JointKind::Fixed)
    fail("addJoint '" + joint_name + "': a fixed joint is a frame, use addFrame");
  if (existJointName(joint_name)) fail("addJoint: a joint '" + joint_name + "' exists already");
  if (existFrame(joint_name, JOINT))
    fail("addJoint: a frame '" + joint_name + "' of type JOINT exists already");
  requirePose("addJoint '" + joint_name + "'", placement);
  if (parentFrame >= nframes)
    fail("addJoint '" + joint_name + "': parent frame " + std::to_string(parentFrame) + " does not exist");
  const int joint_nq = joint.kind_nq(), joint_nv = joint.kind_nv();
  const Bounds effort = bounds(joint_name, "effort", limits.lowerEffort, limits.upperEffort, joint_nv);
  const Bounds speed = bounds(joint_name, "velocity", limits.lowerVelocity, limits.upperVelocity, joint_nv);
  const Bounds position =
      bounds(joint_name, "position", limits.lowerPosition, limits.upperPosition, joint_nq);

  const JointIndex index = njoints++;
  joints.items_.push_back(joint);
  joints.items_.back().mimics_ = false;
  mimics_.emplace_back();
  nq += joint_nq;
  nv += joint_nv;
  names.items_.push_back(joint_name);
  parents.items_.push_back(parent);
  jointPlacements.items_.push_back(placement);
  inertias.items_.emplace_back();
  append(lowerEffortLimit, effort.lower);
  append(upperEffortLimit, effort.upper);
  append(lowerVelocityLimit, speed.lower);
  append(upperVelocityLimit, speed.upper);
  append(lowerPositionLimit, position.lower);
  append(upperPositionLimit, position.upper);
  for (Eigen::VectorXd* x : {&armature, &rotorInertia, &rotorGearRatio, &damping, &friction}) {
    append(*x, Eigen::VectorXd::Zero(joint_nv));
  }
  jointByName_[joint_name] = index;

  joints.items_.back().idx_q_ = nq - joint_nq;
  joints.items_.back().idx_v_ = nv - joint_nv;
  grow(joint, parent);
  pack(index);
  mapJoint(index);
  appendBlock(joints.back());
  hash(parent);
  hash(static_cast<int>(joint.kind()));
  const FrameIndex parent_frame =
      parentFrame >= 0 ? parentFrame : getFrameId(names[parent], parent == 0 ? FIXED_JOINT : JOINT);
  addFrame(Frame(joint_name, index, parent_frame, SE3::Identity(), JOINT));
  return index;
}

void Model::setMimic(JointIndex follower, JointIndex leader, double multiplier, double offset) {
  requireJoint("setMimic", follower);
  requireJoint("setMimic", leader);
  const std::string what = "setMimic '" + names[follower] + "' to '" + names[leader] + "': ";
  for (const JointIndex j : {follower, leader}) {
    if (joints[j].kind_nv() != 1)
      fail(what + "'" + names[j] + "' is " + joints[j].shortname() +
           ", only joints of one degree of freedom mimic");
  }
  if (!std::isfinite(multiplier) || !std::isfinite(offset))
    fail(what + "multiplier and offset must be finite");
  for (JointIndex j = leader; j >= 0; j = mimics_[j].leader) {
    if (j == follower) fail(what + "a joint cannot follow itself");
  }
  if (!joints[follower].mimics()) {
    const int v = joints[follower].idx_v(), q = joints[follower].idx_q();
    for (Eigen::VectorXd* x : {&lowerVelocityLimit, &upperVelocityLimit, &lowerEffortLimit, &upperEffortLimit,
                               &armature, &rotorInertia, &rotorGearRatio, &damping, &friction}) {
      erase(*x, v);
    }
    erase(lowerPositionLimit, q);
    erase(upperPositionLimit, q);
    --nq;
    --nv;
    joints.items_[follower].mimics_ = true;
  }
  mimics_[follower] = {leader, multiplier, offset};
  hash(-1 - follower);
  hash(leader);
  renumber();
}

void Model::appendBodyToJoint(JointIndex joint, const Inertia& body, const SE3& placement) {
  requireJoint("appendBodyToJoint", joint);
  requirePose("appendBodyToJoint '" + names[joint] + "'", placement);
  inertias.items_[joint] += placement.act(body);
  ++nbodies;
  pack(joint);
}

FrameIndex Model::addFrame(const Frame& frame) {
  requireJoint("addFrame", frame.parentJoint);
  requirePose("addFrame '" + frame.name + "'", frame.placement);
  if (frame.parentFrame < 0 || frame.parentFrame >= nframes) {
    fail("addFrame '" + frame.name + "': parent frame " + std::to_string(frame.parentFrame) +
         " does not exist");
  }
  if (existFrame(frame.name, frame.type)) {
    fail("addFrame: a frame '" + frame.name + "' of type " + frameTypeName(frame.type) + " exists already");
  }
  if (frame.inertia.mass() != 0 || !frame.inertia.inertia().isZero(0)) {
    appendBodyToJoint(frame.parentJoint, frame.inertia, frame.placement);
  }
  frames.items_.push_back(frame);
  frameByName_.emplace(frame.name, nframes);
  return nframes++;
}

FrameIndex Model::addBodyFrame(const std::string& frame_name, JointIndex parent, const SE3& placement,
                               FrameIndex parentFrame, const Inertia& inertia) {
  return addFrame(Frame(frame_name, parent, parentFrame, placement, BODY, inertia));
}

FrameIndex Model::getFrameId(const std::string& frame_name, FrameType types) const {
  const auto hit = frameByName_.find(frame_name);
  if (hit == frameByName_.end()) return nframes;
  // names are shared by at most one frame of each type: walk on from the first
  for (FrameIndex i = hit->second; i < nframes; ++i) {
    if ((frames[i].type & types) && frames[i].name == frame_name) return i;
  }
  return nframes;
}

JointIndex Model::getJointId(const std::string& joint_name) const {
  const auto hit = jointByName_.find(joint_name);
  return hit == jointByName_.end() ? njoints : hit->second;
}

bool Model::existFrame(const std::string& frame_name, FrameType types) const {
  return getFrameId(frame_name, types) < nframes;
}

bool Model::existJointName(const std::string& joint_name) const { return getJointId(joint_name) < njoints; }

FrameIndex Model::frameId(const std::string& frame_name) const {
  const FrameIndex i = getFrameId(frame_name);
  if (i < nframes) return i;
  std::vector<std::string> all;
  for (const Frame& f : frames) all.push_back(f.name);
  throw std::out_of_range("model '" + name + "': " + missingNameMessage("frame", frame_name, all));
}

JointIndex Model::jointId(const std::string& joint_name) const {
  const JointIndex i = getJointId(joint_name);
  if (i < njoints) return i;
  throw std::out_of_range("model '" + name + "': " + missingNameMessage("joint", joint_name, names));
}

void Model::setInertia(JointIndex joint, const Inertia& inertia) {
  requireJoint("setInertia", joint);
  inertias.items_[joint] = inertia;
  pack(joint);
}

void Model::setJointPlacement(JointIndex joint, const SE3& placement) {
  requireJoint("setJointPlacement", joint);
  if (joint == 0) fail("setJointPlacement: the universe does not move");
  requirePose("setJointPlacement '" + names[joint] + "'", placement);
  jointPlacements.items_[joint] = placement;
  pack(joint);
}

void Model::setFramePlacement(FrameIndex frame, const SE3& placement) {
  if (frame < 0 || frame >= nframes)
    fail("setFramePlacement: frame " + std::to_string(frame) + " does not exist");
  requirePose("setFramePlacement '" + frames[frame].name + "'", placement);
  frames.items_[frame].placement = placement;
}

}  // namespace rbd
