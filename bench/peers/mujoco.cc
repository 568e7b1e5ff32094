// MuJoCo's side of `lab bench core`: its C interface, without contacts, constraints, limits and actuators.
// Every row copies the state into mjData and does the position stage it needs, as one call of the other
// libraries does. MuJoCo has no ABA (`aba` is mass matrix, factor, bias forces, solve) and no analytical
// derivatives.
#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>

#include "../core/harness.h"

namespace {

using bench::Robot;

struct Delete {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
  void operator()(mjSpec* s) const { mj_deleteSpec(s); }
};
template <class T>
using Owned = std::unique_ptr<T, Delete>;

Owned<mjModel> build(const Robot& robot) {
  const Owned<mjSpec> spec(mj_makeSpec());
  spec->compiler.degree = 0;
  spec->compiler.fusestatic = 0;
  spec->compiler.balanceinertia = 0;
  std::vector<mjsBody*> bodies = {mjs_findBody(spec.get(), "world")};
  for (const bench::Joint& j : robot.joints) {
    mjsBody* body = mjs_addBody(bodies[static_cast<std::size_t>(j.parent)], nullptr);
    mju_copy3(body->pos, j.translation);
    mju_mat2Quat(body->quat, j.rotation);
    body->mass = j.mass;
    mju_copy3(body->ipos, j.com);
    mju_copy(body->fullinertia, j.inertia, 6);
    body->explicitinertial = 1;
    mjsJoint* joint = mjs_addJoint(body, nullptr);
    joint->type = j.kind == "freeflyer" ? mjJNT_FREE : j.kind == "revolute" ? mjJNT_HINGE : mjJNT_SLIDE;
    joint->align = mjALIGNFREE_FALSE;
    mju_copy3(joint->axis, j.axis);
    bodies.push_back(body);
  }
  Owned<mjModel> m(mj_compile(spec.get(), nullptr));
  if (!m) throw std::runtime_error(mjs_getError(spec.get()));
  if (m->nq != robot.nq || m->nv != robot.nv) throw std::runtime_error("another number of joints");
  m->opt.disableflags |=
      mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_EQUALITY | mjDSBL_ACTUATION;
  return m;
}

// A free joint here: quaternion wxyz; linear velocity first and in the world, angular in the body; and its
// linear acceleration is that of the point, not the spatial one.
bench::State translate(const Robot& robot, const bench::State& in) {
  if (!robot.floating()) return in;
  bench::State out = in;
  std::rotate(out.q.begin() + 3, out.q.begin() + 6, out.q.begin() + 7);
  double point[3], across[3];
  mju_rotVecQuat(out.v.data(), &in.v[3], &out.q[3]);
  mju_copy3(&out.v[3], in.v.data());
  mju_cross(across, in.v.data(), &in.v[3]);
  mju_add3(point, &in.a[3], across);
  mju_rotVecQuat(out.a.data(), point, &out.q[3]);
  mju_copy3(&out.a[3], in.a.data());
  return out;
}

// One robot: its model, its states in MuJoCo's conventions, and a function for each algorithm, of the number of a state.
struct Peer {
  explicit Peer(const Robot& r)
      : robot(r), model(build(r)), data(mj_makeData(model.get())), m(model.get()), d(data.get()) {
    for (const bench::State& s : robot.states) x.push_back(translate(robot, s));
    for (std::size_t i = 0; i < n; ++i) one[i * n + i] = 1;
  }

  void kinematics(std::size_t i) {
    mju_copy(d->qpos, x[i].q.data(), robot.nq);
    mj_kinematics(m, d);
  }
  void position(std::size_t i) {
    kinematics(i);
    mj_comPos(m, d);
  }
  void velocity(std::size_t i) {
    mju_copy(d->qvel, x[i].v.data(), nv);
    position(i);
    mj_comVel(m, d);
  }
  void rnea(std::size_t i) {
    velocity(i);
    mju_copy(d->qacc, x[i].a.data(), nv);
    mj_rne(m, d, 1, out.data());
  }
  void nle(std::size_t i) {
    velocity(i);
    mj_rne(m, d, 0, out.data());
  }
  void gravity(std::size_t i) {
    position(i);
    mju_zero(d->qvel, nv);
    mj_comVel(m, d);
    mj_rne(m, d, 0, out.data());
  }
  void crba(std::size_t i) {
    position(i);
    mj_makeM(m, d);
  }
  void minv(std::size_t i) {
    crba(i);
    mj_factorM(m, d);
    mj_solveM(m, d, Minv.data(), one.data(), nv);
  }
  void solve(std::size_t i) {
    crba(i);
    mj_factorM(m, d);
    mj_solveM(m, d, out.data(), x[i].tau.data(), 1);
  }
  void aba(std::size_t i, const double* tau) {
    velocity(i);
    mj_makeM(m, d);
    mj_factorM(m, d);
    mj_rne(m, d, 0, bias.data());
    mju_sub(bias.data(), tau, bias.data(), nv);
    mj_solveM(m, d, d->qacc, bias.data(), 1);
  }
  void jcom(std::size_t i) {
    position(i);
    mj_jacSubtreeCom(m, d, J.data(), 0);
  }
  void kinetic(std::size_t i) {
    crba(i);
    mju_copy(d->qvel, x[i].v.data(), nv);
    mj_energyVel(m, d);
  }

  const Robot& robot;
  Owned<mjModel> model;
  Owned<mjData> data;
  const mjModel* m;
  mjData* d;
  const int nv = robot.nv, base = robot.base();
  const std::size_t n = static_cast<std::size_t>(nv);
  std::vector<bench::State> x;
  std::vector<double> out = std::vector<double>(n), bias = out, M = std::vector<double>(n * n), Minv = M,
                      one = M, J = std::vector<double>(3 * n);
};

void check(const bench::Bench& bench, Peer& p) {
  bench::Check check;
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    p.minv(i);
    mj_fullM(p.m, p.d, p.M.data());
    const auto diagonal = [&](const std::vector<double>& matrix) {
      return bench::sum(p.base, p.nv, [&](int k) { return matrix[static_cast<std::size_t>(k) * (p.n + 1)]; });
    };
    check.add("trM", diagonal(p.M));
    check.add("trMinv", diagonal(p.Minv));
    const auto joints = [&](int k) { return p.out[static_cast<std::size_t>(k)]; };
    p.gravity(i);
    check.add("|g|", bench::norm(p.base, p.nv, joints));
    p.rnea(i);
    check.add("|tau|", bench::norm(p.base, p.nv, joints));
    const mjtNum* com = p.d->subtree_com;
    for (int k = 0; k < 3; ++k) check.add(std::string("com_") + "xyz"[k], com[k]);
    mj_jacSubtreeCom(p.m, p.d, p.J.data(), 0);
    double squares = 0;
    for (int row = 0; row < 3; ++row) {
      squares += std::pow(mju_norm(&p.J[row * p.n + p.base], p.nv - p.base), 2);
    }
    check.add("|Jcom|", std::sqrt(squares));
    mj_subtreeVel(p.m, p.d);
    check.add("|hg|", std::hypot(mju_norm3(p.d->subtree_angmom),
                                 mju_norm3(p.d->subtree_linvel) * p.m->body_subtreemass[0]));
    mj_energyVel(p.m, p.d);
    mj_energyPos(p.m, p.d);
    check.add("kinetic", p.d->energy[1]);
    check.add("potential", p.d->energy[0]);
    p.aba(i, p.out.data());
    const double* a = p.x[i].a.data();
    mju_sub(p.bias.data(), p.d->qacc, a, p.nv);
    check.add("aba(rnea(a))-a", mju_norm(p.bias.data(), p.nv) / mju_norm(a, p.nv));
  }
  check.print(bench.peer(), p.robot);
}

void measure(const bench::Bench& bench, const Robot& robot) {
  Peer p(robot);
  check(bench, p);
  for (const void* results :
       {static_cast<const void*>(p.d), static_cast<const void*>(p.out.data()),
        static_cast<const void*>(p.Minv.data()), static_cast<const void*>(p.J.data())}) {
    bench::Bench::watch(results);
  }
  const auto row = [&](const char* algorithm, auto&& f) { bench.row(robot, algorithm, f); };
  row("fk", [&](std::size_t i) { p.kinematics(i); });
  // cdof, 6 x nv motions about the tree's centre of mass, is the nearest it has
  row("jacobians", [&](std::size_t i) { p.position(i); });
  row("rnea", [&](std::size_t i) { p.rnea(i); });
  row("nle", [&](std::size_t i) { p.nle(i); });
  row("gravity", [&](std::size_t i) { p.gravity(i); });
  row("crba", [&](std::size_t i) { p.crba(i); });  // sparse: without the copy to a full matrix
  row("aba", [&](std::size_t i) { p.aba(i, p.x[i].tau.data()); });
  row("minv", [&](std::size_t i) { p.minv(i); });
  row("crba_chol_solve", [&](std::size_t i) { p.solve(i); });
  row("com", [&](std::size_t i) { p.position(i); });
  row("jcom", [&](std::size_t i) { p.jcom(i); });
  row("hg", [&](std::size_t i) {
    p.velocity(i);
    mj_subtreeVel(p.m, p.d);
  });
  row("kinetic", [&](std::size_t i) { p.kinetic(i); });
  row("potential", [&](std::size_t i) {
    p.position(i);
    mj_energyPos(p.m, p.d);
  });
}

}  // namespace

int main(int argc, char** argv) { return bench::run("mujoco", argc, argv, measure); }
