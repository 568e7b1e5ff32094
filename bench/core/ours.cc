// Our side of `lab bench core`: the public calls as a user makes them, results in data, every check of sizes
// included. A new algorithm is one row.
#include <rbd/rbd.h>

#include "harness.h"

namespace {

rbd::Model build(const bench::Robot& robot) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  using Vector = Eigen::Map<const Eigen::Vector3d>;
  rbd::Model model;
  for (const bench::Joint& j : robot.joints) {
    const rbd::SE3 place(Eigen::Map<const RowMajor>(j.rotation), Vector(j.translation));
    const Eigen::Vector3d axis = Vector(j.axis);
    const rbd::JointModel joint = j.kind == "freeflyer" ? rbd::JointModel(rbd::JointModelFreeFlyer())
                                  : j.kind == "revolute"
                                      ? rbd::JointModel(rbd::JointModelRevoluteUnaligned(axis))
                                      : rbd::JointModel(rbd::JointModelPrismaticUnaligned(axis));
    const int index = model.addJoint(j.parent, joint, place, j.name);
    const double* I = j.inertia;
    const Eigen::Matrix3d moments{{I[0], I[3], I[4]}, {I[3], I[1], I[5]}, {I[4], I[5], I[2]}};
    model.appendBodyToJoint(index, rbd::Inertia(j.mass, Vector(j.com), moments));
  }
  return model;
}

struct States {
  std::vector<Eigen::VectorXd> q, v, a, tau;
};

States states(const bench::Robot& robot) {
  States all;
  const auto vector = [](const std::vector<double>& x) -> Eigen::VectorXd {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  };
  for (const bench::State& s : robot.states) {
    all.q.push_back(vector(s.q));
    all.v.push_back(vector(s.v));
    all.a.push_back(vector(s.a));
    all.tau.push_back(vector(s.tau));
  }
  return all;
}

void check(const bench::Bench& bench, const bench::Robot& robot, const rbd::Model& m, rbd::Data& d,
           const States& x) {
  bench::Check check;
  const int base = robot.base();
  for (std::size_t i = 0; i < robot.states.size(); ++i) {
    const auto &q = x.q[i], &v = x.v[i], &a = x.a[i];
    const Eigen::VectorXd tau = rbd::rnea(m, d, q, v, a);
    rbd::crba(m, d, q);
    rbd::computeMinverse(m, d, q);
    rbd::computeGeneralizedGravity(m, d, q);
    rbd::jacobianCenterOfMass(m, d, q);
    rbd::computeCentroidalMomentumTimeVariation(m, d, q, v, a);
    rbd::aba(m, d, q, v, tau);
    check.add("trM", bench::sum(base, m.nv, [&](int k) { return d.M(k, k); }));
    check.add("trMinv", bench::sum(base, m.nv, [&](int k) { return d.Minv(k, k); }));
    check.add("|g|", bench::norm(base, m.nv, [&](int k) { return d.g[k]; }));
    check.add("|tau|", bench::norm(base, m.nv, [&](int k) { return tau[k]; }));
    for (int k = 0; k < 3; ++k) check.add(std::string("com_") + "xyz"[k], d.com[0][k]);
    check.add("|Jcom|", d.Jcom.rightCols(m.nv - base).norm());
    check.add("|hg|", d.hg.toVector().norm());
    check.add("|dhg|", d.dhg.toVector().norm());
    check.add("kinetic", rbd::computeKineticEnergy(m, d, q, v));
    check.add("potential", rbd::computePotentialEnergy(m, d, q));
    const int moving = m.nv - base;
    const auto both = [&](const auto& x, const auto& y) {
      return x.bottomRightCorner(moving, moving).norm() + y.bottomRightCorner(moving, moving).norm();
    };
    const Eigen::VectorXd ddq = d.ddq;
    rbd::computeRNEADerivatives(m, d, q, v, a);
    check.add("|dtau|", both(d.dtau_dq, d.dtau_dv));
    rbd::computeABADerivatives(m, d, q, v, tau);
    check.add("|dddq|", both(d.ddq_dq, d.ddq_dv));
    check.add("|Ag|", rbd::computeCentroidalMap(m, d, q).rightCols(moving).norm());
    d.ddq = ddq;
    check.add("aba(rnea(a))-a", (d.ddq - a).norm() / a.norm());
  }
  check.print(bench.peer(), robot);
}

void measure(const bench::Bench& bench, const bench::Robot& robot) {
  const rbd::Model m = build(robot);
  rbd::Data d(m);
  const States x = states(robot);
  const auto &q = x.q, &v = x.v, &a = x.a, &tau = x.tau;
  check(bench, robot, m, d, x);

  Eigen::VectorXd next(m.nq), solution(m.nv);
  bench::Bench::watch(&d);
  bench::Bench::watch(next.data());
  bench::Bench::watch(solution.data());
  const auto row = [&](const char* algorithm, auto&& f) { bench.row(robot, algorithm, f); };
  row("fk", [&](std::size_t i) { rbd::forwardKinematics(m, d, q[i]); });
  row("fk_va", [&](std::size_t i) { rbd::forwardKinematics(m, d, q[i], v[i], a[i]); });
  row("jacobians", [&](std::size_t i) { rbd::computeJointJacobians(m, d, q[i]); });
  row("rnea", [&](std::size_t i) { rbd::rnea(m, d, q[i], v[i], a[i]); });
  row("nle", [&](std::size_t i) { rbd::nonLinearEffects(m, d, q[i], v[i]); });
  row("gravity", [&](std::size_t i) { rbd::computeGeneralizedGravity(m, d, q[i]); });
  row("crba", [&](std::size_t i) { rbd::crba(m, d, q[i]); });
  row("aba", [&](std::size_t i) { rbd::aba(m, d, q[i], v[i], tau[i]); });
  row("minv", [&](std::size_t i) { rbd::computeMinverse(m, d, q[i]); });
  row("crba_chol_solve", [&](std::size_t i) {
    rbd::crba(m, d, q[i]);
    rbd::cholesky::decompose(m, d);
    solution = tau[i];
    rbd::cholesky::solve(m, d, solution);
  });
  row("com", [&](std::size_t i) { rbd::centerOfMass(m, d, q[i]); });
  row("jcom", [&](std::size_t i) { rbd::jacobianCenterOfMass(m, d, q[i]); });
  row("hg", [&](std::size_t i) { rbd::computeCentroidalMomentum(m, d, q[i], v[i]); });
  row("dhg", [&](std::size_t i) { rbd::computeCentroidalMomentumTimeVariation(m, d, q[i], v[i], a[i]); });
  row("coriolis", [&](std::size_t i) { rbd::computeCoriolisMatrix(m, d, q[i], v[i]); });
  row("ccrba", [&](std::size_t i) { rbd::ccrba(m, d, q[i], v[i]); });
  row("rnea_deriv", [&](std::size_t i) { rbd::computeRNEADerivatives(m, d, q[i], v[i], a[i]); });
  row("aba_deriv", [&](std::size_t i) { rbd::computeABADerivatives(m, d, q[i], v[i], tau[i]); });
  row("kinetic", [&](std::size_t i) { rbd::computeKineticEnergy(m, d, q[i], v[i]); });
  row("potential", [&](std::size_t i) { rbd::computePotentialEnergy(m, d, q[i]); });
  row("integrate", [&](std::size_t i) { rbd::integrate(m, q[i], v[i], next); });
}

}  // namespace

int main(int argc, char** argv) { return bench::run("lcmlab", argc, argv, measure); }
