#include "rbd/algorithm/cholesky.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/kernel/workspace.h"

namespace rbd::cholesky {

void decompose(const Model& model, Data& data) {
  inner::checkData("cholesky::decompose", model, data);
  const std::vector<int>& parent = data.work().eliminationParent;
  PaddedMatrix& U = data.U;
  U.setIdentity();
  for (int k = 0; k < model.nv; ++k) {
    data.D[k] = data.M(k, k);
    for (int i = parent[k]; i >= 0; i = parent[i]) U(i, k) = data.M(i, k);
  }
  for (int k = model.nv - 1; k >= 0; --k) {
    // rounding leaves about this much of a true zero
    if (!(data.D[k] > 1e-14 * data.M(k, k))) inner::failSingular("cholesky::decompose", model, k, data.D[k]);
    for (int i = parent[k]; i >= 0; i = parent[i]) {
      const double a = U(i, k) / data.D[k];
      data.D[i] -= a * U(i, k);
      for (int j = parent[i]; j >= 0; j = parent[j]) U(j, i) -= a * U(j, k);
      U(i, k) = a;
    }
  }
}

void solve(const Model& model, const Data& data, VectorRef x) {
  inner::checkData("cholesky::solve", model, data);
  inner::checkOut("cholesky::solve", "x", model, x, model.nv, "nv");
  const std::vector<int>& parent = data.work().eliminationParent;
  for (int k = model.nv - 1; k >= 0; --k) {
    for (int i = parent[k]; i >= 0; i = parent[i]) x[i] -= data.U(i, k) * x[k];
  }
  for (int k = 0; k < model.nv; ++k) {
    x[k] /= data.D[k];
    for (int i = parent[k]; i >= 0; i = parent[i]) x[k] -= data.U(i, k) * x[i];
  }
}

void multiply(const Model& model, const Data& data, VectorRef x) {
  inner::checkData("cholesky::multiply", model, data);
  inner::checkOut("cholesky::multiply", "x", model, x, model.nv, "nv");
  const std::vector<int>& parent = data.work().eliminationParent;
  for (int k = model.nv - 1; k >= 0; --k) {
    for (int i = parent[k]; i >= 0; i = parent[i]) x[k] += data.U(i, k) * x[i];
    x[k] *= data.D[k];
  }
  for (int k = 0; k < model.nv; ++k) {
    for (int i = parent[k]; i >= 0; i = parent[i]) x[i] += data.U(i, k) * x[k];
  }
}

}  // namespace rbd::cholesky
