#include "rbd/algorithm/centroidal.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/whole_body.h"
#include "rbd/kernel/motion_rates.h"

namespace rbd {
namespace {

using inner::Joints;
using inner::Scratch;
using Vec = inner::Vec3<double>;
using Wrench = inner::SpatialForce<double>;

// The same wrench about the point c.
Force about(const Vec& c, const Wrench& x) {
  return {inner::toEigen(x.n - cross(c, x.f)), inner::toEigen(x.f)};
}

void requireVelocity(const char* function, const Model& model, const Data& data) {
  inner::checkData(function, model, data);
  if (data.kinematics_order < 1) inner::failOrder(function, "forwardKinematics(model, data, q, v)");
}

void storeColumn(const Wrench& x, double* out) {
  x.n.storeU(out);
  x.f.storeU(out + 3);
}

// dI/dt = v x* I - I v x, of a body that moves with v: an inertia without mass.
inner::RigidInertia<double> inertiaRate(const inner::RigidInertia<double>& I,
                                        const inner::SpatialMotion<double>& v) {
  const double hu = dot(I.h, v.v);
  const auto column = [&](const Vec& Ik, int k, const Vec& e) {
    return cross(v.w, Ik) - I.I * cross(v.w, e) - I.h * v.v[k] - v.v * I.h[k] + e * (2 * hu);
  };
  return {{column(I.I.c0, 0, Vec::make(1, 0, 0)), column(I.I.c1, 1, Vec::make(0, 1, 0)),
           column(I.I.c2, 2, Vec::make(0, 0, 1))},
          v.v * I.m + cross(v.w, I.h),
          0};
}

}  // namespace

const Force& computeCentroidalMomentum(const Model& model, Data& data, const ConstVectorRef& q,
                                       const ConstVectorRef& v) {
  inner::checkInputs("computeCentroidalMomentum", model, data, q, "v", v);
  inner::worldPosesOf(model, data, q);
  const Vec com = inner::storeCom("computeCentroidalMomentum", model, data);
  return data.hg = about(com, inner::momentum(model, data, v, nullptr).h);
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
  inner::worldPosesOf(model, data, q);
  const Vec com = inner::storeCom(name, model, data);
  const inner::Momentum sum = inner::momentum(model, data, v, &a);
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

// Composite inertias as in crba: column k of Ag is the momentum of the subtree of dof k when that moves at
// rate 1.
const PaddedMatrix& computeCentroidalMap(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("computeCentroidalMap", model, data, q);
  inner::worldPosesOf(model, data, q);
  const Vec com = inner::storeCom("computeCentroidalMap", model, data);
  Scratch<double>& s = data.work().scratch;
  const Joints& joints = model.tree().joints;
  double* const Ag = inner::kernelOutput(model, data.work().Ag, data.Ag);
  worldSubspaces(joints, s);
  worldInertias(joints, s);
  s.I[0] = inner::RigidInertia<double>{};
  for (int i = model.tree().size() - 1; i > 0; --i) {
    for (int k = joints[i].idx_v; k < joints[i].idx_v + joints[i].nv; ++k) {
      const Wrench h = s.I[i] * s.S[k];
      storeColumn({h.n - cross(com, h.f), h.f}, Ag + 8 * k);
    }
    s.I[joints[i].parent] = s.I[joints[i].parent] + s.I[i];
  }
  inner::collapseColumns(model, data.work().Ag, data.Ag);
  return data.Ag;
}

void computeCentroidalMap(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef Ag) {
  inner::checkOut("computeCentroidalMap", "Ag", Ag, 6, model.nv);
  Ag = computeCentroidalMap(model, data, q);
}

const PaddedMatrix& ccrba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v) {
  inner::checkInputs("ccrba", model, data, q, "v", v);
  computeCentroidalMap(model, data, q);
  Vector6d h = Vector6d::Zero();
  for (int k = 0; k < model.nv; ++k) h += v[k] * data.Ag.col(k);
  data.hg = Force(h);
  return data.Ag;
}

const PaddedMatrix& computeCentroidalMapTimeVariation(const Model& model, Data& data, const ConstVectorRef& q,
                                                      const ConstVectorRef& v) {
  ccrba(model, data, q, v);
  inner::Workspace& work = data.work();
  Scratch<double>& s = work.scratch;
  const Joints& joints = model.tree().joints;
  const Vec com = inner::fromEigen(data.com[0]) - s.centre,
            vcom = inner::fromEigen(data.hg.linear() / data.mass[0]);
  data.vcom[0] = inner::toEigen(vcom);
  double* const dAg = inner::kernelOutput(model, work.Ag, data.dAg);
  inner::motionRates(joints, inner::expandV(model, work.v, v), nullptr, inner::SpatialMotion<double>::zero(),
                     s);
  worldInertias(joints, s);
  for (int i = 1; i < model.tree().size(); ++i) s.dI[i] = inertiaRate(s.I[i], s.v[i]);
  s.I[0] = s.dI[0] = inner::RigidInertia<double>{};
  for (int i = model.tree().size() - 1; i > 0; --i) {
    for (int k = joints[i].idx_v; k < joints[i].idx_v + joints[i].nv; ++k) {
      const Wrench h = s.I[i] * s.S[k], dh = s.dI[i] * s.S[k] + s.I[i] * s.Sd[k];
      storeColumn({dh.n - cross(vcom, h.f) - cross(com, dh.f), dh.f}, dAg + 8 * k);
    }
    s.I[joints[i].parent] = s.I[joints[i].parent] + s.I[i];
    s.dI[joints[i].parent] = s.dI[joints[i].parent] + s.dI[i];
  }
  inner::collapseColumns(model, work.Ag, data.dAg);
  return data.dAg;
}

const PaddedMatrix& dccrba(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v) {
  return computeCentroidalMapTimeVariation(model, data, q, v);
}

}  // namespace rbd
