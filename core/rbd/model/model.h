// A robot: a tree of joints with inertias, limits and named frames. A plain value.
//
// Joint 0 is the universe. A parent is always added before its children, so parents[i] < i. Build it with
// addJoint and appendBodyToJoint (or from URDF), then share it const between threads; each thread makes its
// own Data. A Model may be extended later: Data made before no longer fits and the algorithms say so. SI
// units, radians; vectors of limits have nv entries (lower and upper: nq). Errors: std::invalid_argument with
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

class Model {
 public:
  template <class T>
  using List = ReadOnlyList<T, Model>;

  // Only the universe: one joint, one frame of that name, gravity (0, 0, -9.81).
  Model();

  std::string name;
  int nq = 0, nv = 0;
  int njoints = 1;  // the universe included
  int nframes = 1;
  int nbodies = 1;  // bodies appended, plus the universe

  List<JointModel> joints;
  List<std::string> names;    // of joints
  List<JointIndex> parents;   // parents[0] = 0
  List<SE3> jointPlacements;  // frame of joint i at neutral, in the frame of its parent joint
  List<Inertia> inertias;  // all bodies that move with joint i, in its frame; [0]: what stands on the ground
  List<Frame> frames;      // [0] is the universe

  Motion gravity;  // acceleration of free fall in the world; only its linear part is used

  Eigen::VectorXd lowerPositionLimit, upperPositionLimit;  // nq; -inf, +inf where nobody said
  Eigen::VectorXd velocityLimit, effortLimit;              // nv; +inf where nobody said
  Eigen::VectorXd
      armature;  // nv, kg m^2 or kg: rotor inertia seen at the joint; part of M and of all dynamics
  Eigen::VectorXd damping, friction;  // nv, N m s/rad and N m: for the simulator; no algorithm adds them

  // Adds a joint below `parent` and one JOINT frame of the same name. `placement`: frame of the new joint at
  // neutral in the parent joint's frame. Returns its index.
  JointIndex addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                      const std::string& name);
  // With limits: effort and velocity (joint nv entries, >= 0), lower and upper (joint nq entries).
  JointIndex addJoint(JointIndex parent, const JointModel& joint, const SE3& placement,
                      const std::string& name, const Eigen::VectorXd& effort, const Eigen::VectorXd& velocity,
                      const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

  // Welds a body to a joint's moving part; `placement`: the body's frame in the joint's frame.
  void appendBodyToJoint(JointIndex joint, const Inertia& body, const SE3& placement = SE3::Identity());

  // Adds a frame, returns its index. A name may be used once per type (a link may be called like its joint).
  FrameIndex addFrame(const Frame& frame);
  // A frame of type BODY.
  FrameIndex addBodyFrame(const std::string& name, JointIndex parent, const SE3& placement = SE3::Identity(),
                          FrameIndex parentFrame = 0);

  // Index by name, first hit among `types`; nframes / njoints when there is none.
  FrameIndex getFrameId(const std::string& name, FrameType types = ANY_FRAME) const;
  JointIndex getJointId(const std::string& name) const;
  bool existFrame(const std::string& name, FrameType types = ANY_FRAME) const;
  bool existJointName(const std::string& name) const;
  // The same, but a missing name throws std::out_of_range and lists names that are close to it.
  FrameIndex frameId(const std::string& name) const;
  JointIndex jointId(const std::string& name) const;

  // Changes after building, for calibration and for models that are wrong on purpose.
  void setInertia(JointIndex joint, const Inertia& inertia);
  void setJointPlacement(JointIndex joint, const SE3& placement);
  void setFramePlacement(FrameIndex frame, const SE3& placement);

  // Scratch for one thread; needs rbd/model/data.h.
  Data createData() const;

  // For the kernels: one entry per joint, universe included.
  const std::vector<PackedJoint>& packed() const { return packed_; }
  // A hash of the joints' kinds and parents: models that agree in it can share a Data.
  std::uint64_t topology() const { return topology_; }

 private:
  void requireJoint(const char* function, JointIndex joint) const;
  void pack(JointIndex joint);

  std::vector<PackedJoint> packed_;
  std::uint64_t topology_ = 14695981039346656037u;  // FNV-1a
  std::unordered_map<std::string, JointIndex> jointByName_;
  std::unordered_map<std::string, FrameIndex> frameByName_;  // first frame of that name
};

}  // namespace rbd
