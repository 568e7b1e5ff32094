// Analytical derivatives against central differences along integrate(), on trees of every joint type with
// mimic.
#include "rbd/algorithm/derivatives.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::distance;
using testing::kEps;
using testing::times;
using Function = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

// d f(integrate(q, x)) / dx at 0, error h^2 and eps / h.
constexpr double kStep = 1e-5;
Eigen::MatrixXd slopeInQ(const Model& model, const Eigen::VectorXd& q, const Function& f) {
  Eigen::MatrixXd out(f(q).size(), model.nv);
  for (int k = 0; k < model.nv; ++k) {
    const Eigen::VectorXd x = kStep * Eigen::VectorXd::Unit(model.nv, k);
    out.col(k) = (f(integrate(model, q, x)) - f(integrate(model, q, -x))) / (2 * kStep);
  }
  return out;
}
Eigen::MatrixXd slopeInV(const Eigen::VectorXd& v, const Function& f) {
  Eigen::MatrixXd out(f(v).size(), v.size());
  for (int k = 0; k < v.size(); ++k) {
    const Eigen::VectorXd x = kStep * Eigen::VectorXd::Unit(v.size(), k);
    out.col(k) = (f(v + x) - f(v - x)) / (2 * kStep);
  }
  return out;
}

class Derivatives : public ::testing::TestWithParam<int> {
 protected:
  unsigned seed = static_cast<unsigned>(GetParam());
  Model model = testing::randomTree(seed, 2 + GetParam(), GetParam() % 2 == 0);
  testing::State s = testing::randomState(model, seed);
  Data data{model};
  // three wrenches, one per reference
  FrameWrenches wrenches() const {
    testing::Random random(seed + 7);
    FrameWrenches out;
    for (const ReferenceFrame reference : {WORLD, LOCAL, LOCAL_WORLD_ALIGNED}) {
      out.push_back({random.below(model.nframes), random.force(), reference});
    }
    return out;
  }
};

constexpr double kTol = 1e-7;  // h^2 times third derivatives of size 1e2, and 1e-16 / h times efforts of 1e3

TEST_P(Derivatives, OfInverseDynamics) {
  model.terms.damping = model.terms.friction = GetParam() % 2;
  model.damping.setConstant(0.3);
  model.friction.setConstant(1e-3);
  computeRNEADerivatives(model, data, s.q, s.v, s.a);
  Data other(model);
  const auto in_q = [&](const Eigen::VectorXd& q) { return rnea(model, other, q, s.v, s.a); };
  const auto in_v = [&](const Eigen::VectorXd& v) { return rnea(model, other, s.q, v, s.a); };
  EXPECT_LE(distance(data.dtau_dq, slopeInQ(model, s.q, in_q)), kTol);
  EXPECT_LE(distance(data.dtau_dv, slopeInV(s.v, in_v)), kTol);
}

TEST_P(Derivatives, OfInverseDynamicsWithWrenches) {
  const FrameWrenches w = wrenches();
  computeRNEADerivatives(model, data, s.q, s.v, s.a, w);
  Data other(model);
  const auto in_q = [&](const Eigen::VectorXd& q) { return rnea(model, other, q, s.v, s.a, w); };
  EXPECT_LE(distance(data.dtau_dq, slopeInQ(model, s.q, in_q)), kTol);
}

TEST_P(Derivatives, OfStaticTorque) {
  const FrameWrenches w = wrenches();
  Data other(model);
  const auto held = [&](const Eigen::VectorXd& q) { return computeStaticTorque(model, other, q, w); };
  EXPECT_LE(distance(computeStaticTorqueDerivatives(model, data, s.q, w), slopeInQ(model, s.q, held)), kTol);
  const auto gravity = [&](const Eigen::VectorXd& q) { return computeGeneralizedGravity(model, other, q); };
  EXPECT_LE(distance(computeGeneralizedGravityDerivatives(model, data, s.q), slopeInQ(model, s.q, gravity)),
            kTol);
}

TEST_P(Derivatives, OfForwardDynamics) {
  computeABADerivatives(model, data, s.q, s.v, s.tau);
  Data other(model);
  const double bound = testing::condition(crba(model, other, s.q), data.Minv);
  const auto in_q = [&](const Eigen::VectorXd& q) { return aba(model, other, q, s.v, s.tau); };
  const auto in_v = [&](const Eigen::VectorXd& v) { return aba(model, other, s.q, v, s.tau); };
  const auto in_tau = [&](const Eigen::VectorXd& tau) { return aba(model, other, s.q, s.v, tau); };
  EXPECT_LE(distance(data.ddq_dq, slopeInQ(model, s.q, in_q)), kTol * bound);
  EXPECT_LE(distance(data.ddq_dv, slopeInV(s.v, in_v)), kTol * bound);
  EXPECT_LE(distance(data.Minv, slopeInV(s.tau, in_tau)), kTol * bound);

  // with wrenches: the derivative of the solution of M a + nle = tau + J' f
  const FrameWrenches w = wrenches();
  computeABADerivatives(model, data, s.q, s.v, s.tau, w);
  const auto pushed = [&](const Eigen::VectorXd& q) { return aba(model, other, q, s.v, s.tau, w); };
  EXPECT_LE(distance(data.ddq_dq, slopeInQ(model, s.q, pushed)), kTol * bound);
}

TEST_P(Derivatives, OutputTwinsAgree) {
  Eigen::MatrixXd a(model.nv, model.nv), b = a, c = a;
  computeRNEADerivatives(model, data, s.q, s.v, s.a, a, b);
  EXPECT_EQ(distance(a, data.dtau_dq) + distance(b, data.dtau_dv), 0);
  computeABADerivatives(model, data, s.q, s.v, s.tau, a, b, c);
  EXPECT_EQ(distance(a, data.ddq_dq) + distance(b, data.ddq_dv) + distance(c, data.Minv), 0);
}

INSTANTIATE_TEST_SUITE_P(Random, Derivatives, ::testing::Range(0, 14));

// ---- C(q, v)

TEST_P(Derivatives, CoriolisMatrixGivesTheBias) {
  const Eigen::MatrixXd C = computeCoriolisMatrix(model, data, s.q, s.v);
  const Eigen::VectorXd bias =
      nonLinearEffects(model, data, s.q, s.v) - computeGeneralizedGravity(model, data, s.q);
  EXPECT_LE(distance(times(C, s.v), bias), 1e3 * kEps * std::max(1.0, data.nle.cwiseAbs().maxCoeff()));
}

// dM/dt along the motion is C + C': what makes passivity-based control work.
TEST_P(Derivatives, InertiaRateMinusTwiceCoriolisIsSkew) {
  const Eigen::MatrixXd C = computeCoriolisMatrix(model, data, s.q, s.v);
  const Eigen::MatrixXd after = crba(model, data, integrate(model, s.q, kStep * s.v));
  const Eigen::MatrixXd before = crba(model, data, integrate(model, s.q, -kStep * s.v));
  EXPECT_LE(distance(C + C.transpose(), (after - before) / (2 * kStep)), kTol);
}

}  // namespace
}  // namespace rbd
