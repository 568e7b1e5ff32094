#include "tests/core/algorithm/random_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbd::testing {

Model randomTree(unsigned seed, int n, bool free_root, Order order) {
  return buildModels::randomTree(seed, {.joints = n,
                                        .floating_base = free_root,
                                        .depth_first = order == Order::DepthFirst,
                                        .mimic = seed % 3 == 1});
}

State randomState(const Model& model, unsigned seed) {
  Random random(seed + 1000);
  return {randomConfiguration(model, random.engine), random.vec(model.nv), random.vec(model.nv),
          random.vec(model.nv, 5)};
}

double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return std::numeric_limits<double>::infinity();
  double worst = 0, size = 1;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    const double error = std::abs(a.data()[i] - b.data()[i]);
    if (!(error <= worst)) worst = error;
    if (worst != worst) return worst;
    size = std::max(size, std::abs(b.data()[i]));
  }
  return worst / size;
}

Eigen::MatrixXd times(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a * b; }

double condition(const Eigen::MatrixXd& m, const Eigen::MatrixXd& inverse) {
  return m.norm() * inverse.norm();
}

}  // namespace rbd::testing
