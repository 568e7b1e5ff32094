#include "rbd/spatial/so3.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::kEps;
using testing::Random;

// Every law is asked at zero, at tiny, at random and at nearly half a turn.
std::vector<Eigen::Vector3d> rotationVectors() {
  Random random(1);
  std::vector<Eigen::Vector3d> out = {Eigen::Vector3d::Zero()};
  for (const double angle :
       {1e-300, 1e-16, 1e-9, 9e-5, 1.1e-4, 1e-3, 0.0999, 0.1001, 1.0, 2.0, 3.0, 3.14, 3.1415926}) {
    for (int k = 0; k < 5; ++k) out.push_back(angle * random.vec3().normalized());
  }
  return out;
}

// The series of exp in long double: nothing in common with the closed forms.
Eigen::Matrix3d expSeries(const Eigen::Vector3d& w) {
  using Matrix = Eigen::Matrix<long double, 3, 3>;
  const Matrix W = skew(w).cast<long double>();
  Matrix sum = Matrix::Identity(), term = sum;
  for (int k = 1; k < 40; ++k) sum += term = (term * W / static_cast<long double>(k)).eval();
  return sum.cast<double>();
}

// sum W^k / (k+1)!
Eigen::Matrix3d leftJacobianSeries(const Eigen::Vector3d& w) {
  using Matrix = Eigen::Matrix<long double, 3, 3>;
  const Matrix W = skew(w).cast<long double>();
  Matrix sum = Matrix::Identity(), term = sum;
  for (int k = 1; k < 40; ++k) sum += term = (term * W / static_cast<long double>(k + 1)).eval();
  return sum.cast<double>();
}

TEST(So3, SkewIsTheCrossProduct) {
  Random random(2);
  const Eigen::Vector3d a = random.vec3(), b = random.vec3();
  EXPECT_LE((skew(a) * b - a.cross(b)).norm(), kEps);
  EXPECT_EQ(unSkew(skew(a)), a);
}

TEST(So3, ExpAgreesWithItsSeries) {
  for (const auto& w : rotationVectors()) {
    EXPECT_LE((exp3(w) - expSeries(w)).cwiseAbs().maxCoeff(), 8 * kEps) << w.transpose();
    EXPECT_LE((exp3Quaternion(w).toRotationMatrix() - expSeries(w)).cwiseAbs().maxCoeff(), 8 * kEps)
        << w.transpose();
  }
}

TEST(So3, ExpIsARotationAndExpOfMinusIsItsInverse) {
  for (const auto& w : rotationVectors()) {
    EXPECT_TRUE(isRotation(exp3(w), 16 * kEps)) << w.transpose();
    EXPECT_LE((exp3(w) * exp3(-w) - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 16 * kEps);
  }
}

TEST(So3, LogIsTheInverseOfExp) {
  for (const auto& w : rotationVectors()) {
    // relative to w: tiny rotations keep their digits through the quaternion
    EXPECT_LE((log3(exp3Quaternion(w)) - w).norm(), 8 * kEps * w.norm()) << w.transpose();
    // the matrix itself has an absolute error of eps
    EXPECT_LE((log3(exp3(w)) - w).norm(), 16 * kEps) << w.transpose();
  }
}

TEST(So3, LogAtHalfATurn) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0.6, 0, 0.8)}) {
    const Eigen::Matrix3d R = 2 * axis * axis.transpose() - Eigen::Matrix3d::Identity();
    const Eigen::Vector3d w = log3(R);
    EXPECT_NEAR(w.norm(), PI<double>(), 8 * kEps);
    EXPECT_LE(w.cross(axis).norm(), 32 * kEps);
  }
}

TEST(So3, LeftJacobianAgreesWithItsSeriesAndItsInverse) {
  for (const auto& w : rotationVectors()) {
    EXPECT_LE((leftJacobian3(w) - leftJacobianSeries(w)).cwiseAbs().maxCoeff(), 16 * kEps) << w.transpose();
    EXPECT_LE(
        (leftJacobian3(w) * leftJacobian3Inverse(w) - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
        64 * kEps)
        << w.transpose();
  }
}

TEST(So3, RollPitchYaw) {
  // URDF: about fixed x, then y, then z
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Eigen::Vector3d rpy(random.in(-3.1, 3.1), random.in(-1.5, 1.5), random.in(-3.1, 3.1));
    const Eigen::Matrix3d R = exp3({0, 0, rpy[2]}) * exp3({0, rpy[1], 0}) * exp3({rpy[0], 0, 0});
    EXPECT_LE((rpyToMatrix(rpy) - R).cwiseAbs().maxCoeff(), 8 * kEps);
    EXPECT_LE((matrixToRpy(R) - rpy).norm(), 1e3 * kEps);
  }
  // at pitch = pi/2 only yaw - roll is known; the matrix must come back
  const Eigen::Matrix3d R = rpyToMatrix(0.3, PI<double>() / 2, 0.5);
  EXPECT_LE((rpyToMatrix(matrixToRpy(R)) - R).cwiseAbs().maxCoeff(), 8 * kEps);
}

// The matrix must come back however close to the pole it stands: there roll and yaw alone are ill known.
TEST(So3, RollPitchYawNearThePole) {
  for (double gap = 1; gap > 1e-17; gap /= 3) {
    for (const double pitch : {PI<double>() / 2 - gap, gap - PI<double>() / 2}) {
      const Eigen::Matrix3d R = exp3({0, 0, 0.7}) * exp3({0, pitch, 0}) * exp3({-2.1, 0, 0});
      EXPECT_LE((rpyToMatrix(matrixToRpy(R)) - R).cwiseAbs().maxCoeff(), 16 * kEps) << gap;
    }
  }
}

TEST(So3, TurnZToEveryAxis) {
  Random random(4);
  std::vector<Eigen::Vector3d> axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  axes.push_back(Eigen::Vector3d(1e-9, 0, -1).normalized());
  for (int k = 0; k < 20; ++k) axes.push_back(random.vec3().normalized());
  for (const auto& axis : axes) {
    const Eigen::Matrix3d R = rotationWithZ(axis);
    EXPECT_TRUE(isRotation(R, 16 * kEps)) << axis.transpose();
    EXPECT_EQ(R.col(2), axis);
  }
  // exact permutations: no rounding for the common joints
  EXPECT_EQ((rotationWithZ({1, 0, 0}).array() == 0 || rotationWithZ({1, 0, 0}).array() == 1).all(), true);
  EXPECT_EQ((rotationWithZ({0, 1, 0}).array() == 0 || rotationWithZ({0, 1, 0}).array() == 1).all(), true);
}

TEST(So3, NanIsNoRotation) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R(1, 2) = std::nan("");
  EXPECT_FALSE(isRotation(R));
  EXPECT_FALSE(isRotation(-Eigen::Matrix3d::Identity()));
}

}  // namespace
}  // namespace rbd
