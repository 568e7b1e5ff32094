#include "rbd/algorithm/inner/workspace.h"

#include <algorithm>

namespace rbd::inner {

template <class S>
Scratch<S>::Scratch(const Model& model) {
  const auto njoints = static_cast<std::size_t>(model.njoints), nv = static_cast<std::size_t>(model.nv);
  sine.resize(static_cast<std::size_t>(model.nq) + 3);
  cosine.resize(sine.size());
  X.resize(njoints);
  R.assign(njoints, Mat3<S>::identity());
  p.assign(njoints, Vec3<S>::zero());
  column.assign(nv, Motion<S>::zero());
  I.resize(njoints);
  v.assign(njoints, Motion<S>::zero());
  a.assign(njoints, Motion<S>::zero());
  f.assign(njoints, Force<S>::zero());
  IA.resize(njoints);
  U.assign(nv, Force<S>::zero());
  inverseD.resize(nv);
  u.resize(nv);
  largestD.resize(njoints);
}

Workspace::Workspace(const Model& model) : topology(model.topology()), d(model) {
  const auto nv = static_cast<std::size_t>(model.nv);
  dofParent.assign(nv, -1);
  dofJoint.assign(nv, 0);
  std::vector<int> last(static_cast<std::size_t>(model.njoints), -1);  // last dof at or above a joint
  for (int i = 1; i < model.njoints; ++i) {
    const PackedJoint& joint = model.packed()[i];
    last[i] = last[joint.parent];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv; ++k) {
      dofParent[k] = last[i];
      dofJoint[k] = i;
      last[i] = k;
    }
  }
  // depth-first order without recursion (chains may be thousands long): sizes from the tips, then places
  std::vector<int> size(nv, 1), place(nv, 0), next(nv, 0);
  for (int k = model.nv - 1; k >= 0; --k) {
    if (dofParent[k] >= 0) size[dofParent[k]] += size[k];
  }
  order.assign(nv, 0);
  subtreeEnd.assign(nv, 0);
  depth.assign(nv, 0);
  int next_root = 0, deepest = 0;
  for (int k = 0; k < model.nv; ++k) {
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
  stride = (model.nv + 7) / 8 * 8;
  if (!depthFirst) W.assign(nv * static_cast<std::size_t>(stride), 0.0);
  d.F.assign(static_cast<std::size_t>(6 * stride), 0.0);
  d.P.assign(static_cast<std::size_t>(6 * stride) * static_cast<std::size_t>(deepest + 1), 0.0);
}

template struct Scratch<double>;
template struct Scratch<long double>;

}  // namespace rbd::inner
