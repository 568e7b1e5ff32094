#include "rbd/algorithm/center_of_mass.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/whole_body.h"
#include "rbd/kernel/motion_rates.h"

namespace rbd {
namespace {

using inner::Joints;
using inner::Scratch;
using Vec = inner::Vec3<double>;

// I[i].m and I[i].h: mass and first moment (about the centre) of the subtree of body i, itself
// included.
void carriedMasses(const Model& model, Scratch<double>& s) {
  const Joints& joints = model.tree().joints;
  for (int i = 0; i < model.tree().size(); ++i) {
    s.I[i].m = joints[i].mass;
    s.I[i].h = bodyCom(joints, i, s) * joints[i].mass;
  }
  for (int i = model.tree().size() - 1; i > 0; --i) {
    s.I[joints[i].parent].m += s.I[i].m;
    s.I[joints[i].parent].h = s.I[joints[i].parent].h + s.I[i].h;
  }
}

// Rate of the first moment of the subtree of dof k when that moves at rate 1.
Vec momentRate(const Scratch<double>& s, int body, int k) {
  return s.S[k].v * s.I[body].m + cross(s.S[k].w, s.I[body].h);
}

// Velocity and acceleration of the point c of body i, from the centre.
struct PointMotion {
  Vec v, a;
};
PointMotion pointMotion(const Scratch<double>& s, int i, const Vec& c) {
  const Vec v = s.v[i].v + cross(s.v[i].w, c);
  return {v, s.a[i].v + cross(s.a[i].w, c) + cross(s.v[i].w, v)};
}

}  // namespace

const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("centerOfMass", model, data, q);
  inner::worldPosesOf(model, data, q);
  inner::storeCom("centerOfMass", model, data);
  return data.com[0];
}

const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q,
                                    const ConstVectorRef& v) {
  inner::checkInputs("centerOfMass", model, data, q, "v", v);
  inner::worldPosesOf(model, data, q);
  inner::storeCom("centerOfMass", model, data);
  data.vcom[0] = inner::toEigen(inner::momentum(model, data, v, nullptr).h.f) / data.mass[0];
  return data.com[0];
}

void centerOfMass(const Model& model, Data& data, const ConstVectorRef& q, Eigen::Vector3d& com) {
  com = centerOfMass(model, data, q);
}

const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q,
                                    const ConstVectorRef& v, const ConstVectorRef& a) {
  inner::checkInputs("centerOfMass", model, data, q, "v", v, "a", a);
  inner::worldPosesOf(model, data, q);
  inner::storeCom("centerOfMass", model, data);
  const inner::Momentum sum = inner::momentum(model, data, v, &a);
  data.vcom[0] = inner::toEigen(sum.h.f) / data.mass[0];
  data.acom[0] = inner::toEigen(sum.dh.f) / data.mass[0];
  return data.com[0];
}

void computeSubtreeCentersOfMass(const Model& model, Data& data, const ConstVectorRef& q,
                                 const ConstVectorRef& v, const ConstVectorRef& a) {
  centerOfMass(model, data, q, v, a);
  inner::Workspace& work = data.work();
  Scratch<double>& s = work.scratch;
  const Joints& joints = model.tree().joints;
  inner::motionRates(joints, inner::expandV(model, work.v, v), inner::expandV(model, work.a, a),
                     inner::SpatialMotion<double>::zero(), s);
  carriedMasses(model, s);
  // f[i]: rates of the first moment of the subtree of body i (f: first, n: second)
  for (int i = 1; i < model.tree().size(); ++i) {
    const PointMotion moves = pointMotion(s, i, bodyCom(joints, i, s));
    s.f[i] = {moves.a * joints[i].mass, moves.v * joints[i].mass};
  }
  for (int i = model.tree().size() - 1; i > 0; --i) s.f[joints[i].parent] = s.f[joints[i].parent] + s.f[i];
  for (JointIndex j = 1; j < model.njoints; ++j) {
    const int i = model.tree().bodyOf[j];
    const double mass = s.I[i].m;
    const PointMotion origin = pointMotion(s, i, s.p[i]);
    data.mass[j] = mass;
    data.com[j] = inner::toEigen(s.centre + (mass > 0 ? s.I[i].h * (1 / mass) : s.p[i]));
    data.vcom[j] = inner::toEigen(mass > 0 ? s.f[i].f * (1 / mass) : origin.v);
    data.acom[j] = inner::toEigen(mass > 0 ? s.f[i].n * (1 / mass) : origin.a);
  }
}

double computeTotalMass(const Model& model) {
  double mass = 0;
  for (JointIndex j = 1; j < model.njoints; ++j) mass += model.inertias[j].mass();
  return mass;
}

void computeSubtreeMasses(const Model& model, Data& data) {
  inner::checkData("computeSubtreeMasses", model, data);
  data.mass[0] = 0;
  for (JointIndex j = 1; j < model.njoints; ++j) data.mass[j] = model.inertias[j].mass();
  for (JointIndex j = model.njoints - 1; j > 0; --j) data.mass[model.parents[j]] += data.mass[j];
}

const PaddedMatrix& jacobianCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("jacobianCenterOfMass", model, data, q);
  inner::worldPosesOf(model, data, q);
  inner::storeCom("jacobianCenterOfMass", model, data);
  Scratch<double>& s = data.work().scratch;
  const Joints& joints = model.tree().joints;
  double* const out = inner::kernelOutput(model, data.work().Jcom, data.Jcom);
  carriedMasses(model, s);
  for (int i = 1; i < model.tree().size(); ++i) {
    worldSubspace(joints[i], i, s);
    for (int k = joints[i].idx_v; k < joints[i].idx_v + joints[i].nv; ++k) {
      (momentRate(s, i, k) * (1 / data.mass[0])).storeU(out + 8 * k);
    }
  }
  inner::collapseColumns(model, data.work().Jcom, data.Jcom);
  return data.Jcom;
}

void jacobianCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef J) {
  inner::checkOut("jacobianCenterOfMass", "J", J, 3, model.nv);
  J = jacobianCenterOfMass(model, data, q);
}

void jacobianSubtreeCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q, JointIndex joint,
                                 MatrixRef J) {
  inner::checkInputs("jacobianSubtreeCenterOfMass", model, data, q);
  inner::checkJoint("jacobianSubtreeCenterOfMass", model, joint);
  inner::checkOut("jacobianSubtreeCenterOfMass", "J", J, 3, model.nv);
  if (joint == 0) {
    J = jacobianCenterOfMass(model, data, q);
    return;
  }
  inner::worldPosesOf(model, data, q);
  Scratch<double>& s = data.work().scratch;
  const KernelTree& tree = model.tree();
  carriedMasses(model, s);
  inner::worldSubspaces(tree.joints, s);
  J.setZero();
  const int top = tree.bodyOf[joint];
  if (!(s.I[top].m > 0)) return;
  const auto add = [&](int k, const Vec& x) {
    J.col(tree.mimic.v_source[k]) += tree.mimic.v_ratio[k] * inner::toEigen(x * (1 / s.I[top].m));
  };
  // dofs that carry the whole subtree move all of it, dofs inside it what they carry themselves
  std::vector<bool>& inside = data.work().inside;
  for (int i = 1; i < tree.size(); ++i) {
    inside[i] = i == top || inside[tree.joints[i].parent];
    if (!inside[i] || i == top) continue;
    for (int k = tree.joints[i].idx_v; k < tree.joints[i].idx_v + tree.joints[i].nv; ++k)
      add(k, momentRate(s, i, k));
  }
  for (int i = top; i > 0; i = tree.joints[i].parent) {
    for (int k = tree.joints[i].idx_v; k < tree.joints[i].idx_v + tree.joints[i].nv; ++k)
      add(k, momentRate(s, top, k));
  }
}

}  // namespace rbd
