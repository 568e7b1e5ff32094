// A robot as the kernels see it: a tree of bodies, each moved by a joint of one of a few simple kinds.
// Internal.
//
// It differs from the user's Model in three ways, so that no kernel needs to know of them:
// - every joint with one axis is ALIGNED (by R_user): its kernel frame has the user's origin and a z axis
//   along the joint axis, so that one kernel moves all of them about or along z. Results are converted
//   back to the user's frame in algorithm/to_user_frames.h;
// - a universal joint is two turning joints with a massless body between;
// - joints that mimic others are independent: the tree has its own q and v (tree.nq, tree.nv entries),
//   computed from the user's by a linear map; its transpose maps efforts back (kernel/mimic.h).
// Plain doubles, so that any scalar type can be loaded from them; 3-vectors take 4 places (the last is 0), 3x3
// matrices three such columns.
#pragma once

#include <vector>

#include "rbd/model/joint.h"

namespace rbd {

struct alignas(64) PackedJoint {
  double R_user[12];             // kernel frame of this joint in the user's frame of this joint
  double R_user_T[12];           // its transpose
  double R_parent[12];           // kernel frame at q = 0 in the parent's kernel frame: rotation,
  double R_parent_T[12];         // its transpose,
  double p_parent[4];            // and origin (m)
  double inertia[12];            // rotational inertia about the CENTRE OF MASS, kernel axes (kg m^2)
  double inertia_at_origin[12];  // the same about the joint's origin
  double com[4];                 // centre of mass from the joint's origin, kernel axes (m)
  double moment[4];              // mass * com (kg m)
  double mass;
  double pitch;  // ScrewZ: m/rad
  int parent;    // in KernelTree::joints
  KernelKind kind;
  int idx_q, idx_v, nv;
};

// From the user's q and v to the tree's:  q_tree[k] = ratio[k] q[source[k]] + offset[k], and v alike without
// offset.
struct MimicMap {
  bool identity = true;  // no mimic joints: the tree's q and v are the user's
  std::vector<int> q_source, v_source;
  std::vector<double> q_ratio, q_offset, v_ratio;
};

// A contiguous block of the user's q and v: a run of vector-space entries (several joints), or one joint's
// rotation or pose.
struct ConfigurationBlock {
  Manifold manifold;
  int idx_q, idx_v, nv;
  // The entries of q that form a unit vector: a quaternion, or cosine and sine.
  int unit_at = 0, unit_size = 0;
};

struct KernelTree {
  std::vector<PackedJoint> joints;  // [0] is the universe
  std::vector<int> bodyOf;          // per joint of the model: the entry of `joints` that moves with it
  int nq = 0, nv = 0;               // counting every joint as independent
  MimicMap mimic;
  std::vector<ConfigurationBlock> blocks;  // of the user's q, in order

  int size() const { return static_cast<int>(joints.size()); }
};

}  // namespace rbd
