#include "rbd/algorithm/rnea.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/kernels.h"
#include "rbd/kernel/forward_passes.h"
#include "rbd/kernel/mimic.h"
#include "rbd/kernel/rotor_and_friction.h"

namespace rbd {
namespace inner {

// Featherstone 2008, table 5.1, every body in its own axes. External forces are not part of this kernel: they
// are applied afterwards as J' f (addWrenchEfforts). A null qdd means zero.
template <class Scalar>
void rneaKernel(const Model& model, Scratch<Scalar>& s, const Scalar* q, const Scalar* qd, const Scalar* qdd,
                Scalar* tau) {
  const Joints& joints = model.tree().joints;
  const int n = model.tree().size();
  sinesAndCosines(model, q, s);

  // outward pass: velocities, accelerations; gravity enters as an upward acceleration of the base
  s.v[0] = SpatialMotion<Scalar>::zero();
  s.a[0] = {Vec3<Scalar>::zero(), -gravity<Scalar>(model)};
  for (int i = 1; i < n; ++i) {
    const PackedJoint& joint = joints[i];
    const Scalar* rate = qd + joint.idx_v;
    jointPose(joint, q, s, s.X[i]);
    const Pose<Scalar>& X = s.X[i];
    s.v[i] = plusS(joint, X.toChild(s.v[joint.parent]), rate);
    s.a[i] = X.toChild(s.a[joint.parent]) + crossS(joint, s.v[i], rate);
    if (qdd) s.a[i] = plusS(joint, s.a[i], qdd + joint.idx_v);

    // net force on body i: the Newton-Euler equation
    const RigidInertia<Scalar> I = {Mat3<Scalar>::load(joint.inertia_at_origin),
                                    Vec3<Scalar>::load(joint.moment), Scalar(joint.mass)};
    s.f[i] = I * s.a[i] + crossForce(s.v[i], I * s.v[i]);
  }

  // inward pass: joint i transmits the force that its whole subtree needs
  s.f[0] = SpatialForce<Scalar>::zero();  // accumulated like the others, never read
  for (int i = n - 1; i > 0; --i) {
    const PackedJoint& joint = joints[i];
    transposeS(joint, s.f[i], tau + joint.idx_v);
    s.f[joint.parent] = s.f[joint.parent] + s.X[i].toParent(s.f[i]);
  }
}

template void rneaKernel(const Model&, Scratch<double>&, const double*, const double*, const double*,
                         double*);
template void rneaKernel(const Model&, Scratch<long double>&, const long double*, const long double*,
                         const long double*, long double*);
}  // namespace inner

const Eigen::VectorXd& rnea(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a) {
  inner::checkInputs("rnea", model, data, q, "v", v, "a", a);
  inner::Workspace& work = data.work();
  // expand, collapse: the map of mimic joints (kernel/mimic.h); no-ops without mimic joints
  inner::rneaKernel(model, work.scratch, inner::expandQ(model, work, q), inner::expandV(model, work.v, v),
                    inner::expandV(model, work.a, a), inner::kernelOutput(model, work, data.tau));
  inner::collapse(model, work, data.tau);
  inner::addRotorEfforts(model, a, data.tau);
  inner::addFrictionEfforts(model, v, 1, data.tau);
  inner::checkResult("rnea", model, data.tau);
  return data.tau;
}

void rnea(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
          const ConstVectorRef& a, VectorRef tau) {
  inner::checkOut("rnea", "tau", model, tau, model.nv, "nv");
  tau = rnea(model, data, q, v, a);
}

const Eigen::VectorXd& rnea(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a, const FrameWrenches& wrenches) {
  rnea(model, data, q, v, a);
  inner::addWrenchEfforts("rnea", model, data, q, wrenches, -1, data.tau);
  return data.tau;
}

const Eigen::VectorXd& nonLinearEffects(const Model& model, Data& data, const ConstVectorRef& q,
                                        const ConstVectorRef& v) {
  inner::checkInputs("nonLinearEffects", model, data, q, "v", v);
  inner::Workspace& work = data.work();
  inner::rneaKernel<double>(model, work.scratch, inner::expandQ(model, work, q),
                            inner::expandV(model, work.v, v), nullptr,
                            inner::kernelOutput(model, work, data.nle));
  inner::collapse(model, work, data.nle);
  inner::addFrictionEfforts(model, v, 1, data.nle);
  inner::checkResult("nonLinearEffects", model, data.nle);
  return data.nle;
}

void nonLinearEffects(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                      VectorRef nle) {
  inner::checkOut("nonLinearEffects", "nle", model, nle, model.nv, "nv");
  nle = nonLinearEffects(model, data, q, v);
}

}  // namespace rbd
