#include "rbd/algorithm/aba.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/cholesky.h"
#include "rbd/algorithm/crba.h"
#include "rbd/algorithm/kernels.h"
#include "rbd/algorithm/rnea.h"
#include "rbd/kernel/articulate.h"
#include "rbd/kernel/rotor_and_friction.h"

namespace rbd {
namespace inner {

// Featherstone 2008, table 7.1, in world axes, so that inertias and forces of children simply add to their
// parent's. s.S[k] is the table's S, dof by dof. Differences from the table:
// - pass 1 also computes the acceleration a due to velocities and gravity alone (all qdd = 0) and the force f
//   that it requires: the table's pA plus I a. Passes 2 and 3 solve for the difference to that motion: there
//   is no term Ia c, and pass 3 starts from 0 instead of minus gravity;
// - D includes the rotor inertia of the dof; external forces are already part of tau, as J' f;
// - the dofs of one joint are eliminated one by one, as if there were massless bodies between them.
template <class Scalar>
int abaKernel(const Model& model, const double* rotor, Scratch<Scalar>& s, const Scalar* q, const Scalar* qd,
              const Scalar* tau, Scalar* qdd, Scalar& D) {
  const Joints& joints = model.tree().joints;
  const int n = model.tree().size();
  sinesAndCosines(model, q, s);
  worldPoses(joints, q, s);

  // pass 1, outward: velocities, accelerations at qdd = 0, and the force f they require
  s.v[0] = SpatialMotion<Scalar>::zero();
  s.a[0] = {Vec3<Scalar>::zero(), -gravity<Scalar>(model)};
  for (int i = 1; i < n; ++i) {
    const PackedJoint& joint = joints[i];
    worldSubspace(joint, i, s);
    const SpatialMotion<Scalar> vJ = jointMotion(joint, qd, s);
    s.v[i] = s.v[joint.parent] + vJ;
    s.a[i] = s.a[joint.parent] + cross(s.v[joint.parent], vJ);  // = v[i] x vJ, as vJ x vJ = 0
    const RigidInertia<Scalar> I = worldInertia(joint, s.R[i], s.p[i]);
    s.f[i] = I * s.a[i] + crossForce(s.v[i], I * s.v[i]);
    s.IA[i] = ArticulatedInertia<Scalar>::rigid(I);
  }

  // pass 2, inward. For each dof articulate computes U = IA S, D = S' U + rotor, calls the lambda (u, and the
  // table's pa in f), then subtracts U U' / D from IA (the table's Ia). IA and f are added to the parent's.
  const int singular_dof = articulate(joints, rotor, s, D, [&](int i, int k) {
    s.u[k] = tau[k] - dot(s.S[k], s.f[i]);
    s.f[i] = s.f[i] + s.U[k] * (s.u[k] * s.inverseD[k]);
  });
  if (singular_dof >= 0) return singular_dof;

  // pass 3, outward: accelerations, relative to those of pass 1
  s.a[0] = SpatialMotion<Scalar>::zero();
  for (int i = 1; i < n; ++i) {
    const PackedJoint& joint = joints[i];
    s.a[i] = s.a[joint.parent];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) {
      qdd[k] = (s.u[k] - dot(s.a[i], s.U[k])) * s.inverseD[k];
      s.a[i] = s.a[i] + s.S[k] * qdd[k];
    }
  }
  return -1;
}

template int abaKernel(const Model&, const double*, Scratch<double>&, const double*, const double*,
                       const double*, double*, double&);
template int abaKernel(const Model&, const double*, Scratch<long double>&, const long double*,
                       const long double*, const long double*, long double*, long double&);

}  // namespace inner

namespace {

// Computes data.ddq from work.effort.
const Eigen::VectorXd& solveMotion(const Model& model, Data& data, const ConstVectorRef& q,
                                   const ConstVectorRef& v) {
  inner::Workspace& work = data.work();
  if (!model.tree().mimic.identity) {
    // mimic joints couple dofs of different bodies; table 7.1 has none: M a = tau - nle, nle with friction
    data.ddq = work.effort - nonLinearEffects(model, data, q, v);
    crba(model, data, q);
    cholesky::decompose(model, data);
    cholesky::solve(model, data, data.ddq);
    inner::checkResult("aba", model, data.ddq);
    return data.ddq;
  }
  // no mimic joints: the tree's q, v and tau are the user's; friction is subtracted from tau
  inner::addFrictionEfforts(model, v, -1, work.effort);
  double D = 0;
  const int singular_dof = inner::abaKernel(model, inner::rotors(model, work), work.scratch, q.data(),
                                            v.data(), work.effort.data(), data.ddq.data(), D);
  if (singular_dof >= 0) inner::failSingular("aba", model, singular_dof, D);
  inner::checkResult("aba", model, data.ddq);
  return data.ddq;
}

}  // namespace

const Eigen::VectorXd& aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau) {
  inner::checkInputs("aba", model, data, q, "v", v, "tau", tau);
  data.work().effort = tau;
  return solveMotion(model, data, q, v);
}

const Eigen::VectorXd& aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau, const FrameWrenches& wrenches) {
  inner::checkInputs("aba", model, data, q, "v", v, "tau", tau);
  data.work().effort = tau;
  inner::addWrenchEfforts("aba", model, data, q, wrenches, 1, data.work().effort);
  return solveMotion(model, data, q, v);
}

void aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
         const ConstVectorRef& tau, VectorRef ddq) {
  inner::checkOut("aba", "ddq", model, ddq, model.nv, "nv");
  ddq = aba(model, data, q, v, tau);
}

void aba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
         const ConstVectorRef& tau, const FrameWrenches& wrenches, VectorRef ddq) {
  inner::checkOut("aba", "ddq", model, ddq, model.nv, "nv");
  ddq = aba(model, data, q, v, tau, wrenches);
}

}  // namespace rbd
