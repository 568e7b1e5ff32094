#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/kernels.h"
#include "rbd/algorithm/rnea.h"
#include "rbd/kernel/forward_passes.h"
#include "rbd/kernel/mimic.h"

namespace rbd {
namespace inner {

// What rneaKernel gives for v = a = 0, in world axes. Here f is the pull of gravity, (c x m g, m g) summed
// over what the joint carries; the joints must hold against it, hence the minus.
template <class Scalar>
void gravityKernel(const Model& model, Scratch<Scalar>& s, const Scalar* q, Scalar* tau) {
  const Joints& joints = model.tree().joints;
  sinesAndCosines(model, q, s);
  worldPoses(joints, q, s);
  const Vec3<Scalar> g = gravity<Scalar>(model);
  s.f[0] = SpatialForce<Scalar>::zero();
  for (int i = 1; i < model.tree().size(); ++i) {
    worldSubspace(joints[i], i, s);
    const Vec3<Scalar> c = s.p[i] + times(s.R[i], joints[i].com);
    const Vec3<Scalar> f = g * Scalar(joints[i].mass);
    s.f[i] = {cross(c, f), f};
  }
  for (int i = model.tree().size() - 1; i > 0; --i) {
    for (int k = joints[i].idx_v; k < joints[i].idx_v + joints[i].nv; ++k) tau[k] = -dot(s.S[k], s.f[i]);
    s.f[joints[i].parent] = s.f[joints[i].parent] + s.f[i];
  }
}

template void gravityKernel(const Model&, Scratch<double>&, const double*, double*);
template void gravityKernel(const Model&, Scratch<long double>&, const long double*, long double*);

}  // namespace inner

const Eigen::VectorXd& computeGeneralizedGravity(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("computeGeneralizedGravity", model, data, q);
  inner::Workspace& work = data.work();
  inner::gravityKernel(model, work.scratch, inner::expandQ(model, work, q),
                       inner::kernelOutput(model, work, data.g));
  inner::collapse(model, work, data.g);
  return data.g;
}

void computeGeneralizedGravity(const Model& model, Data& data, const ConstVectorRef& q, VectorRef g) {
  inner::checkOut("computeGeneralizedGravity", "g", model, g, model.nv, "nv");
  g = computeGeneralizedGravity(model, data, q);
}

const Eigen::VectorXd& computeStaticTorque(const Model& model, Data& data, const ConstVectorRef& q,
                                           const FrameWrenches& wrenches) {
  data.tau = computeGeneralizedGravity(model, data, q);
  inner::addWrenchEfforts("computeStaticTorque", model, data, q, wrenches, -1, data.tau);
  return data.tau;
}

}  // namespace rbd
