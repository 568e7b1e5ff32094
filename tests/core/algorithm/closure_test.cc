// Every law that ties two algorithms together, on 50 random trees of every joint type, mimic joints among
// them, of up to 60 joints; and one table: the largest error of each as a share of its tolerance.
//
// Tolerance of laws without differences: 1e3 eps cond scale. 1e3 covers the sums along trees 60 deep, cond is
// the condition number of M where M is solved with (else 1), scale the largest entry compared (at least 1).
// Laws against central differences with step h = 1e-5 add h^2 times third derivatives and eps / h times the
// values: 1e-7 cond scale.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::kEps;
using testing::times;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kStep = 1e-5;

struct Table {
  struct Row {
    double worst = 0;
    unsigned seed = 0;
  };
  std::map<std::string, Row> rows;
  unsigned seed = 0;

  void law(const std::string& name, const Matrix& a, const Matrix& b, double unit, double cond,
           double scale = 1) {
    const double size = std::max({scale, b.size() ? b.cwiseAbs().maxCoeff() : 0, 1.0});
    const double error = a.size() ? (a - b).cwiseAbs().maxCoeff() : 0;
    const double share = error / (unit * cond * size);
    Row& row = rows[name];
    if (!(share <= row.worst)) row = {share, seed};
  }
  void exact(const std::string& name, const Matrix& a, const Matrix& b, double cond = 1, double scale = 1) {
    law(name, a, b, 1e3 * kEps, cond, scale);
  }
  void slope(const std::string& name, const Matrix& a, const Matrix& b, double cond = 1, double scale = 1) {
    law(name + " (difference)", a, b, 1e-7, cond, scale);
  }
};

template <class F>
Matrix slopes(int nv, F&& f) {
  Matrix out;
  for (int k = 0; k < nv; ++k) {
    const Vector x = kStep * Vector::Unit(nv, k), column = (f(x) - f(Vector(-x))) / (2 * kStep);
    if (k == 0) out.resize(column.size(), nv);
    out.col(k) = column;
  }
  return out;
}

void check(const Model& model, unsigned seed, Table& table) {
  testing::State s = testing::randomState(model, seed);
  s.v *= 0.3;  // 60 joints behind each other add up
  Data d(model), other(model);
  const int nv = model.nv;
  const Vector zero = Vector::Zero(nv);
  const Matrix M = crba(model, d, s.q), Minv = computeMinverse(model, d, s.q);
  const double cond = testing::condition(M, Minv);
  const Vector tau = rnea(model, d, s.q, s.v, s.a), nle = nonLinearEffects(model, d, s.q, s.v);
  const Vector g = computeGeneralizedGravity(model, d, s.q);
  const double effort = std::max(tau.cwiseAbs().maxCoeff(), nle.cwiseAbs().maxCoeff());

  table.exact("rnea = M a + nle", times(M, s.a) + nle, tau, 1, effort);
  table.exact("aba undoes rnea", aba(model, d, s.q, s.v, tau), s.a, cond);
  table.exact("Minv M = 1", times(Minv, M), Matrix::Identity(nv, nv), cond);
  Matrix columns(nv, nv);
  const Vector rest = rnea(model, d, s.q, zero, zero);
  for (int k = 0; k < nv; ++k) columns.col(k) = rnea(model, d, s.q, zero, Vector::Unit(nv, k)) - rest;
  table.exact("columns of M by rnea", columns, M, 1, rest.cwiseAbs().maxCoeff());
  Vector x = tau;
  crba(model, d, s.q);
  cholesky::decompose(model, d);
  cholesky::solve(model, d, x);
  table.exact("U D U' solves M", times(M, x), tau, cond);
  table.exact("C v = nle - g", times(computeCoriolisMatrix(model, d, s.q, s.v), s.v), nle - g, 1, effort);

  // wrenches: virtual work of three pushes, and the momentum that they leave
  testing::Random random(seed);
  FrameWrenches wrenches;
  Vector work = Vector::Zero(nv);
  computeJointJacobians(model, d, s.q);
  for (const ReferenceFrame reference : {WORLD, LOCAL, LOCAL_WORLD_ALIGNED}) {
    wrenches.push_back({random.below(model.nframes), random.force(), reference});
    work += times(getFrameJacobian(model, d, wrenches.back().frame, reference).transpose(),
                  wrenches.back().wrench.toVector());
  }
  table.exact("rnea with wrenches", rnea(model, d, s.q, s.v, s.a, wrenches), tau - work, 1, effort);
  table.exact("aba with wrenches", aba(model, d, s.q, s.v, tau, wrenches),
              aba(model, other, s.q, s.v, tau + work), cond);

  // momentum
  const Matrix dAg = computeCentroidalMapTimeVariation(model, d, s.q, s.v), Ag = d.Ag;
  const Force dhg = computeCentroidalMomentumTimeVariation(model, d, s.q, s.v, s.a);
  table.exact("hg = Ag v", times(Ag, s.v), d.hg.toVector());
  table.exact("dhg = Ag a + dAg v", times(Ag, s.a) + times(dAg, s.v), dhg.toVector());
  if (model.joints[1].kind() == JointKind::FreeFlyer && model.parents[model.njoints - 1] > 0) {
    // a robot in free flight: only gravity, and the base's own effort, change its momentum
    const SE3 base = [&] {
      forwardKinematics(model, d, s.q);
      return d.oMi[1];
    }();
    centerOfMass(model, d, s.q);
    Force outside =
        base.act(Force(Vector6d(tau.head<6>() - model.armature.head<6>().cwiseProduct(s.a.head<6>()))));
    outside.angular() -= d.com[0].cross(outside.linear());
    outside.linear() += d.mass[0] * model.gravity.linear();
    bool whole = true;  // nothing else stands on the ground
    for (JointIndex j = 2; j < model.njoints; ++j) whole = whole && model.parents[j] > 0;
    if (whole) table.exact("dhg = wrenches from outside", outside.toVector(), dhg.toVector(), 1, effort);
  }

  // frames: J v and dJ v + J a against velocities and accelerations
  forwardKinematics(model, d, s.q, s.v, s.a);
  computeJointJacobiansTimeVariation(model, other, s.q, s.v);
  for (FrameIndex f = 0; f < model.nframes; f += 1 + model.nframes / 8) {
    const Matrix J = getFrameJacobian(model, other, f, LOCAL_WORLD_ALIGNED);
    const Matrix dJ = getFrameJacobianTimeVariation(model, other, f, LOCAL_WORLD_ALIGNED);
    const Vector a = getFrameClassicalAcceleration(model, d, f, LOCAL_WORLD_ALIGNED).toVector();
    table.exact("J v = frame velocity", times(J, s.v),
                getFrameVelocity(model, d, f, LOCAL_WORLD_ALIGNED).toVector());
    table.exact("dJ v + J a = acceleration", times(dJ, s.v) + times(J, s.a), a, 1, s.v.squaredNorm());
    const auto moved = [&](double t) {
      computeJointJacobians(model, d, integrate(model, s.q, t * s.v));
      return Matrix(getFrameJacobian(model, d, f, LOCAL_WORLD_ALIGNED));
    };
    table.slope("dJ", dJ, (moved(kStep) - moved(-kStep)) / (2 * kStep), 1, 10);
    forwardKinematics(model, d, s.q, s.v, s.a);
  }

  // energy: its rate along the motion that aba predicts is the power of the efforts
  const Vector a = aba(model, d, s.q, s.v, tau);
  const auto energy = [&](double t) {
    return computeMechanicalEnergy(model, d, integrate(model, s.q, t * s.v + 0.5 * t * t * a), s.v + t * a);
  };
  const Matrix power = Matrix::Constant(1, 1, tau.dot(s.v));
  table.slope("energy rate = power", Matrix::Constant(1, 1, (energy(kStep) - energy(-kStep)) / (2 * kStep)),
              power, 1, std::abs(energy(0)) + effort);

  // derivatives
  computeRNEADerivatives(model, d, s.q, s.v, s.a);
  const auto by_q = [&](const Vector& dx) {
    return Vector(rnea(model, other, integrate(model, s.q, dx), s.v, s.a));
  };
  const auto by_v = [&](const Vector& dx) { return Vector(rnea(model, other, s.q, s.v + dx, s.a)); };
  table.slope("dtau/dq", d.dtau_dq, slopes(nv, by_q), 1, effort);
  table.slope("dtau/dv", d.dtau_dv, slopes(nv, by_v), 1, effort);
  computeABADerivatives(model, d, s.q, s.v, tau);
  const auto a_by_q = [&](const Vector& dx) {
    return Vector(aba(model, other, integrate(model, s.q, dx), s.v, tau));
  };
  const auto a_by_v = [&](const Vector& dx) { return Vector(aba(model, other, s.q, s.v + dx, tau)); };
  table.slope("dddq/dq", d.ddq_dq, slopes(nv, a_by_q), cond, effort);
  table.slope("dddq/dv", d.ddq_dv, slopes(nv, a_by_v), cond, effort);
}

TEST(Closure, Table) {
  Table table;
  for (unsigned seed = 0; seed < 50; ++seed) {
    table.seed = seed;
    const Model model = buildModels::randomTree(seed, {.joints = 1 + static_cast<int>(seed * 59 / 49),
                                                       .floating_base = seed % 2 == 0,
                                                       .depth_first = seed % 5 == 0,
                                                       .mimic = seed % 3 == 1});
    check(model, seed, table);
  }
  std::printf("%-34s %18s  seed\n", "law", "error / tolerance");
  for (const auto& [name, row] : table.rows) {
    std::printf("%-34s %18.2g  %u\n", name.c_str(), row.worst, row.seed);
    EXPECT_LE(row.worst, 1) << name << ", seed " << row.seed;
  }
}

}  // namespace
}  // namespace rbd
