#include "rbd/algorithm/centroidal.h"

#include <stdexcept>

#include "rbd/algorithm/inner/joint_terms.h"
#include "rbd/algorithm/inner/mimic.h"
#include "rbd/algorithm/inner/public_face.h"

namespace rbd {
namespace {

using inner::Joints;
using inner::Scratch;
using Vec = inner::Vec3<double>;
using Wrench = inner::Force<double>;
using Twist = inner::Motion<double>;

// Total mass and first moment about the centre, the universe's own left out.
struct Sum {
  double mass = 0;
  Vec moment = Vec::zero();
};

Vec bodyCom(const Joints& joints, int i, const Scratch<double>& s) {
  return s.p[i] + times(s.R[i], joints[i].com);
}

Sum firstMoment(const Model& model, const Scratch<double>& s) {
  Sum sum;
  for (int i = 1; i < model.tree().size(); ++i) {
    const double m = model.tree().joints[i].mass;
    sum.mass += m;
    sum.moment = sum.moment + bodyCom(model.tree().joints, i, s) * m;
  }
  return sum;
}

// The centre of mass from the centre; fills data.mass and data.com.
Vec storeCom(const char* function, const Model& model, Data& data) {
  const Sum sum = firstMoment(model, data.work().d);
  if (!(sum.mass > 0)) {
    throw std::runtime_error(std::string(function) + ": model '" + model.name +
                             "' has no moving mass, so no centre of mass");
  }
  const Vec com = sum.moment * (1 / sum.mass);
  data.mass[0] = sum.mass;
  data.com[0] = inner::toEigen(com + data.work().d.centre);
  return com;
}

void worldPosesOf(const Model& model, Data& data, const ConstVectorRef& q) {
  const double* const tree_q = inner::treeQ(model, data.work(), q);
  inner::angles(model, tree_q, data.work().d);
  inner::worldPoses(model.tree().joints, tree_q, data.work().d);
}

// World velocities, and accelerations without gravity where qdd is given; then the momentum of all bodies and
// its rate, about the centre. Needs worldPoses.
struct Momentum {
  Wrench h = Wrench::zero(), dh = Wrench::zero();
};

Momentum momentum(const Model& model, Data& data, const ConstVectorRef& v, const ConstVectorRef* a) {
  inner::Workspace& work = data.work();
  const double* const qd = inner::treeV(model, work.v, v);
  const double* const qdd = a ? inner::treeV(model, work.a, *a) : nullptr;
  Scratch<double>& s = work.d;
  const Joints& joints = model.tree().joints;
  Momentum sum;
  s.v[0] = s.a[0] = Twist::zero();
  for (int i = 1; i < model.tree().size(); ++i) {
    const PackedJoint& joint = joints[i];
    worldColumns(joint, i, s);
    const Twist vJ = jointMotion(joint, qd, s);
    s.v[i] = s.v[joint.parent] + vJ;
    const inner::RigidInertia<double> I = worldInertia(joint, s.R[i], s.p[i]);
    const Wrench h = I * s.v[i];
    sum.h = sum.h + h;
    if (!qdd) continue;
    s.a[i] = s.a[joint.parent] + cross(s.v[joint.parent], vJ) + jointMotion(joint, qdd, s);
    sum.dh = sum.dh + I * s.a[i] + crossForce(s.v[i], h);
  }
  return sum;
}

// The same wrench about the point c.
Force about(const Vec& c, const Wrench& x) {
  return {inner::toEigen(x.n - cross(c, x.f)), inner::toEigen(x.f)};
}

void requireVelocity(const char* function, const Model& model, const Data& data) {
  inner::checkData(function, model, data);
  if (data.kinematics_order < 1) inner::failOrder(function, "forwardKinematics(model, data, q, v)");
}

}  // namespace

const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("centerOfMass", model, data, q);
  worldPosesOf(model, data, q);
  storeCom("centerOfMass", model, data);
  return data.com[0];
}

const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q,
                                    const ConstVectorRef& v) {
  inner::checkInputs("centerOfMass", model, data, q, "v", v);
  worldPosesOf(model, data, q);
  storeCom("centerOfMass", model, data);
  data.vcom[0] = inner::toEigen(momentum(model, data, v, nullptr).h.f) / data.mass[0];
  return data.com[0];
}

void centerOfMass(const Model& model, Data& data, const ConstVectorRef& q, Eigen::Vector3d& com) {
  com = centerOfMass(model, data, q);
}

const PaddedMatrix& jacobianCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("jacobianCenterOfMass", model, data, q);
  worldPosesOf(model, data, q);
  storeCom("jacobianCenterOfMass", model, data);
  Scratch<double>& s = data.work().d;
  const Joints& joints = model.tree().joints;
  double* const out = inner::treeColumns(model, data.work().Jcom, data.Jcom);
  // I[i].m and I[i].h: mass and first moment of everything that joint i carries
  for (int i = 0; i < model.tree().size(); ++i) {
    s.I[i].m = joints[i].mass;
    s.I[i].h = bodyCom(joints, i, s) * joints[i].mass;
  }
  for (int i = model.tree().size() - 1; i > 0; --i) {
    worldColumns(joints[i], i, s);
    for (int k = joints[i].idx_v; k < joints[i].idx_v + joints[i].nv; ++k) {
      const Vec column = s.column[k].v * s.I[i].m + cross(s.column[k].w, s.I[i].h);
      (column * (1 / data.mass[0])).storeU(out + 8 * k);
    }
    s.I[joints[i].parent].m += s.I[i].m;
    s.I[joints[i].parent].h = s.I[joints[i].parent].h + s.I[i].h;
  }
  inner::gatherColumns(model, data.work().Jcom, data.Jcom);
  return data.Jcom;
}

void jacobianCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef J) {
  inner::checkOut("jacobianCenterOfMass", "J", J, 3, model.nv);
  J = jacobianCenterOfMass(model, data, q);
}

const Force& computeCentroidalMomentum(const Model& model, Data& data, const ConstVectorRef& q,
                                       const ConstVectorRef& v) {
  inner::checkInputs("computeCentroidalMomentum", model, data, q, "v", v);
  worldPosesOf(model, data, q);
  const Vec com = storeCom("computeCentroidalMomentum", model, data);
  return data.hg = about(com, momentum(model, data, v, nullptr).h);
}

const Force& computeCentroidalMomentum(const Model& model, Data& data) {
  requireVelocity("computeCentroidalMomentum", model, data);
  return computeCentroidalMomentum(model, data, data.q_in, data.v_in);
}

void computeCentroidalMomentum(const Model& model, Data& data, const ConstVectorRef& q,
                               const ConstVectorRef& v, Force& hg) {
  hg = computeCentroidalMomentum(model, data, q, v);
}

const Force& computeCentroidalMomentumTimeVariation(const Model& model, Data& data, const ConstVectorRef& q,
                                                    const ConstVectorRef& v, const ConstVectorRef& a) {
  const char* const name = "computeCentroidalMomentumTimeVariation";
  inner::checkInputs(name, model, data, q, "v", v, "a", a);
  worldPosesOf(model, data, q);
  const Vec com = storeCom(name, model, data);
  const Momentum sum = momentum(model, data, v, &a);
  data.hg = about(com, sum.h);
  return data.dhg = about(com, sum.dh);
}

const Force& computeCentroidalMomentumTimeVariation(const Model& model, Data& data) {
  requireVelocity("computeCentroidalMomentumTimeVariation", model, data);
  if (data.kinematics_order < 2) data.a_in.setZero();
  return computeCentroidalMomentumTimeVariation(model, data, data.q_in, data.v_in, data.a_in);
}

void computeCentroidalMomentumTimeVariation(const Model& model, Data& data, const ConstVectorRef& q,
                                            const ConstVectorRef& v, const ConstVectorRef& a, Force& dhg) {
  dhg = computeCentroidalMomentumTimeVariation(model, data, q, v, a);
}

double computeKineticEnergy(const Model& model, Data& data, const ConstVectorRef& q,
                            const ConstVectorRef& v) {
  inner::checkInputs("computeKineticEnergy", model, data, q, "v", v);
  worldPosesOf(model, data, q);
  Scratch<double>& s = data.work().d;
  momentum(model, data, v, nullptr);
  double twice = 0;
  for (int i = 1; i < model.tree().size(); ++i) {
    twice += dot(s.v[i], worldInertia(model.tree().joints[i], s.R[i], s.p[i]) * s.v[i]);
  }
  for (int k = 0; k < model.nv; ++k) twice += inner::rotorOf(model, k) * v[k] * v[k];
  return data.kinetic_energy = twice / 2;
}

double computePotentialEnergy(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("computePotentialEnergy", model, data, q);
  worldPosesOf(model, data, q);
  const Scratch<double>& s = data.work().d;
  const Sum sum = firstMoment(model, s);
  return data.potential_energy = -dot(inner::gravity<double>(model), sum.moment + s.centre * sum.mass);
}

}  // namespace rbd
