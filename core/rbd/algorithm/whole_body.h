// Sums over all bodies: mass, centre of mass, momentum. The universe's own body is left out.
#pragma once

#include <stdexcept>
#include <string>

#include "rbd/algorithm/data.h"
#include "rbd/algorithm/to_user_frames.h"
#include "rbd/kernel/mimic.h"

namespace rbd::inner {

// Total mass and first moment about the centre, the universe's own left out.
struct Sum {
  double mass = 0;
  Vec3<double> moment = Vec3<double>::zero();
};

inline Vec3<double> bodyCom(const Joints& joints, int i, const Scratch<double>& s) {
  return s.p[i] + times(s.R[i], joints[i].com);
}

inline Sum firstMoment(const Model& model, const Scratch<double>& s) {
  Sum sum;
  for (int i = 1; i < model.tree().size(); ++i) {
    const double m = model.tree().joints[i].mass;
    sum.mass += m;
    sum.moment = sum.moment + bodyCom(model.tree().joints, i, s) * m;
  }
  return sum;
}

// The centre of mass from the centre; fills data.mass and data.com.
inline Vec3<double> storeCom(const char* function, const Model& model, Data& data) {
  const Sum sum = firstMoment(model, data.work().scratch);
  if (!(sum.mass > 0)) {
    throw std::runtime_error(std::string(function) + ": model '" + model.name +
                             "' has no moving mass, so no centre of mass");
  }
  const Vec3<double> com = sum.moment * (1 / sum.mass);
  data.mass[0] = sum.mass;
  data.com[0] = toEigen(com + data.work().scratch.centre);
  return com;
}

inline void worldPosesOf(const Model& model, Data& data, const ConstVectorRef& q) {
  const double* const tree_q = expandQ(model, data.work(), q);
  sinesAndCosines(model, tree_q, data.work().scratch);
  worldPoses(model.tree().joints, tree_q, data.work().scratch);
}

// World velocities, and accelerations without gravity where qdd is given; then the momentum of all bodies and
// its rate, about the centre. Needs worldPoses.
struct Momentum {
  SpatialForce<double> h = SpatialForce<double>::zero(), dh = SpatialForce<double>::zero();
};

inline Momentum momentum(const Model& model, Data& data, const ConstVectorRef& v, const ConstVectorRef* a) {
  Workspace& work = data.work();
  const double* const qd = expandV(model, work.v, v);
  const double* const qdd = a ? expandV(model, work.a, *a) : nullptr;
  Scratch<double>& s = work.scratch;
  const Joints& joints = model.tree().joints;
  Momentum sum;
  s.v[0] = s.a[0] = SpatialMotion<double>::zero();
  for (int i = 1; i < model.tree().size(); ++i) {
    const PackedJoint& joint = joints[i];
    worldSubspace(joint, i, s);
    const SpatialMotion<double> vJ = jointMotion(joint, qd, s);
    s.v[i] = s.v[joint.parent] + vJ;
    const RigidInertia<double> I = worldInertia(joint, s.R[i], s.p[i]);
    const SpatialForce<double> h = I * s.v[i];
    sum.h = sum.h + h;
    if (!qdd) continue;
    s.a[i] = s.a[joint.parent] + cross(s.v[joint.parent], vJ) + jointMotion(joint, qdd, s);
    sum.dh = sum.dh + I * s.a[i] + crossForce(s.v[i], h);
  }
  return sum;
}

}  // namespace rbd::inner
