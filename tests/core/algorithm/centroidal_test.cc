#include "rbd/algorithm/centroidal.h"

#include <gtest/gtest.h>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::distance;

class Centroidal : public ::testing::TestWithParam<int> {
 protected:
  unsigned seed = static_cast<unsigned>(GetParam());
  Model model = testing::randomTree(seed, 2 + 3 * GetParam(), GetParam() % 2 == 0);
  testing::State s = testing::randomState(model, seed);
  Data data{model};
};

TEST_P(Centroidal, CentreOfMassIsTheWeightedMean) {
  forwardKinematics(model, data, s.q);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double mass = 0;
  for (JointIndex i = 1; i < model.njoints; ++i) {
    mass += model.inertias[i].mass();
    sum += model.inertias[i].mass() * data.oMi[i].act(model.inertias[i].lever());
  }
  EXPECT_LE((centerOfMass(model, data, s.q) - sum / mass).norm(), 1e-13);
  EXPECT_NEAR(data.mass[0], mass, 1e-13);
  Eigen::Vector3d out;
  centerOfMass(model, data, s.q, out);
  EXPECT_EQ(out, data.com[0]);
}

TEST_P(Centroidal, JacobianIsTheDerivative) {
  const Eigen::MatrixXd J = jacobianCenterOfMass(model, data, s.q);
  const double h = 1e-6;
  for (int k = 0; k < model.nv; ++k) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.nv, k);
    const Eigen::Vector3d after = centerOfMass(model, data, integrate(model, s.q, step));
    const Eigen::Vector3d before = centerOfMass(model, data, integrate(model, s.q, -step));
    EXPECT_LE((J.col(k) - (after - before) / (2 * h)).norm(), 1e-8) << k;
  }
  centerOfMass(model, data, s.q, s.v);
  EXPECT_LE(distance(testing::times(J, s.v), data.vcom[0]), 1e-13);
  Eigen::MatrixXd out(3, model.nv);
  jacobianCenterOfMass(model, data, s.q, out);
  EXPECT_EQ(distance(out, J), 0);
}

TEST_P(Centroidal, MomentumIsTheSumOverBodies) {
  forwardKinematics(model, data, s.q, s.v);
  Force sum;
  for (JointIndex i = 1; i < model.njoints; ++i) sum += data.oMi[i].act(model.inertias[i] * data.v[i]);
  const Eigen::Vector3d com = centerOfMass(model, data, s.q);
  const SE3 there(Eigen::Matrix3d::Identity(), com);
  const double scale = std::max(1.0, sum.toVector().norm());
  EXPECT_TRUE(computeCentroidalMomentum(model, data).isApprox(there.actInv(sum), 1e-13 * scale));
  centerOfMass(model, data, s.q, s.v);
  EXPECT_LE((data.hg.linear() - data.mass[0] * data.vcom[0]).norm(), 1e-13 * scale);
  Force out;
  computeCentroidalMomentum(model, data, s.q, s.v, out);
  EXPECT_EQ(out, data.hg);
}

TEST_P(Centroidal, RateOfMomentumIsItsDerivative) {
  forwardKinematics(model, data, s.q, s.v, s.a);
  const Force dhg = computeCentroidalMomentumTimeVariation(model, data);
  const double h = 1e-5;
  const auto at = [&](double t) {
    return computeCentroidalMomentum(model, data, integrate(model, s.q, t * s.v + 0.5 * t * t * s.a),
                                     s.v + t * s.a);
  };
  const Force rate = (at(h) - at(-h)) * (0.5 / h);
  EXPECT_TRUE(dhg.isApprox(rate, 1e-7 * std::max(1.0, dhg.toVector().norm())));
  // without accelerations the joints' are taken as zero
  forwardKinematics(model, data, s.q, s.v);
  Force bias;
  computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, Eigen::VectorXd::Zero(model.nv), bias);
  EXPECT_EQ(computeCentroidalMomentumTimeVariation(model, data), bias);
}

INSTANTIATE_TEST_SUITE_P(Random, Centroidal, ::testing::Range(0, 8));

// Free in space, whatever the joints' efforts: linear momentum changes by m g, angular about the CoM not at
// all.
TEST(CentroidalLaws, OnlyGravityChangesTheMomentumOfAFreeRobot) {
  Model model;
  buildModels::humanoid(model);
  Data data(model);
  const testing::State s = testing::randomState(model, 3);
  Eigen::VectorXd tau = s.tau;
  tau.head<6>().setZero();
  // rotors stand on the links but carry no spin of their own in this model: leave them out
  model.armature.setZero();
  const Eigen::VectorXd a = aba(model, data, s.q, s.v, tau);
  const Force& dhg = computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, a);
  const Eigen::Vector3d weight = data.mass[0] * model.gravity.linear();
  EXPECT_LE((dhg.linear() - weight).norm(), 1e-10 * weight.norm());
  EXPECT_LE(dhg.angular().norm(), 1e-10 * weight.norm());
}

}  // namespace
}  // namespace rbd
