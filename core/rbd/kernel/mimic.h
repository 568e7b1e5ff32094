// Maps between the user's vectors and those of the kernels' tree, where every joint is independent:
//   q_tree = G q + offset,  v_tree = G v,  tau = G' tau_tree,  M = G' M_tree G,  J = J_tree G.
//
// Without mimic joints G is the identity, and the kernels read and write the user's vectors directly.
#pragma once

#include "rbd/kernel/workspace.h"
#include "rbd/spatial/vector_ref.h"

namespace rbd::inner {

inline const double* expandQ(const Model& model, Workspace& work, const ConstVectorRef& q) {
  const MimicMap& map = model.tree().mimic;
  if (map.identity) return q.data();
  for (std::size_t k = 0; k < work.q.size(); ++k) {
    work.q[k] = map.q_ratio[k] * q[map.q_source[k]] + map.q_offset[k];
  }
  return work.q.data();
}

// `expanded`: work.v or work.a.
inline const double* expandV(const Model& model, std::vector<double>& expanded, const ConstVectorRef& v) {
  const MimicMap& map = model.tree().mimic;
  if (map.identity) return v.data();
  for (std::size_t k = 0; k < expanded.size(); ++k) expanded[k] = map.v_ratio[k] * v[map.v_source[k]];
  return expanded.data();
}

// kernelOutput: the array a kernel writes its nv_tree efforts to. collapse: `out` = G' times that array.
inline double* kernelOutput(const Model& model, Workspace& work, Eigen::VectorXd& out) {
  return model.tree().mimic.identity ? out.data() : work.tau.data();
}
inline void collapse(const Model& model, const Workspace& work, Eigen::VectorXd& out) {
  const MimicMap& map = model.tree().mimic;
  if (map.identity) return;
  out.setZero();
  for (std::size_t k = 0; k < work.tau.size(); ++k) out[map.v_source[k]] += map.v_ratio[k] * work.tau[k];
}

// The same for matrices with one column per dof (rows unchanged) ..
inline double* kernelOutput(const Model& model, PaddedMatrix& scratch, PaddedMatrix& out) {
  return model.tree().mimic.identity ? out.data() : scratch.data();
}
inline void collapseColumns(const Model& model, const PaddedMatrix& scratch, PaddedMatrix& out) {
  const MimicMap& map = model.tree().mimic;
  if (map.identity) return;
  out.setZero();
  for (Eigen::Index k = 0; k < scratch.cols(); ++k)
    out.col(map.v_source[k]) += map.v_ratio[k] * scratch.col(k);
}
// .. and with one row and one column per dof.
inline void collapseBothSides(const Model& model, const PaddedMatrix& scratch, PaddedMatrix& out) {
  const MimicMap& map = model.tree().mimic;
  if (map.identity) return;
  out.setZero();
  for (Eigen::Index k = 0; k < scratch.cols(); ++k) {
    for (Eigen::Index l = 0; l < scratch.rows(); ++l) {
      out(map.v_source[l], map.v_source[k]) += map.v_ratio[l] * map.v_ratio[k] * scratch(l, k);
    }
  }
}

}  // namespace rbd::inner
