#include "rbd/kernel/workspace.h"

#include <algorithm>

namespace rbd::inner {

template <class Scalar>
Scratch<Scalar>::Scratch(const Model& model) {
  const KernelTree& tree = model.tree();
  const auto bodies = tree.joints.size(), nv = static_cast<std::size_t>(tree.nv);
  sine.resize(static_cast<std::size_t>(tree.nq) + 3);
  cosine.resize(sine.size());
  X.resize(bodies);
  R.assign(bodies, Mat3<Scalar>::identity());
  p.assign(bodies, Vec3<Scalar>::zero());
  S.assign(nv, SpatialMotion<Scalar>::zero());
  I.resize(bodies);
  dI.resize(bodies);
  v.assign(bodies, SpatialMotion<Scalar>::zero());
  a.assign(bodies, SpatialMotion<Scalar>::zero());
  f.assign(bodies, SpatialForce<Scalar>::zero());
  B.resize(bodies);
  for (std::vector<SpatialMotion<Scalar>>* x : {&Sd, &Psid, &Psidd})
    x->assign(nv, SpatialMotion<Scalar>::zero());
  IA.resize(bodies);
  U.assign(nv, SpatialForce<Scalar>::zero());
  inverseD.resize(nv);
  u.resize(nv);
  largestD.resize(bodies);
}

Workspace::Workspace(const Model& model) : topology(model.topology()), scratch(model) {
  const KernelTree& tree = model.tree();
  const auto nv = static_cast<std::size_t>(tree.nv);
  dofParent.assign(nv, -1);
  std::vector<int> last(tree.joints.size(), -1);  // last dof at or above a body
  for (int i = 1; i < tree.size(); ++i) {
    const PackedJoint& joint = tree.joints[i];
    last[i] = last[joint.parent];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) {
      dofParent[k] = last[i];
      last[i] = k;
    }
  }
  // depth-first order without recursion (chains may be thousands long): sizes from the tips, then places
  std::vector<int> size(nv, 1), place(nv, 0), next(nv, 0);
  for (int k = tree.nv - 1; k >= 0; --k) {
    if (dofParent[k] >= 0) size[dofParent[k]] += size[k];
  }
  order.assign(nv, 0);
  subtreeEnd.assign(nv, 0);
  depth.assign(nv, 0);
  int next_root = 0, deepest = 0;
  for (int k = 0; k < tree.nv; ++k) {
    const int up = dofParent[k];
    int& free_place = up < 0 ? next_root : next[up];
    place[k] = free_place;
    free_place += size[k];
    next[k] = place[k] + 1;
    order[place[k]] = k;
    subtreeEnd[place[k]] = place[k] + size[k];
    depth[place[k]] = up < 0 ? 0 : depth[place[up]] + 1;
    deepest = std::max(deepest, depth[place[k]]);
    depthFirst = depthFirst && place[k] == k;
  }
  stride = (tree.nv + 7) / 8 * 8;
  if (!depthFirst) W.assign(nv * static_cast<std::size_t>(stride), 0.0);

  for (std::vector<SpatialMotion<double>>* x : {&kept.S, &kept.Sd, &kept.Psid, &kept.Psidd}) x->resize(nv);
  for (std::vector<SpatialMotion<double>>* x : {&kept.v, &kept.a}) x->resize(tree.joints.size());
  related.resize(nv);
  inside.resize(tree.joints.size());
  eliminationParent = dofParent;
  rotor.assign(static_cast<std::size_t>(model.nv), 0.0);
  effort.setZero(model.nv);
  if (!tree.mimic.identity) {
    // a follower may stand anywhere, so any two dofs may be coupled
    eliminationParent.resize(static_cast<std::size_t>(model.nv));
    for (int k = 0; k < model.nv; ++k) eliminationParent[k] = k - 1;
    q.resize(static_cast<std::size_t>(tree.nq));
    for (std::vector<double>* x : {&v, &a, &tau}) x->resize(nv);
    for (PaddedMatrix* x : {&J, &dJ, &Ag}) *x = PaddedMatrix(6, tree.nv);
    Jcom = PaddedMatrix(3, tree.nv);
    for (PaddedMatrix* x : {&M, &M2}) *x = PaddedMatrix(tree.nv, tree.nv);
  }

  const std::size_t rows = 6 * static_cast<std::size_t>(stride);
  scratch.F.assign(rows, 0.0);
  scratch.P.assign(rows * static_cast<std::size_t>(deepest + 1), 0.0);
}

template struct Scratch<double>;
template struct Scratch<long double>;

}  // namespace rbd::inner
