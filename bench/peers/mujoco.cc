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

void measure(const bench::Bench& bench, const Robot& robot) {
  const Owned<mjModel> model = build(robot);
  const Owned<mjData> data(mj_makeData(model.get()));
  const mjModel* m = model.get();
  mjData* d = data.get();
  const int nv = robot.nv, base = robot.base();
  const std::size_t n = static_cast<std::size_t>(nv);
  std::vector<bench::State> x;
  for (const bench::State& s : robot.states) x.push_back(translate(robot, s));
  std::vector<double> out(n), bias(n), M(n * n), Minv(n * n), one(n * n, 0.0), J(3 * n);
  for (std::size_t i = 0; i < n; ++i) one[i * n + i] = 1;

  const auto position = [&](std::size_t i) {
    mju_copy(d->qpos, x[i].q.data(), robot.nq);
    mj_kinematics(m, d);
    mj_comPos(m, d);
  };
  const auto velocity = [&](std::size_t i) {
    mju_copy(d->qvel, x[i].v.data(), nv);
    position(i);
    mj_comVel(m, d);
  };
  const auto rnea = [&](std::size_t i) {
    velocity(i);
    mju_copy(d->qacc, x[i].a.data(), nv);
    mj_rne(m, d, 1, out.data());
  };
  const auto gravity = [&](std::size_t i) {
    position(i);
    mju_zero(d->qvel, nv);
    mj_comVel(m, d);
    mj_rne(m, d, 0, out.data());
  };
  const auto crba = [&](std::size_t i) {
    position(i);
    mj_makeM(m, d);
  };
  const auto minv = [&](std::size_t i) {
    crba(i);
    mj_factorM(m, d);
    mj_solveM(m, d, Minv.data(), one.data(), nv);
  };
  const auto aba = [&](std::size_t i, const double* tau) {
    velocity(i);
    mj_makeM(m, d);
    mj_factorM(m, d);
    mj_rne(m, d, 0, bias.data());
    mju_sub(bias.data(), tau, bias.data(), nv);
    mj_solveM(m, d, d->qacc, bias.data(), 1);
  };

  bench::Check check;
  for (std::size_t i = 0; i < x.size(); ++i) {
    minv(i);
    mj_fullM(m, d, M.data());
    const auto diagonal = [&](const std::vector<double>& matrix) {
      return bench::sum(base, nv, [&](int k) { return matrix[static_cast<std::size_t>(k) * (n + 1)]; });
    };
    check.add("trM", diagonal(M));
    check.add("trMinv", diagonal(Minv));
    const auto joints = [&](int k) { return out[static_cast<std::size_t>(k)]; };
    gravity(i);
    check.add("|g|", bench::norm(base, nv, joints));
    rnea(i);
    check.add("|tau|", bench::norm(base, nv, joints));
    for (int k = 0; k < 3; ++k) check.add(std::string("com_") + "xyz"[k], d -> subtree_com[k]);
    mj_jacSubtreeCom(m, d, J.data(), 0);
    double squares = 0;
    for (int row = 0; row < 3; ++row) squares += std::pow(mju_norm(&J[row * n + base], nv - base), 2);
    check.add("|Jcom|", std::sqrt(squares));
    mj_subtreeVel(m, d);
    check.add("|hg|", std::hypot(mju_norm3(d->subtree_angmom),
                                 mju_norm3(d->subtree_linvel) * m->body_subtreemass[0]));
    mj_energyVel(m, d);
    mj_energyPos(m, d);
    check.add("kinetic", d->energy[1]);
    check.add("potential", d->energy[0]);
    aba(i, out.data());
    mju_sub(bias.data(), d->qacc, x[i].a.data(), nv);
    check.add("aba(rnea(a))-a", mju_norm(bias.data(), nv) / mju_norm(x[i].a.data(), nv));
  }
  check.print(bench.peer(), robot);

  for (const void* results : {static_cast<const void*>(d), static_cast<const void*>(out.data()),
                              static_cast<const void*>(Minv.data()), static_cast<const void*>(J.data())}) {
    bench::Bench::watch(results);
  }
  const auto row = [&](const char* algorithm, auto&& f) { bench.row(robot, algorithm, f); };
  row("fk", [&](std::size_t i) {
    mju_copy(d->qpos, x[i].q.data(), robot.nq);
    mj_kinematics(m, d);
  });
  row("jacobians", position);  // cdof, 6 x nv motions about the tree's centre of mass, is the nearest it has
  row("rnea", rnea);
  row("nle", [&](std::size_t i) {
    velocity(i);
    mj_rne(m, d, 0, out.data());
  });
  row("gravity", gravity);
  row("crba", crba);  // sparse: without the copy to a full matrix
  row("aba", [&](std::size_t i) { aba(i, x[i].tau.data()); });
  row("minv", minv);
  row("crba_chol_solve", [&](std::size_t i) {
    crba(i);
    mj_factorM(m, d);
    mj_solveM(m, d, out.data(), x[i].tau.data(), 1);
  });
  row("com", position);
  row("jcom", [&](std::size_t i) {
    position(i);
    mj_jacSubtreeCom(m, d, J.data(), 0);
  });
  row("hg", [&](std::size_t i) {
    velocity(i);
    mj_subtreeVel(m, d);
  });
  row("kinetic", [&](std::size_t i) {
    crba(i);
    mju_copy(d->qvel, x[i].v.data(), nv);
    mj_energyVel(m, d);
  });
  row("potential", [&](std::size_t i) {
    position(i);
    mj_energyPos(m, d);
  });
}

}  // namespace

int main(int argc, char** argv) { return bench::run("mujoco", argc, argv, measure); }
