#include "rbd/spatial/inertia.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::kEps;
using testing::Random;

TEST(Inertia, TextbookBodies) {
  const Inertia box = Inertia::FromBox(12, 1, 2, 3);
  EXPECT_LE((box.inertia().diagonal() - Eigen::Vector3d(13, 10, 5)).norm(), 32 * kEps);
  EXPECT_NEAR(Inertia::FromSphere(5, 2).inertia()(1, 1), 8, 8 * kEps);
  const Inertia rod = Inertia::FromCylinder(3, 0, 2);
  EXPECT_NEAR(rod.inertia()(0, 0), 1, 4 * kEps);  // m l^2 / 12
  EXPECT_EQ(rod.inertia()(2, 2), 0);
}

// A second road: the body as a cloud of mass points, momentum summed point by point.
TEST(Inertia, MomentumAndSumAgreeWithMassPoints) {
  Random random(1);
  Inertia sum;
  Force momentum;
  const Motion v = random.motion();
  for (int k = 0; k < 20; ++k) {
    const double m = random.in(0.1, 1);
    const Eigen::Vector3d p = random.vec3();
    sum += Inertia(m, p, Eigen::Matrix3d::Zero());
    const Eigen::Vector3d f = m * (v.linear() + v.angular().cross(p));
    momentum += Force(p.cross(f), f);
  }
  const double tol = 1e3 * kEps;  // 20 terms of size 10
  EXPECT_TRUE((sum * v).isApprox(momentum, tol));
  EXPECT_LE((sum.matrix() * v.toVector() - momentum.toVector()).norm(), tol);
  EXPECT_NEAR(sum.vtiv(v), v.dot(momentum), tol);
  EXPECT_EQ(sum.problem(), "");
}

TEST(Inertia, ProblemsAreNamed) {
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  EXPECT_NE(Inertia(0, zero, one).problem().find("mass"), std::string::npos);
  EXPECT_NE(Inertia(-1, zero, one).problem().find("-1"), std::string::npos);
  EXPECT_NE(Inertia(1, zero, -one).problem().find("positive definite"), std::string::npos);
  const Eigen::Matrix3d flat = Eigen::Vector3d(1, 1, 3).asDiagonal();
  EXPECT_NE(Inertia(1, zero, flat).problem().find("triangle"), std::string::npos);
  EXPECT_THROW(Inertia(std::nan(""), zero, one), std::invalid_argument);
  Eigen::Matrix3d skewed = one;
  skewed(0, 1) = 0.1;
  EXPECT_THROW(Inertia(1, zero, skewed), std::invalid_argument);
}

}  // namespace
}  // namespace rbd
