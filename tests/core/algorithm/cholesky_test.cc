#include "rbd/algorithm/cholesky.h"

#include <gtest/gtest.h>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::condition;
using testing::distance;
using testing::kEps;
using testing::times;

constexpr double kTol = 1e3 * kEps;  // as for the other algorithms on these trees

class Cholesky : public ::testing::TestWithParam<int> {
 protected:
  unsigned seed = static_cast<unsigned>(GetParam());
  Model model = testing::randomTree(seed, 3 + 3 * GetParam(), GetParam() % 2 == 0);
  testing::State s = testing::randomState(model, seed);
  Data data{model};
  Eigen::MatrixXd M = crba(model, data, s.q);
  void SetUp() override { cholesky::decompose(model, data); }
};

TEST_P(Cholesky, FactorsMultiplyToM) {
  const Eigen::MatrixXd U = data.U, D = data.D.asDiagonal();
  EXPECT_LE(distance(times(times(U, D), U.transpose()), M), kTol);
  EXPECT_GT(data.D.minCoeff(), 0);
  for (int k = 0; k < model.nv; ++k) {
    EXPECT_EQ(U(k, k), 1);
    for (int i = k + 1; i < model.nv; ++i) EXPECT_EQ(U(i, k), 0);
  }
}

// Dofs on different branches do not meet in M, nor in its factors.
TEST_P(Cholesky, BranchesCostNothing) {
  if (!model.tree().mimic.identity) return;  // followers tie branches together
  const auto carries = [&](JointIndex upper, JointIndex lower) {
    while (lower > upper) lower = model.parents[lower];
    return lower == upper;
  };
  for (JointIndex i = 1; i < model.njoints; ++i) {
    for (JointIndex j = i + 1; j < model.njoints; ++j) {
      if (carries(i, j)) continue;
      const int at = model.joints[i].idx_v(), to = model.joints[j].idx_v();
      const Eigen::MatrixXd block = data.U.block(at, to, model.joints[i].nv(), model.joints[j].nv());
      EXPECT_EQ(block.norm(), 0) << model.names[i] << " " << model.names[j];
    }
  }
}

TEST_P(Cholesky, SolveAndMultiply) {
  const Eigen::MatrixXd Minv = computeMinverse(model, data, s.q);
  Eigen::VectorXd x = s.tau;
  cholesky::solve(model, data, x);
  EXPECT_LE(distance(x, times(Minv, s.tau)), kTol * condition(M, Minv));
  x = s.a;
  cholesky::multiply(model, data, x);
  EXPECT_LE(distance(x, times(M, s.a)), kTol);
}

INSTANTIATE_TEST_SUITE_P(Random, Cholesky, ::testing::Range(0, 10));

}  // namespace
}  // namespace rbd
