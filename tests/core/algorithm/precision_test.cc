// The kernels compiled for long double against those for double: the rounding error itself, and a proof that
// the three-scalar form of the inner types (what packets will use) computes the same.
#include <gtest/gtest.h>

#include "rbd/algorithm/kernels.h"
#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using Long = long double;

std::vector<Long> widen(const Eigen::VectorXd& x) { return {x.begin(), x.end()}; }

double error(const double* x, const std::vector<Long>& wanted) {
  Long worst = 0, size = 1;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    worst = std::max(worst, std::abs(x[i] - wanted[i]));
    size = std::max(size, std::abs(wanted[i]));
  }
  return static_cast<double>(worst / size);
}

TEST(Precision, DoubleKernelsAgainstLongDouble) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    // no mimic: kernels work on the free tree
    const Model model = buildModels::randomTree(seed, {.joints = 20, .floating_base = seed % 2 == 0});
    const testing::State s = testing::randomState(model, seed);
    const auto nv = static_cast<std::size_t>(model.nv);
    Data data(model);
    inner::Scratch<Long> scratch(model);
    std::vector<Long> out(nv), M(nv * nv);
    const auto q = widen(s.q), v = widen(s.v), a = widen(s.a), tau = widen(s.tau);

    const double* const rotor = model.armature.data();
    inner::rneaKernel<Long>(model, scratch, q.data(), v.data(), a.data(), out.data());
    for (std::size_t k = 0; k < nv; ++k) out[k] += rotor[k] * a[k];
    EXPECT_LE(error(rnea(model, data, s.q, s.v, s.a).data(), out), 1e-14);
    inner::gravityKernel<Long>(model, scratch, q.data(), out.data());
    EXPECT_LE(error(computeGeneralizedGravity(model, data, s.q).data(), out), 1e-14);
    inner::crbaKernel<Long>(model, data.work().dofParent.data(), scratch, q.data(), M.data(), model.nv);
    for (std::size_t k = 0; k < nv; ++k) M[k * nv + k] += rotor[k];
    const Eigen::MatrixXd plain = crba(model, data, s.q);
    EXPECT_LE(error(plain.data(), M), 1e-14);
    Long d = 0;
    ASSERT_EQ(inner::abaKernel<Long>(model, rotor, scratch, q.data(), v.data(), tau.data(), out.data(), d),
              -1);
    EXPECT_LE(error(aba(model, data, s.q, s.v, s.tau).data(), out), 1e-12);  // condition of M up to about 1e3
  }
}

}  // namespace
}  // namespace rbd
