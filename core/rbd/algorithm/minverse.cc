#include "rbd/algorithm/minverse.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/cholesky.h"
#include "rbd/algorithm/crba.h"
#include "rbd/kernel/articulate.h"
#include "rbd/kernel/rotor_and_friction.h"
#include "rbd/kernel/sincos.h"

namespace rbd {
namespace inner {
namespace {

// The six coordinates of a force or a motion, for row-wise work.
void coordinates(const Vec3<double>& angular, const Vec3<double>& linear, double* x) {
  angular.storeU(x);
  linear.storeU(x + 3);
}

// Carpentier 2018: aba for all unit efforts at once, in world axes. Column c of F is the bias force of the
// subtree for a unit effort at dof c; column c of P the acceleration of the current body. Dofs are in
// depth-first order, so that a subtree is one range of columns. Row k is at W + k stride.

// Inward: row k = - S_k' F / D_k, then F += U_k times that row. Four columns at a time, from the chunk that
// contains k: left of k all of F is still 0, and beyond the subtree of k it stays 0.
void minverseInward(Workspace& work, int nv, double* W) {
  Scratch<double>& s = work.scratch;
  const int stride = work.stride;
  double* const F = s.F.data();
  std::fill(s.F.begin(), s.F.end(), 0.0);
  for (int at = nv - 1; at >= 0; --at) {
    const int k = work.order[at], end = work.subtreeEnd[at];
    double* row = W + at * stride;
    double S[6], U[6];
    coordinates(s.S[k].w, s.S[k].v, S);
    coordinates(s.U[k].n, s.U[k].f, U);
    const double scale = -s.inverseD[k];
    const int first = at & ~3;
    for (int c = 0; c < first; c += 4) storeLanes(row + c, Lanes4{});
    for (int c = first; c < end; c += 4) {
      Lanes4 f[6];
      for (int r = 0; r < 6; ++r) f[r] = loadLanes(F + r * stride + c);
      Lanes4 x =
          scale * ((S[0] * f[0] + S[1] * f[1] + S[2] * f[2]) + (S[3] * f[3] + S[4] * f[4] + S[5] * f[5]));
      const Mask4 place = Mask4{0, 1, 2, 3} + std::int64_t(c);
      x = chooseLanes(place < std::int64_t(end), x, Lanes4{});
      x = chooseLanes(place == std::int64_t(at), Lanes4{} + s.inverseD[k], x);
      storeLanes(row + c, x);
      for (int r = 0; r < 6; ++r) storeLanes(F + r * stride + c, f[r] + U[r] * x);
    }
    for (int c = (end + 3) & ~3; c < stride; c += 4) storeLanes(row + c, Lanes4{});
  }
}

// Outward: adds the contribution of the parents' motion, and computes the motion for the children.
void minverseOutward(Workspace& work, int nv, double* W) {
  Scratch<double>& s = work.scratch;
  const int stride = work.stride;
  for (int at = 0; at < nv; ++at) {
    const int k = work.order[at], depth = work.depth[at];
    double* row = W + at * stride;
    double* const P = s.P.data() + 6 * stride * depth;
    double S[6], U[6];
    coordinates(s.S[k].w, s.S[k].v, S);
    coordinates(s.U[k].n, s.U[k].f, U);
    const int first = at & ~3;
    if (depth > 0) {
      const double* const up = P - 6 * stride;
      const double scale = -s.inverseD[k];
      for (int c = first; c < nv; c += 4) {
        Lanes4 f[6];
        for (int r = 0; r < 6; ++r) f[r] = loadLanes(up + r * stride + c);
        const Lanes4 x = loadLanes(row + c) + scale * ((U[0] * f[0] + U[1] * f[1] + U[2] * f[2]) +
                                                       (U[3] * f[3] + U[4] * f[4] + U[5] * f[5]));
        storeLanes(row + c, x);
        for (int r = 0; r < 6; ++r) storeLanes(P + r * stride + c, f[r] + S[r] * x);
      }
    } else {
      for (int c = first; c < nv; c += 4) {
        const Lanes4 x = loadLanes(row + c);
        for (int r = 0; r < 6; ++r) storeLanes(P + r * stride + c, S[r] * x);
      }
    }
  }
}

// Fills the upper triangle. Returns the dof whose inertia d is singular, or -1.
int minverseKernel(const Model& model, const double* rotor, Workspace& work, const double* q, double* W,
                   double& d) {
  Scratch<double>& s = work.scratch;
  const Joints& joints = model.tree().joints;
  sinesAndCosines(model, q, s);
  worldPoses(joints, q, s);
  for (int i = 1; i < model.tree().size(); ++i) {
    worldSubspace(joints[i], i, s);
    s.IA[i] = ArticulatedInertia<double>::rigid(worldInertia(joints[i], s.R[i], s.p[i]));
  }
  const int singular = articulate(joints, rotor, s, d, [](int, int) {});
  if (singular >= 0) return singular;
  minverseInward(work, model.nv, W);
  minverseOutward(work, model.nv, W);
  return -1;
}

}  // namespace
}  // namespace inner

const PaddedMatrix& computeMinverse(const Model& model, Data& data, const ConstVectorRef& q) {
  inner::checkInputs("computeMinverse", model, data, q);
  inner::Workspace& work = data.work();
  if (!model.tree().mimic.identity) {
    // followers couple what the tree keeps apart: invert M itself
    crba(model, data, q);
    cholesky::decompose(model, data);
    data.Minv.setIdentity();
    for (int k = 0; k < model.nv; ++k) cholesky::solve(model, data, data.Minv.col(k));
    for (int k = 0; k < model.nv; ++k) {
      for (int l = 0; l < k; ++l) data.Minv(k, l) = data.Minv(l, k);
    }
    return data.Minv;
  }
  const int nv = model.nv, stride = work.stride;
  // Minv is symmetric, so row k of the kernel is column k of the matrix
  double* const W = work.depthFirst ? data.Minv.data() : work.W.data();
  double d = 0;
  const int singular = inner::minverseKernel(model, inner::rotors(model, work), work, q.data(), W, d);
  if (singular >= 0) inner::failSingular("computeMinverse", model, singular, d);
  if (work.depthFirst) {
    for (int k = 0; k < nv; ++k) {
      for (int c = k + 1; c < nv; ++c) W[c * stride + k] = W[k * stride + c];
    }
  } else {
    for (int k = 0; k < nv; ++k) {
      for (int c = k; c < nv; ++c) {
        const double x = W[k * stride + c];
        data.Minv(work.order[k], work.order[c]) = data.Minv(work.order[c], work.order[k]) = x;
      }
    }
  }
  return data.Minv;
}

void computeMinverse(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef Minv) {
  inner::checkOut("computeMinverse", "Minv", Minv, model.nv, model.nv);
  Minv = computeMinverse(model, data, q);
}

}  // namespace rbd
