// How a Model keeps the tree that the kernels see (packed_joint.h) in step with itself.
#include "rbd/model/model.h"

namespace rbd {
namespace {

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

// The moving body's kernel frame in the user's frame of the joint.
Eigen::Matrix3d userFromKernel(const JointModel& joint) {
  const Eigen::Vector3d& axis = joint.axis2().isZero() ? joint.axis() : joint.axis2();
  return axis.isZero() ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : rotationWithZ(axis);
}

// Of a joint that stands at `placement` between the user's frames; R_before and R_user are the kernel frames of
// its parent and its own, each in the user's frame of that joint.
void placeKernelFrame(PackedJoint& p, const Eigen::Matrix3d& R_before, const SE3& placement,
                      const Eigen::Matrix3d& R_user) {
  const Eigen::Matrix3d R_parent = R_before.transpose() * placement.rotation() * R_user;
  storeMatrix(p.R_user, R_user);
  storeMatrix(p.R_user_T, R_user.transpose());
  storeMatrix(p.R_parent, R_parent);
  storeMatrix(p.R_parent_T, R_parent.transpose());
  storeVector(p.p_parent, Eigen::Vector3d(R_before.transpose() * placement.translation()));
}

// A body given in the user's frame of its joint.
void storeBody(PackedJoint& p, const Inertia& body, const Eigen::Matrix3d& R_user) {
  const Eigen::Vector3d com = R_user.transpose() * body.lever();
  const Eigen::Matrix3d inertia = R_user.transpose() * body.inertia() * R_user;
  storeMatrix(p.inertia, inertia);
  storeMatrix(p.inertia_at_origin, Inertia(body.mass(), com, inertia).matrix().topLeftCorner<3, 3>());
  storeVector(p.com, com);
  storeVector(p.moment, Eigen::Vector3d(body.mass() * com));
  p.mass = body.mass();
}

}  // namespace

void Model::grow(const JointModel& joint, JointIndex parent) {
  const int count = traits(joint.kind()).kernel_joints;
  for (int k = 0; k < count; ++k) {
    PackedJoint p{};
    p.parent = k == 0 ? tree_.bodyOf[parent] : tree_.size() - 1;
    p.kind = traits(joint.kind()).kernel;
    p.pitch = joint.pitch();
    p.idx_q = tree_.nq;
    p.idx_v = tree_.nv;
    p.nv = joint.kind_nv() / count;
    tree_.nq += joint.kind_nq() / count;
    tree_.nv += p.nv;
    tree_.joints.push_back(p);
  }
  tree_.bodyOf.push_back(tree_.size() - 1);
}

void Model::pack(JointIndex i) {
  const JointModel& joint = joints[i];
  const Eigen::Matrix3d R_user = userFromKernel(joint);
  PackedJoint& body = tree_.joints[static_cast<std::size_t>(tree_.bodyOf[i])];
  if (traits(joint.kind()).kernel_joints == 2) {
    PackedJoint& first = *(&body - 1);
    const Eigen::Matrix3d between = rotationWithZ(joint.axis());
    placeKernelFrame(first, userFromKernel(joints[parents[i]]), jointPlacements[i], between);
    placeKernelFrame(body, between, SE3::Identity(), R_user);
  } else {
    placeKernelFrame(body, userFromKernel(joints[parents[i]]), jointPlacements[i], R_user);
  }
  storeBody(body, inertias[i], R_user);
}

void Model::renumber() {
  int q = 0, v = 0;
  for (JointIndex j = 1; j < njoints; ++j) {
    JointModel& joint = joints.items_[j];
    joint.idx_q_ = q;
    joint.idx_v_ = v;
    q += joint.nq();
    v += joint.nv();
  }
  for (JointIndex j = 1; j < njoints; ++j) {
    if (!joints[j].mimics()) continue;
    JointIndex leader = j;
    while (joints[leader].mimics()) leader = mimics_[leader].leader;
    joints.items_[j].idx_q_ = joints[leader].idx_q();
    joints.items_[j].idx_v_ = joints[leader].idx_v();
    tree_.mimic.identity = false;
  }
  tree_.blocks.clear();
  for (JointIndex j = 1; j < njoints; ++j) {
    mapJoint(j);
    appendBlock(joints[j]);
  }
}

void Model::appendBlock(const JointModel& joint) {
  if (joint.nv() == 0) return;
  std::vector<ConfigurationBlock>& blocks = tree_.blocks;
  if (isVectorSpace(joint.manifold()) && !blocks.empty() && isVectorSpace(blocks.back().manifold)) {
    blocks.back().nv += joint.nv();
    return;
  }
  ConfigurationBlock block{joint.manifold(), joint.idx_q(), joint.idx_v(), joint.nv()};
  block.unit_at = joint.unit_part().at;
  block.unit_size = joint.unit_part().size;
  blocks.push_back(block);
}

void Model::mapJoint(JointIndex j) {
  double ratio = 1, offset = 0;  // q of joint j = ratio * q of joint `leader` + offset
  for (JointIndex leader = j; joints[leader].mimics(); leader = mimics_[leader].leader) {
    offset += ratio * mimics_[leader].offset;
    ratio *= mimics_[leader].multiplier;
  }
  MimicMap& map = tree_.mimic;
  map.q_source.resize(tree_.nq);
  map.q_ratio.resize(tree_.nq);
  map.q_offset.resize(tree_.nq);
  map.v_source.resize(tree_.nv);
  map.v_ratio.resize(tree_.nv);
  const int first = tree_.bodyOf[j] - traits(joints[j].kind()).kernel_joints + 1;
  const int at_q = tree_.joints[first].idx_q, at_v = tree_.joints[first].idx_v;
  for (int k = 0; k < joints[j].kind_nq(); ++k) {
    map.q_source[at_q + k] = joints[j].idx_q() + k;
    map.q_ratio[at_q + k] = ratio;
    map.q_offset[at_q + k] = offset;
  }
  for (int k = 0; k < joints[j].kind_nv(); ++k) {
    map.v_source[at_v + k] = joints[j].idx_v() + k;
    map.v_ratio[at_v + k] = ratio;
  }
}

}  // namespace rbd
