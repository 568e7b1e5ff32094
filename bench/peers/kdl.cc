// Orocos KDL's side of `lab bench core`: serial chains on a fixed base, which is what its dynamics solvers
// know.
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "../core/harness.h"

namespace {

bool is_chain(const bench::Robot& robot) {
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    if (robot.joints[i].parent != static_cast<int>(i)) return false;
  }
  return !robot.floating();
}

KDL::Chain build(const bench::Robot& robot) {
  KDL::Chain chain;
  for (const bench::Joint& j : robot.joints) {
    const double *R = j.rotation, *I = j.inertia;
    const KDL::Frame place(KDL::Rotation(R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]),
                           KDL::Vector(j.translation[0], j.translation[1], j.translation[2]));
    const KDL::Joint joint(j.name, place.p, place.M * KDL::Vector(j.axis[0], j.axis[1], j.axis[2]),
                           j.kind == "revolute" ? KDL::Joint::RotAxis : KDL::Joint::TransAxis);
    const KDL::RigidBodyInertia body(j.mass, KDL::Vector(j.com[0], j.com[1], j.com[2]),
                                     KDL::RotationalInertia(I[0], I[1], I[2], I[3], I[4], I[5]));
    chain.addSegment(KDL::Segment(j.name, joint, place, body));
  }
  return chain;
}

KDL::JntArray array(const std::vector<double>& x) {
  KDL::JntArray y(static_cast<unsigned>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) y(static_cast<unsigned>(i)) = x[i];
  return y;
}

void measure(const bench::Bench& bench, const bench::Robot& robot) {
  if (!is_chain(robot)) {
    std::printf("# kdl cannot do %s: no serial chain on a fixed base\n", robot.name.c_str());
    return;
  }
  const KDL::Chain chain = build(robot);
  const unsigned n = static_cast<unsigned>(robot.nv);
  std::vector<KDL::JntArray> q, v, a, tau;
  for (const bench::State& s : robot.states) {
    q.push_back(array(s.q));
    v.push_back(array(s.v));
    a.push_back(array(s.a));
    tau.push_back(array(s.tau));
  }

  const KDL::Vector down(0, 0, -9.81);
  KDL::ChainFkSolverPos_recursive fk(chain);
  KDL::ChainIdSolver_RNE inverse(chain, down);
  KDL::ChainFdSolver_RNE forward(chain, down);
  KDL::ChainDynParam parts(chain, down);
  const KDL::Wrenches none(n);
  std::vector<KDL::Frame> frames(n);
  KDL::JntSpaceInertiaMatrix M(n);
  KDL::JntArray g(n), coriolis(n), effort(n), ddq(n);

  bench::Check check;
  for (std::size_t i = 0; i < q.size(); ++i) {
    parts.JntToMass(q[i], M);
    parts.JntToGravity(q[i], g);
    inverse.CartToJnt(q[i], v[i], a[i], none, effort);
    forward.CartToJnt(q[i], v[i], effort, none, ddq);
    check.add("trM", M.data.trace());
    check.add("|g|", g.data.norm());
    check.add("|tau|", effort.data.norm());
    check.add("aba(rnea(a))-a", (ddq.data - a[i].data).norm() / a[i].data.norm());
  }
  check.print(bench.peer(), robot);

  for (const void* results :
       {static_cast<const void*>(frames.data()), static_cast<const void*>(M.data.data()),
        static_cast<const void*>(g.data.data()), static_cast<const void*>(coriolis.data.data()),
        static_cast<const void*>(effort.data.data()), static_cast<const void*>(ddq.data.data())}) {
    bench::Bench::watch(results);
  }
  const auto row = [&](const char* algorithm, auto&& f) { bench.row(robot, algorithm, f); };
  row("fk", [&](std::size_t i) { fk.JntToCart(q[i], frames); });
  row("rnea", [&](std::size_t i) { inverse.CartToJnt(q[i], v[i], a[i], none, effort); });
  row("nle", [&](std::size_t i) {
    parts.JntToCoriolis(q[i], v[i], coriolis);
    parts.JntToGravity(q[i], g);
  });
  row("gravity", [&](std::size_t i) { parts.JntToGravity(q[i], g); });
  row("crba", [&](std::size_t i) { parts.JntToMass(q[i], M); });
  row("aba", [&](std::size_t i) { forward.CartToJnt(q[i], v[i], tau[i], none, ddq); });
}

}  // namespace

int main(int argc, char** argv) { return bench::run("kdl", argc, argv, measure); }
