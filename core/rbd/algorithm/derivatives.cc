#include "rbd/algorithm/derivatives.h"

#include "rbd/algorithm/aba.h"
#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/minverse.h"
#include "rbd/kernel/mimic.h"
#include "rbd/kernel/motion_rates.h"
#include "rbd/kernel/rotor_and_friction.h"

namespace rbd {
namespace inner {
namespace {

struct Derivatives {
  double *dq, *dv;  // nv x nv, column-major
  int stride;
};

// Singh, Russell, Wensing 2022, in world axes. With I, B, F of the subtree of joint i (motion_rates.h
// has Sd, Psid, Psidd), a change of dof l in that subtree or in joint i changes the forces there by
//   I Psidd_l + 2 B Psid_l + S_l x* F,    its rate by    I (Sd_l + Psid_l) + 2 B S_l.
// For a joint in the subtree of l, the last force term is a rigid motion of all of it and cancels.
void rneaDerivativesKernel(const Model& model, const int* dof_parent, Scratch<double>& s, const double* q,
                           const double* qd, const double* qdd, const Derivatives& out) {
  const Joints& joints = model.tree().joints;
  const int nv = model.tree().nv;
  sinesAndCosines(model, q, s);
  worldPoses(joints, q, s);
  motionRates(joints, qd, qdd, {Vec3<double>::zero(), -gravity<double>(model)}, s);
  for (int i = 1; i < model.tree().size(); ++i) {
    s.I[i] = worldInertia(joints[i], s.R[i], s.p[i]);
    s.B[i] = CoriolisInertia<double>::of(s.I[i], s.v[i]);
    s.f[i] = s.I[i] * s.a[i] + crossForce(s.v[i], s.I[i] * s.v[i]);
  }
  for (int k = 0; k < nv; ++k) {
    std::fill_n(out.dq + k * out.stride, nv, 0.0);
    std::fill_n(out.dv + k * out.stride, nv, 0.0);
  }

  s.I[0] = RigidInertia<double>{};
  s.B[0] = CoriolisInertia<double>{};
  s.f[0] = SpatialForce<double>::zero();
  for (int i = model.tree().size() - 1; i > 0; --i) {
    const PackedJoint& joint = joints[i];
    const int end = joint.idx_v + joint.nv;
    for (int k = joint.idx_v; k < end; ++k) {
      const SpatialMotion<double>& S = s.S[k];
      // row k: derivatives of the effort of dof k in its ancestor dofs and those of its own joint
      const SpatialForce<double> inertia = s.I[i] * S, coriolis = s.B[i].transposeTimes(S) * 2.0;
      const auto row = [&](int l) {
        out.dq[l * out.stride + k] = dot(s.Psidd[l], inertia) + dot(s.Psid[l], coriolis);
        out.dv[l * out.stride + k] = dot(s.Sd[l] + s.Psid[l], inertia) + dot(s.S[l], coriolis);
      };
      for (int l = joint.idx_v; l < end; ++l) row(l);
      // column k: derivatives of the efforts of its ancestors in dof k
      const SpatialForce<double> by_q =
          s.I[i] * s.Psidd[k] + s.B[i] * s.Psid[k] * 2.0 + crossForce(S, s.f[i]);
      const SpatialForce<double> by_v = s.I[i] * (s.Sd[k] + s.Psid[k]) + s.B[i] * S * 2.0;
      for (int l = dof_parent[joint.idx_v]; l >= 0; l = dof_parent[l]) {
        row(l);
        out.dq[k * out.stride + l] = dot(s.S[l], by_q);
        out.dv[k * out.stride + l] = dot(s.S[l], by_v);
      }
    }
    s.I[joint.parent] = s.I[joint.parent] + s.I[i];
    s.B[joint.parent] = s.B[joint.parent] + s.B[i];
    s.f[joint.parent] = s.f[joint.parent] + s.f[i];
  }
}

void addFrictionSlopes(const Model& model, const ConstVectorRef& v, PaddedMatrix& dtau_dv) {
  for (int k = 0; k < model.nv; ++k) dtau_dv(k, k) += frictionSlope(model, k, v[k]);
}

// -Minv dtau, where column l of dtau is nonzero only in the rows of ancestors and descendants of dof l.
void minusMinvTimes(const Model& model, Workspace& work, const PaddedMatrix& Minv, const PaddedMatrix& dtau,
                    PaddedMatrix& out) {
  if (!model.tree().mimic.identity) {
    for (int l = 0; l < model.nv; ++l) {
      out.col(l).setZero();
      for (int k = 0; k < model.nv; ++k) out.col(l) -= dtau(k, l) * Minv.col(k);
    }
    return;
  }
  const int stride = work.stride;
  for (int at = 0; at < model.nv; ++at) {
    const int l = work.order[at];
    int count = 0;
    for (int below = at; below < work.subtreeEnd[at]; ++below) work.related[count++] = work.order[below];
    for (int above = work.dofParent[l]; above >= 0; above = work.dofParent[above])
      work.related[count++] = above;
    // eight rows at a time; strides are multiples of 8
    const double* const x = dtau.data() + l * stride;
    for (int row = 0; row < stride; row += 8) {
      Lanes4 sum{}, next{};
      for (int n = 0; n < count; ++n) {
        const int k = work.related[n];
        sum -= x[k] * loadLanes(Minv.data() + k * stride + row);
        next -= x[k] * loadLanes(Minv.data() + k * stride + row + 4);
      }
      storeLanes(out.data() + l * stride + row, sum);
      storeLanes(out.data() + l * stride + row + 4, next);
    }
  }
}

}  // namespace
}  // namespace inner

void computeRNEADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a) {
  inner::checkInputs("computeRNEADerivatives", model, data, q, "v", v, "a", a);
  inner::Workspace& work = data.work();
  const inner::Derivatives out = {inner::kernelOutput(model, work.M, data.dtau_dq),
                                  inner::kernelOutput(model, work.M2, data.dtau_dv), work.stride};
  inner::rneaDerivativesKernel(model, work.dofParent.data(), work.scratch, inner::expandQ(model, work, q),
                               inner::expandV(model, work.v, v), inner::expandV(model, work.a, a), out);
  inner::collapseBothSides(model, work.M, data.dtau_dq);
  inner::collapseBothSides(model, work.M2, data.dtau_dv);
  inner::addFrictionSlopes(model, v, data.dtau_dv);
}

void computeRNEADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a, const FrameWrenches& wrenches) {
  computeRNEADerivatives(model, data, q, v, a);
  inner::addWrenchDerivatives("computeRNEADerivatives", model, data, q, wrenches, -1, data.dtau_dq);
}

void computeRNEADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a, MatrixRef dtau_dq, MatrixRef dtau_dv) {
  inner::checkOut("computeRNEADerivatives", "dtau_dq", dtau_dq, model.nv, model.nv);
  inner::checkOut("computeRNEADerivatives", "dtau_dv", dtau_dv, model.nv, model.nv);
  computeRNEADerivatives(model, data, q, v, a);
  dtau_dq = data.dtau_dq;
  dtau_dv = data.dtau_dv;
}

void computeABADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau) {
  aba(model, data, q, v, tau);
  computeMinverse(model, data, q);
  computeRNEADerivatives(model, data, q, v, data.ddq);
  inner::minusMinvTimes(model, data.work(), data.Minv, data.dtau_dq, data.ddq_dq);
  inner::minusMinvTimes(model, data.work(), data.Minv, data.dtau_dv, data.ddq_dv);
}

void computeABADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau, const FrameWrenches& wrenches) {
  aba(model, data, q, v, tau, wrenches);
  computeMinverse(model, data, q);
  computeRNEADerivatives(model, data, q, v, data.ddq, wrenches);
  inner::minusMinvTimes(model, data.work(), data.Minv, data.dtau_dq, data.ddq_dq);
  inner::minusMinvTimes(model, data.work(), data.Minv, data.dtau_dv, data.ddq_dv);
}

void computeABADerivatives(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau, MatrixRef ddq_dq, MatrixRef ddq_dv,
                           MatrixRef ddq_dtau) {
  inner::checkOut("computeABADerivatives", "ddq_dq", ddq_dq, model.nv, model.nv);
  inner::checkOut("computeABADerivatives", "ddq_dv", ddq_dv, model.nv, model.nv);
  inner::checkOut("computeABADerivatives", "ddq_dtau", ddq_dtau, model.nv, model.nv);
  computeABADerivatives(model, data, q, v, tau);
  ddq_dq = data.ddq_dq;
  ddq_dv = data.ddq_dv;
  ddq_dtau = data.Minv;
}

const PaddedMatrix& computeStaticTorqueDerivatives(const Model& model, Data& data, const ConstVectorRef& q,
                                                   const FrameWrenches& wrenches) {
  data.work().effort.setZero();
  computeRNEADerivatives(model, data, q, data.work().effort, data.work().effort, wrenches);
  return data.dtau_dq;
}

const PaddedMatrix& computeGeneralizedGravityDerivatives(const Model& model, Data& data,
                                                         const ConstVectorRef& q) {
  data.work().effort.setZero();
  computeRNEADerivatives(model, data, q, data.work().effort, data.work().effort);
  return data.dtau_dq;
}

}  // namespace rbd
