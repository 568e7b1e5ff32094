// Pinocchio's side of `lab bench core`, header only, so that the compiler sees all of it. Where it has two
// ways to the same result (LOCAL and WORLD conventions) both are lines of one name: the better one counts.
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/cholesky.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/multibody/joint.hpp>

#include "../core/harness.h"

namespace {

namespace pin = pinocchio;
using pin::Convention;

// The axis decides how fast a joint is there, so x, y and z get the joints made for them.
template <class X, class Y, class Z, class Any>
pin::JointModel along(const double* axis) {
  if (axis[0] == 1) return X();
  if (axis[1] == 1) return Y();
  if (axis[2] == 1) return Z();
  return Any(axis[0], axis[1], axis[2]);
}

pin::JointModel joint_model(const bench::Joint& j) {
  using namespace pin;
  if (j.kind == "freeflyer") return JointModelFreeFlyer();
  if (j.kind == "revolute") {
    return along<JointModelRX, JointModelRY, JointModelRZ, JointModelRevoluteUnaligned>(j.axis);
  }
  return along<JointModelPX, JointModelPY, JointModelPZ, JointModelPrismaticUnaligned>(j.axis);
}

pin::Model build(const bench::Robot& robot) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  using Vector = Eigen::Map<const Eigen::Vector3d>;
  pin::Model model;
  for (const bench::Joint& j : robot.joints) {
    const pin::SE3 place(Eigen::Matrix3d(Eigen::Map<const RowMajor>(j.rotation)), Vector(j.translation));
    const auto index = model.addJoint(static_cast<pin::JointIndex>(j.parent), joint_model(j), place, j.name);
    const double* I = j.inertia;
    Eigen::Matrix3d moments;
    moments << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
    model.appendBodyToJoint(index, pin::Inertia(j.mass, Vector(j.com), moments), pin::SE3::Identity());
  }
  return model;
}

Eigen::VectorXd vector(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

// A velocity or acceleration: here the base's linear part comes first.
Eigen::VectorXd tangent(const bench::Robot& robot, const std::vector<double>& x) {
  Eigen::VectorXd y = vector(x);
  if (robot.floating()) y.head<3>().swap(y.segment<3>(3));
  return y;
}

struct States {
  explicit States(const bench::Robot& robot) {
    for (const bench::State& s : robot.states) {
      q.push_back(vector(s.q));
      v.push_back(tangent(robot, s.v));
      a.push_back(tangent(robot, s.a));
      tau.push_back(tangent(robot, s.tau));
    }
  }
  std::vector<Eigen::VectorXd> q, v, a, tau;
};

void check(const bench::Bench& bench, const bench::Robot& robot, const pin::Model& m, pin::Data& d,
           const States& x) {
  bench::Check check;
  const int base = robot.base(), nv = robot.nv;
  for (std::size_t i = 0; i < x.q.size(); ++i) {
    const Eigen::VectorXd t = rnea(m, d, x.q[i], x.v[i], x.a[i]);
    crba(m, d, x.q[i], Convention::WORLD);
    computeMinverse(m, d, x.q[i]);
    computeGeneralizedGravity(m, d, x.q[i]);
    jacobianCenterOfMass(m, d, x.q[i]);
    computeCentroidalMomentumTimeVariation(m, d, x.q[i], x.v[i], x.a[i]);
    aba(m, d, x.q[i], x.v[i], t, Convention::WORLD);
    check.add("trM", bench::sum(base, nv, [&](int k) { return d.M(k, k); }));
    check.add("trMinv", bench::sum(base, nv, [&](int k) { return d.Minv(k, k); }));
    check.add("|g|", bench::norm(base, nv, [&](int k) { return d.g[k]; }));
    check.add("|tau|", bench::norm(base, nv, [&](int k) { return t[k]; }));
    for (int k = 0; k < 3; ++k) check.add(std::string("com_") + "xyz"[k], d.com[0][k]);
    check.add("|Jcom|", d.Jcom.rightCols(nv - base).norm());
    check.add("|hg|", d.hg.toVector().norm());
    check.add("|dhg|", d.dhg.toVector().norm());
    check.add("kinetic", computeKineticEnergy(m, d, x.q[i], x.v[i]));
    check.add("potential", computePotentialEnergy(m, d, x.q[i]));
    check.add("aba(rnea(a))-a", (d.ddq - x.a[i]).norm() / x.a[i].norm());
    computeRNEADerivatives(m, d, x.q[i], x.v[i], x.a[i]);
    check.add("|dtau|", d.dtau_dq.bottomRightCorner(nv - base, nv - base).norm() +
                            d.dtau_dv.bottomRightCorner(nv - base, nv - base).norm());
    computeABADerivatives(m, d, x.q[i], x.v[i], t);
    check.add("|dddq|", d.ddq_dq.bottomRightCorner(nv - base, nv - base).norm() +
                            d.ddq_dv.bottomRightCorner(nv - base, nv - base).norm());
    check.add("|Ag|", ccrba(m, d, x.q[i], x.v[i]).rightCols(nv - base).norm());
  }
  check.print(bench.peer(), robot);
}

void measure(const bench::Bench& bench, const bench::Robot& robot) {
  if (robot.nv > 100) {  // its Data holds tensors of 6 nv^3 numbers: 48 GB at 1000 joints
    std::printf("# pinocchio is not asked for %s: more than 100 dofs take too much memory\n",
                robot.name.c_str());
    return;
  }
  const pin::Model m = build(robot);
  pin::Data d(m);
  const States x(robot);
  check(bench, robot, m, d, x);

  Eigen::VectorXd next(m.nq), solution(m.nv);
  bench::Bench::watch(&d);
  bench::Bench::watch(next.data());
  bench::Bench::watch(solution.data());
  const auto row = [&](const char* algorithm, auto&& f) { bench.row(robot, algorithm, f); };
  row("fk", [&](std::size_t i) { forwardKinematics(m, d, x.q[i]); });
  row("fk_va", [&](std::size_t i) { forwardKinematics(m, d, x.q[i], x.v[i], x.a[i]); });
  row("jacobians", [&](std::size_t i) { computeJointJacobians(m, d, x.q[i]); });
  row("rnea", [&](std::size_t i) { rnea(m, d, x.q[i], x.v[i], x.a[i]); });
  row("nle", [&](std::size_t i) { nonLinearEffects(m, d, x.q[i], x.v[i]); });
  row("gravity", [&](std::size_t i) { computeGeneralizedGravity(m, d, x.q[i]); });
  row("crba", [&](std::size_t i) { crba(m, d, x.q[i], Convention::LOCAL); });
  row("crba", [&](std::size_t i) { crba(m, d, x.q[i], Convention::WORLD); });
  row("aba", [&](std::size_t i) { aba(m, d, x.q[i], x.v[i], x.tau[i], Convention::LOCAL); });
  row("aba", [&](std::size_t i) { aba(m, d, x.q[i], x.v[i], x.tau[i], Convention::WORLD); });
  row("minv", [&](std::size_t i) { computeMinverse(m, d, x.q[i]); });
  row("crba_chol_solve", [&](std::size_t i) {
    crba(m, d, x.q[i], Convention::WORLD);
    pin::cholesky::decompose(m, d);
    solution = x.tau[i];
    pin::cholesky::solve(m, d, solution);
  });
  row("coriolis", [&](std::size_t i) { computeCoriolisMatrix(m, d, x.q[i], x.v[i]); });
  row("com", [&](std::size_t i) { centerOfMass(m, d, x.q[i]); });
  row("jcom", [&](std::size_t i) { jacobianCenterOfMass(m, d, x.q[i]); });
  row("ccrba", [&](std::size_t i) { ccrba(m, d, x.q[i], x.v[i]); });
  row("hg", [&](std::size_t i) { computeCentroidalMomentum(m, d, x.q[i], x.v[i]); });
  row("dhg", [&](std::size_t i) { computeCentroidalMomentumTimeVariation(m, d, x.q[i], x.v[i], x.a[i]); });
  row("kinetic", [&](std::size_t i) { computeKineticEnergy(m, d, x.q[i], x.v[i]); });
  row("potential", [&](std::size_t i) { computePotentialEnergy(m, d, x.q[i]); });
  row("rnea_deriv", [&](std::size_t i) { computeRNEADerivatives(m, d, x.q[i], x.v[i], x.a[i]); });
  row("aba_deriv", [&](std::size_t i) { computeABADerivatives(m, d, x.q[i], x.v[i], x.tau[i]); });
  row("integrate", [&](std::size_t i) { integrate(m, x.q[i], x.v[i], next); });
}

}  // namespace

int main(int argc, char** argv) { return bench::run("pinocchio", argc, argv, measure); }
