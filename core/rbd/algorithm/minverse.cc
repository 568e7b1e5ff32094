#include "rbd/algorithm/minverse.h"

#include "rbd/algorithm/cholesky.h"
#include "rbd/algorithm/crba.h"
#include "rbd/algorithm/inner/articulate.h"
#include "rbd/algorithm/inner/check.h"
#include "rbd/algorithm/inner/joint_terms.h"

namespace rbd {
namespace inner {
namespace {

// The six coordinates of a force or a motion, for row-wise work.
void coordinates(const Vec3<double>& angular, const Vec3<double>& linear, double* x) {
  angular.storeU(x);
  linear.storeU(x + 3);
}

// Carpentier 2018: aba for all unit efforts at once, in world axes. Column c of F is the force that the
// bodies beyond need when dof c is pushed; column c of P the acceleration of the body reached so far. Dofs
// are taken in depth-first order, where what a dof moves is one range of columns. `W` (row k at W + k stride)
// gets the upper triangle.
int minverseKernel(const Model& model, const double* rotor, Workspace& work, const double* q, double* W,
                   double& d) {
  Scratch<double>& s = work.d;
  const Joints& joints = model.tree().joints;
  const int nv = model.nv, stride = work.stride;
  angles(model, q, s);
  worldPoses(joints, q, s);
  for (int i = 1; i < model.tree().size(); ++i) {
    worldColumns(joints[i], i, s);
    s.IA[i] = ArticulatedInertia<double>::rigid(worldInertia(joints[i], s.R[i], s.p[i]));
  }
  const int singular = articulate(joints, rotor, s, d, [](int, int, const Motion<double>&) {});
  if (singular >= 0) return singular;

  // inward: row k = - S_k' F / D_k, then F takes U_k times that row
  double* const F = s.F.data();
  std::fill(s.F.begin(), s.F.end(), 0.0);
  for (int at = nv - 1; at >= 0; --at) {
    const int k = work.order[at], end = work.subtreeEnd[at];
    double* row = W + at * stride;
    double S[6], U[6];
    coordinates(s.column[k].w, s.column[k].v, S);
    coordinates(s.U[k].n, s.U[k].f, U);
    const double scale = -s.inverseD[k];
    for (int c = at + 1; c < end; ++c) {
      row[c] = scale * (S[0] * F[c] + S[1] * F[stride + c] + S[2] * F[2 * stride + c] +
                        S[3] * F[3 * stride + c] + S[4] * F[4 * stride + c] + S[5] * F[5 * stride + c]);
    }
    row[at] = s.inverseD[k];
    for (int c = end; c < nv; ++c) row[c] = 0;
    for (int r = 0; r < 6; ++r) {
      for (int c = at; c < end; ++c) F[r * stride + c] += U[r] * row[c];
    }
  }

  // outward: what the parents' motion adds, and the motion handed on to the children
  for (int at = 0; at < nv; ++at) {
    const int k = work.order[at], depth = work.depth[at];
    double* row = W + at * stride;
    double* const P = s.P.data() + 6 * stride * depth;
    double S[6], U[6];
    coordinates(s.column[k].w, s.column[k].v, S);
    coordinates(s.U[k].n, s.U[k].f, U);
    if (depth > 0) {
      const double* const up = P - 6 * stride;
      const double scale = -s.inverseD[k];
      for (int c = at; c < nv; ++c) {
        row[c] += scale * (U[0] * up[c] + U[1] * up[stride + c] + U[2] * up[2 * stride + c] +
                           U[3] * up[3 * stride + c] + U[4] * up[4 * stride + c] + U[5] * up[5 * stride + c]);
      }
      for (int r = 0; r < 6; ++r) {
        for (int c = at; c < nv; ++c) P[r * stride + c] = up[r * stride + c] + S[r] * row[c];
      }
    } else {
      for (int r = 0; r < 6; ++r) {
        for (int c = at; c < nv; ++c) P[r * stride + c] = S[r] * row[c];
      }
    }
  }
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
