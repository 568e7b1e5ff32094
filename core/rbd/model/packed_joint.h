// What the kernels read of one joint, laid out for them. Users never see it.
//
// Every one-dof joint is TURNED when it is added: its kernel frame has the user's origin and a z axis along
// the joint axis, so that one kernel moves all of them about or along z. Only here and at the public face do
// the two frames meet:  R_user = R_kernel * turn^T.  Plain doubles, so that any scalar type can be loaded
// from them; 3-vectors take 4 places (the last is 0), 3x3 matrices three such columns.
#pragma once

namespace rbd {

struct alignas(64) PackedJoint {
  double turn[12];      // kernel frame of this joint in the user's frame of this joint
  double turnT[12];     // its transpose
  double place[12];     // kernel frame at q = 0 in the parent's kernel frame: rotation,
  double placeT[12];    // its transpose,
  double offset[4];     // and origin (m)
  double inertia[12];   // rotational inertia about the CENTRE OF MASS, kernel axes (kg m^2)
  double inertiaO[12];  // the same about the joint's origin
  double com[4];        // centre of mass from the joint's origin, kernel axes (m)
  double moment[4];     // mass * com (kg m)
  double mass;
  int parent;
  int kind;  // KernelKind
  int idx_q, idx_v, nv;
};

// How a joint moves once it is turned; see algorithm/joint_kinds.h.
enum KernelKind { kNone, kTurnZ, kSlideZ, kFree };

}  // namespace rbd
