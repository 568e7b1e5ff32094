#include "rbd/model/model.h"

#include <limits>
#include <stdexcept>

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

// `limit` must have n entries that are not NaN and not below `least`.
void requireLimit(const std::string& joint, const char* what, const Eigen::VectorXd& limit, int n,
                  double least) {
  if (limit.size() != n) {
    fail("addJoint '" + joint + "': " + what + " limit has " + std::to_string(limit.size()) +
         " entries, the joint needs " + std::to_string(n));
  }
  for (int k = 0; k < n; ++k) {
    if (!(limit[k] >= least)) {
      fail("addJoint '" + joint + "': " + what + " limit must not be " + std::to_string(limit[k]));
    }
  }
}

void storeMatrix(double* out, const Eigen::Matrix3d& m) {
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) out[4 * c + r] = m(r, c);
    out[4 * c + 3] = 0;
  }
}

void storeVector(double* out, const Eigen::Vector3d& v) {
  for (int r = 0; r < 3; ++r) out[r] = v[r];
  out[3] = 0;
}

Eigen::Matrix3d turnOf(const JointModel& joint) {
  return joint.axis().isZero() ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : turnZTo(joint.axis());
}

KernelKind kernelKind(JointKind kind) {
  switch (kind) {
    case JointKind::Fixed:
      return kNone;
    case JointKind::Revolute:
    case JointKind::Continuous:
      return kTurnZ;
    case JointKind::Prismatic:
      return kSlideZ;
    case JointKind::FreeFlyer:
      return kFree;
  }
  return kNone;
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
  packed_.resize(1);
  pack(0);
}

void Model::requireJoint(const char* function, JointIndex joint) const {
  if (joint < 0 || joint >= njoints) {
    fail(std::string(function) + ": joint index " + std::to_string(joint) + " does not exist, model '" +
         name + "' has " + std::to_string(njoints) + " joints (0 = universe)");
  }
}

JointIndex Model::addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                           const std::string& joint_name) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto all = [](int n, double x) { return Eigen::VectorXd::Constant(n, x); };
  return addJoint(parent, joint, placement, joint_name, all(joint.nv(), inf), all(joint.nv(), inf),
                  all(joint.nq(), -inf), all(joint.nq(), inf));
}

JointIndex Model::addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                           const std::string& joint_name, const Eigen::VectorXd& effort,
                           const Eigen::VectorXd& velocity, const Eigen::VectorXd& lower,
                           const Eigen::VectorXd& upper) {
  // check everything first, so that a refused joint leaves no trace
  requireJoint("addJoint", parent);
  if (joint.kind() == JointKind::Fixed)
    fail("addJoint '" + joint_name + "': a fixed joint is a frame, use addFrame");
  if (existJointName(joint_name)) fail("addJoint: a joint '" + joint_name + "' exists already");
  requirePose("addJoint '" + joint_name + "'", placement);
  const double inf = std::numeric_limits<double>::infinity();
  requireLimit(joint_name, "effort", effort, joint.nv(), 0);
  requireLimit(joint_name, "velocity", velocity, joint.nv(), 0);
  requireLimit(joint_name, "lower", lower, joint.nq(), -inf);
  requireLimit(joint_name, "upper", upper, joint.nq(), -inf);
  for (int k = 0; k < joint.nq(); ++k) {
    if (lower[k] > upper[k]) {
      fail("addJoint '" + joint_name + "': lower limit " + std::to_string(lower[k]) +
           " is above upper limit " + std::to_string(upper[k]));
    }
  }

  const JointIndex index = njoints++;
  joints.items_.push_back(joint);
  joints.items_.back().idx_q_ = nq;
  joints.items_.back().idx_v_ = nv;
  nq += joint.nq();
  nv += joint.nv();
  names.items_.push_back(joint_name);
  parents.items_.push_back(parent);
  jointPlacements.items_.push_back(placement);
  inertias.items_.emplace_back();
  append(effortLimit, effort);
  append(velocityLimit, velocity);
  append(lowerPositionLimit, lower);
  append(upperPositionLimit, upper);
  const Eigen::VectorXd zeros = Eigen::VectorXd::Zero(joint.nv());
  append(armature, zeros);
  append(damping, zeros);
  append(friction, zeros);
  jointByName_[joint_name] = index;
  packed_.resize(static_cast<std::size_t>(njoints));
  pack(index);
  for (const int x : {static_cast<int>(parent), static_cast<int>(joint.kind())}) {
    topology_ = (topology_ ^ static_cast<std::uint64_t>(x)) * 1099511628211u;
  }
  const FrameIndex parent_frame = getFrameId(names[parent], FrameType(JOINT | FIXED_JOINT));
  addFrame(Frame(joint_name, index, parent_frame, SE3::Identity(), JOINT));
  return index;
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
  frames.items_.push_back(frame);
  frameByName_.emplace(frame.name, nframes);
  return nframes++;
}

FrameIndex Model::addBodyFrame(const std::string& frame_name, JointIndex parent, const SE3& placement,
                               FrameIndex parentFrame) {
  return addFrame(Frame(frame_name, parent, parentFrame, placement, BODY));
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

void Model::pack(JointIndex i) {
  const JointModel& joint = joints[i];
  const Eigen::Matrix3d turn = turnOf(joint), parent_turn = turnOf(joints[parents[i]]);
  const SE3& placement = jointPlacements[i];
  const Inertia& body = inertias[i];
  const Eigen::Matrix3d place = parent_turn.transpose() * placement.rotation() * turn;
  const Eigen::Vector3d com = turn.transpose() * body.lever();
  const Eigen::Matrix3d inertia = turn.transpose() * body.inertia() * turn;

  PackedJoint& p = packed_[static_cast<std::size_t>(i)];
  p = PackedJoint{};
  storeMatrix(p.turn, turn);
  storeMatrix(p.turnT, turn.transpose());
  storeMatrix(p.place, place);
  storeMatrix(p.placeT, place.transpose());
  storeVector(p.offset, Eigen::Vector3d(parent_turn.transpose() * placement.translation()));
  storeMatrix(p.inertia, inertia);
  storeMatrix(p.inertiaO, Inertia(body.mass(), com, inertia).matrix().topLeftCorner<3, 3>());
  storeVector(p.com, com);
  storeVector(p.moment, Eigen::Vector3d(body.mass() * com));
  p.mass = body.mass();
  p.parent = parents[i];
  p.kind = kernelKind(joint.kind());
  p.idx_q = joint.idx_q();
  p.idx_v = joint.idx_v();
  p.nv = joint.nv();
}

}  // namespace rbd
