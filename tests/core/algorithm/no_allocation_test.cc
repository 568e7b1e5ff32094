// No algorithm call with an output argument, or that answers in data, allocates. Counted in malloc itself,
// because Eigen does not go through operator new.
#include <gtest/gtest.h>

#include "tests/core/algorithm/random_tree.h"
#include "tests/support/malloc_hook.h"

namespace rbd {
namespace {

TEST(NoAllocation, AfterConstruction) {
#ifdef LAB_NO_MALLOC_HOOK
  GTEST_SKIP() << "sanitizers own malloc";
#endif
  Model model;
  buildModels::humanoid(model);
  const testing::State s = testing::randomState(model, 1);
  const Model scrambled = testing::randomTree(1, 12, true);
  const testing::State t = testing::randomState(scrambled, 1);
  Data data(model), other(scrambled);
  ASSERT_FALSE(static_cast<bool>(counting));
  Eigen::VectorXd x(model.nv), q(model.nq);
  Eigen::MatrixXd M(model.nv, model.nv), J(6, model.nv), Jcom(3, model.nv);
  Eigen::Vector3d com;
  Force h;
  Motion v;
  std::mt19937_64 engine(1);

  const auto count = [](const auto& call) {
    allocations = 0;
    counting = true;
    call();
    counting = false;
    return static_cast<int>(allocations);
  };
  // the counter works
  EXPECT_GE(count([&] {
              Eigen::VectorXd y = s.q;
              (void)y;
            }),
            1);

  EXPECT_EQ(0, count([&] { forwardKinematics(model, data, s.q, s.v, s.a); }));
  EXPECT_EQ(0, count([&] { updateFramePlacements(model, data); }));
  EXPECT_EQ(0, count([&] { getFrameVelocity(model, data, 3, LOCAL, v); }));
  EXPECT_EQ(0, count([&] { computeJointJacobians(model, data, s.q); }));
  EXPECT_EQ(0, count([&] { getJointJacobian(model, data, 5, WORLD, J); }));
  EXPECT_EQ(0, count([&] { getFrameJacobian(model, data, 5, LOCAL, J); }));
  EXPECT_EQ(0, count([&] { computeFrameJacobian(model, data, s.q, 5, LOCAL, J); }));
  EXPECT_EQ(0, count([&] { rnea(model, data, s.q, s.v, s.a); }));
  EXPECT_EQ(0, count([&] { rnea(model, data, s.q, s.v, s.a, x); }));
  EXPECT_EQ(0, count([&] { nonLinearEffects(model, data, s.q, s.v, x); }));
  EXPECT_EQ(0, count([&] { computeGeneralizedGravity(model, data, s.q, x); }));
  EXPECT_EQ(0, count([&] { crba(model, data, s.q, M); }));
  EXPECT_EQ(0, count([&] { aba(model, data, s.q, s.v, s.tau, x); }));
  EXPECT_EQ(0, count([&] { computeMinverse(model, data, s.q, M); }));
  EXPECT_EQ(0, count([&] { computeMinverse(scrambled, other, t.q); }));
  EXPECT_EQ(0, count([&] { centerOfMass(model, data, s.q, com); }));
  EXPECT_EQ(0, count([&] { centerOfMass(model, data, s.q, s.v); }));
  EXPECT_EQ(0, count([&] { jacobianCenterOfMass(model, data, s.q, Jcom); }));
  EXPECT_EQ(0, count([&] { computeCentroidalMomentum(model, data, s.q, s.v, h); }));
  EXPECT_EQ(0, count([&] { computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, s.a, h); }));
  EXPECT_EQ(0, count([&] { computeKineticEnergy(model, data, s.q, s.v); }));
  EXPECT_EQ(0, count([&] { computePotentialEnergy(model, data, s.q); }));
  EXPECT_EQ(0, count([&] { integrate(model, s.q, s.v, q); }));
  EXPECT_EQ(0, count([&] { difference(model, s.q, q, x); }));
  EXPECT_EQ(0, count([&] { interpolate(model, s.q, q, 0.3, q); }));
  EXPECT_EQ(0, count([&] { coordinateRate(model, s.v, s.a, x); }));
  EXPECT_EQ(0, count([&] { neutral(model, q); }));
  EXPECT_EQ(0, count([&] { randomConfiguration(model, engine, q); }));

  Eigen::MatrixXd N(model.nv, model.nv), K(model.nv, model.nv), A(6, model.nv), B(6, model.nv),
      C(6, model.nv);
  const FrameWrenches push = {{3, Force(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)), LOCAL}};
  EXPECT_EQ(0, count([&] { rnea(model, data, s.q, s.v, s.a, push); }));
  EXPECT_EQ(0, count([&] { aba(model, data, s.q, s.v, s.tau, push, x); }));
  EXPECT_EQ(0, count([&] { computeStaticTorque(model, data, s.q, push); }));
  EXPECT_EQ(0, count([&] { computeCoriolisMatrix(model, data, s.q, s.v, M); }));
  EXPECT_EQ(0, count([&] { computeRNEADerivatives(model, data, s.q, s.v, s.a, M, N); }));
  EXPECT_EQ(0, count([&] { computeABADerivatives(model, data, s.q, s.v, s.tau, M, N, K); }));
  EXPECT_EQ(0, count([&] { computeStaticTorqueDerivatives(model, data, s.q, push); }));
  EXPECT_EQ(0, count([&] {
              crba(model, data, s.q);
              cholesky::decompose(model, data);
              cholesky::solve(model, data, x);
              cholesky::multiply(model, data, x);
            }));
  EXPECT_EQ(0, count([&] {
              computeJointJacobiansTimeVariation(model, data, s.q, s.v);
              getFrameJacobianTimeVariation(model, data, 5, LOCAL, J);
            }));
  EXPECT_EQ(0, count([&] {
              computeForwardKinematicsDerivatives(model, data, s.q, s.v, s.a);
              getFrameVelocityDerivatives(model, data, 5, LOCAL, A, B);
              getFrameAccelerationDerivatives(model, data, 5, WORLD, A, B, C, J);
            }));
  EXPECT_EQ(0, count([&] { (void)getFrameClassicalAcceleration(model, data, 5, LOCAL); }));
  EXPECT_EQ(0, count([&] { computeCentroidalMap(model, data, s.q, A); }));
  EXPECT_EQ(0, count([&] { dccrba(model, data, s.q, s.v); }));
  EXPECT_EQ(0, count([&] { computeSubtreeCentersOfMass(model, data, s.q, s.v, s.a); }));
  EXPECT_EQ(0, count([&] { jacobianSubtreeCenterOfMass(model, data, s.q, 3, Jcom); }));
  EXPECT_EQ(0, count([&] { computeAllTerms(model, data, s.q, s.v); }));
  EXPECT_EQ(0, count([&] { distance(model, s.q, q); }));
  EXPECT_EQ(0, count([&] { dIntegrate(model, s.q, s.v, M, ARG0); }));
  EXPECT_EQ(0, count([&] { dDifference(model, s.q, q, M, ARG1); }));

  // joints of every kind that follow others
  const Model tree = testing::randomTree(4, 30, true);
  ASSERT_FALSE(tree.tree().mimic.identity);
  const testing::State w = testing::randomState(tree, 4);
  Data followed(tree);
  EXPECT_EQ(0, count([&] {
              computeAllTerms(tree, followed, w.q, w.v);
              computeABADerivatives(tree, followed, w.q, w.v, w.tau);
              rnea(tree, followed, w.q, w.v, w.a);
            }));

  // reaching, giving up after restarts, and resting, with more rows than Eigen's small products take
  IkScratch ik(model, 3);
  IkOptions options;
  options.restarts = 2;
  options.rest = neutral(model);
  const FrameIndex hand = model.nframes - 1, foot = model.nframes / 2;
  forwardKinematics(model, data, s.q);
  const FrameTarget targets[] = {{hand, data.oMf[hand]}, {foot, data.oMf[foot]}};
  const FrameTarget far[] = {{hand, data.oMf[hand]}, {hand, data.oMf[foot]}, {foot, data.oMf[foot]}};
  neutral(model, q);
  IkResult met, missed;
  EXPECT_EQ(0, count([&] { met = inverseKinematics(model, ik, targets, options, q); }));
  EXPECT_TRUE(met);
  EXPECT_EQ(0, count([&] { missed = inverseKinematics(model, ik, far, options, q); }));
  EXPECT_EQ(missed.starts, 3);
}

}  // namespace
}  // namespace rbd
