// A robot: a tree of joints with inertias, limits and named frames. A plain value.
//
// Joint 0 is the universe. A parent is always added before its children, so parents[i] < i. Build it with
// addJoint and appendBodyToJoint (or from URDF), then share it const between threads; each thread makes its
// own Data. A Model may be extended later: a Data made earlier no longer fits, which algorithms report. SI
// units, radians; position limits have nq entries, all other vectors nv. Errors: std::invalid_argument with
// names and values; nothing is changed when a call throws.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "rbd/model/frame.h"
#include "rbd/model/joint.h"
#include "rbd/model/packed_joint.h"
#include "rbd/model/read_only_list.h"
#include "rbd/spatial/spatial.h"

namespace rbd {

struct Data;

// Bounds of one joint, in its own numbers. An empty vector means no bound.
struct JointLimits {
  Eigen::VectorXd lowerPosition, upperPosition;  // nq
  Eigen::VectorXd lowerVelocity, upperVelocity;  // nv
  Eigen::VectorXd lowerEffort, upperEffort;      // nv
};

// How a joint follows another: q = multiplier * q(leader) + offset. leader < 0: it follows none.
struct Mimic {
  JointIndex leader = -1;
  double multiplier = 1, offset = 0;
};

// Which effects of the joints' mechanics are part of the dynamics:
//   tau = (M + rotors) a + nle,   nle = bias + damping v + friction tanh(v / kSlipSpeed) (friction.h)
struct JointTerms {
  bool armature = true;   // Model::armature, in M
  bool rotor = true;      // rotorGearRatio^2 rotorInertia, in M
  bool damping = false;   // in rnea, nonLinearEffects, aba and their derivatives
  bool friction = false;  // the same; smoothed below kSlipSpeed
};

class Model {
 public:
  template <class T>
  using List = ReadOnlyList<T, Model>;

  // Only the universe: one joint, one frame of that name, gravity (0, 0, -9.81).
  Model();
  ~Model();
  Model(const Model& other);
  Model(Model&& other) noexcept;
  Model& operator=(const Model& other);
  Model& operator=(Model&& other) noexcept;

  std::string name;
  int nq = 0, nv = 0;
  int njoints = 1;  // the universe included
  int nframes = 1;
  int nbodies = 1;  // bodies appended, plus the universe

  List<JointModel> joints;
  List<std::string> names;    // of joints
  List<JointIndex> parents;   // parents[0] = 0
  List<SE3> jointPlacements;  // frame of joint i at neutral, in the frame of its parent joint
  List<Inertia> inertias;  // all bodies that move with joint i, in its frame; [0]: bodies fixed to the world
  List<Frame> frames;      // [0] is the universe

  Motion gravity;  // acceleration of free fall in the world; only its linear part is used

  Eigen::VectorXd lowerPositionLimit, upperPositionLimit;  // nq; -inf, +inf where no limit is given
  Eigen::VectorXd lowerVelocityLimit, upperVelocityLimit;  // nv; the same
  Eigen::VectorXd lowerEffortLimit, upperEffortLimit;      // nv; the same
  Eigen::VectorXd armature;                                // kg m^2 or kg: inertia seen at the joint
  Eigen::VectorXd rotorInertia, rotorGearRatio;  // kg m^2 or kg, of the motor; motor turns per joint turn
  Eigen::VectorXd damping, friction;             // N m s/rad and N m
  JointTerms terms;                              // which of these the algorithms include

  // Adds a joint below `parent` and one JOINT frame of the same name. `placement`: frame of the new joint at
  // neutral in the parent joint's frame. Returns its index.
  JointIndex addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                      const std::string& name);
  // `parentFrame`: its parent in printed trees (a link, for example); -1: the frame of the parent joint.
  JointIndex addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                      const std::string& name, const JointLimits& limits, FrameIndex parentFrame = -1);
  // With symmetric limits: effort and velocity (joint nv entries, >= 0), lower and upper (joint nq entries).
  JointIndex addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                      const std::string& name, const Eigen::VectorXd& effort, const Eigen::VectorXd& velocity,
                      const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

  // Makes a one-dof joint follow another, which may follow a third: q = multiplier q(leader) + offset. The
  // follower then has no entries in q and v, and no limits, armature or friction of its own.
  void setMimic(JointIndex follower, JointIndex leader, double multiplier = 1, double offset = 0);
  const Mimic& mimic(JointIndex joint) const { return mimics_[static_cast<std::size_t>(joint)]; }

  // Welds a body to a joint's moving part; `placement`: the body's frame in the joint's frame.
  void appendBodyToJoint(JointIndex joint, const Inertia& body, const SE3& placement = SE3::Identity());

  // Adds a frame, returns its index. A name may be used once per type (a link may have its joint's name).
  // A frame that carries inertia is a body: it is welded to its joint as by appendBodyToJoint.
  FrameIndex addFrame(const Frame& frame);
  // A frame of type BODY.
  FrameIndex addBodyFrame(const std::string& name, JointIndex parent, const SE3& placement = SE3::Identity(),
                          FrameIndex parentFrame = 0, const Inertia& inertia = Inertia::Zero());

  // Index by name, first hit among `types`; nframes / njoints when there is none.
  FrameIndex getFrameId(const std::string& name, FrameType types = ANY_FRAME) const;
  JointIndex getJointId(const std::string& name) const;
  bool existFrame(const std::string& name, FrameType types = ANY_FRAME) const;
  bool existJointName(const std::string& name) const;
  // The same, but a missing name throws std::out_of_range and lists names that are close to it.
  FrameIndex frameId(const std::string& name) const;
  JointIndex jointId(const std::string& name) const;

  // Changes after building, for calibration and for deliberately wrong models.
  void setInertia(JointIndex joint, const Inertia& inertia);
  void setJointPlacement(JointIndex joint, const SE3& placement);
  void setFramePlacement(FrameIndex frame, const SE3& placement);

  // Scratch for one thread; needs rbd/algorithm/data.h.
  Data createData() const;

  // What the kernels read.
  const KernelTree& tree() const { return tree_; }
  // A hash of the joints' kinds, parents and leaders: models that agree in it can share a Data.
  std::uint64_t topology() const { return topology_; }

 private:
  void requireJoint(const char* function, JointIndex joint) const;
  void pack(JointIndex joint);
  // Adds a new joint's bodies to the kernels' tree.
  void grow(const JointModel& joint, JointIndex parent);
  // Assigns idx_q and idx_v of every joint and rebuilds the mimic map.
  void renumber();
  void mapJoint(JointIndex joint);
  void appendBlock(const JointModel& joint);
  void hash(int x) { topology_ = (topology_ ^ static_cast<std::uint64_t>(x)) * 1099511628211u; }

  KernelTree tree_;
  std::vector<Mimic> mimics_;
  std::uint64_t topology_ = 14695981039346656037u;  // FNV-1a
  std::unordered_map<std::string, JointIndex> jointByName_;
  std::unordered_map<std::string, FrameIndex> frameByName_;  // first frame of that name
};

}  // namespace rbd
