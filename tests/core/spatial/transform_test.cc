#include "rbd/spatial/transform.h"

#include <gtest/gtest.h>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using testing::kEps;
using testing::Random;

// Entries are of order 1 and each result is a sum of fewer than 20 products.
constexpr double kTol = 64 * kEps;

// The laws at identity, at a tiny and at random poses.
std::vector<SE3> poses() {
  Random random(1);
  std::vector<SE3> out = {SE3::Identity(), SE3(exp3({1e-9, 0, 0}), Eigen::Vector3d(0, 1e-9, 0))};
  for (int k = 0; k < 8; ++k) out.push_back(random.pose());
  return out;
}

TEST(SE3, IsAGroup) {
  const auto all = poses();
  for (const SE3& a : all) {
    EXPECT_TRUE((a * a.inverse()).isApprox(SE3::Identity(), kTol));
    EXPECT_TRUE((a * SE3::Identity()).isApprox(a, 0));
    for (const SE3& b : all) {
      EXPECT_TRUE((a.actInv(b)).isApprox(a.inverse() * b, kTol));
      EXPECT_TRUE(((a * b).inverse()).isApprox(b.inverse() * a.inverse(), kTol));
      for (const SE3& c : all) EXPECT_TRUE(((a * b) * c).isApprox(a * (b * c), kTol));
    }
  }
}

TEST(SE3, AgreesWithHomogeneousMatrices) {
  Random random(2);
  for (const SE3& a : poses()) {
    for (const SE3& b : poses()) {
      EXPECT_LE(((a * b).toHomogeneousMatrix() - a.toHomogeneousMatrix() * b.toHomogeneousMatrix())
                    .cwiseAbs()
                    .maxCoeff(),
                kTol);
    }
    const Eigen::Vector3d p = random.vec3();
    EXPECT_LE((a.act(p) - (a.toHomogeneousMatrix() * p.homogeneous()).head<3>()).norm(), kTol);
    EXPECT_LE((a.actInv(a.act(p)) - p).norm(), kTol);
    EXPECT_EQ(a.actOnEigenObject(p), a.act(p));
    EXPECT_TRUE(SE3(a.toHomogeneousMatrix()).isApprox(a, 0));
  }
}

TEST(SE3, ActsOnMotionsForcesInertias) {
  Random random(3);
  for (const SE3& a : poses()) {
    const Motion m = random.motion(), m2 = random.motion();
    const Force f = random.force();
    const Inertia inertia = random.inertia();
    // the 6x6 matrix does the same
    EXPECT_LE((a.act(m).toVector() - a.toActionMatrix() * m.toVector()).norm(), kTol);
    EXPECT_TRUE(a.actInv(a.act(m)).isApprox(m, kTol));
    EXPECT_TRUE(a.actInv(a.act(f)).isApprox(f, kTol));
    EXPECT_TRUE(a.actInv(a.act(inertia)).isApprox(inertia, kTol));
    // power and energy do not depend on the frame
    EXPECT_NEAR(a.act(m).dot(a.act(f)), m.dot(f), kTol);
    EXPECT_NEAR(a.act(inertia).vtiv(a.act(m)), inertia.vtiv(m), 16 * kTol);
    // products commute with the change of frame
    EXPECT_TRUE(a.act(m.cross(m2)).isApprox(a.act(m).cross(a.act(m2)), kTol));
    EXPECT_TRUE(a.act(m.cross(f)).isApprox(a.act(m).cross(a.act(f)), kTol));
    EXPECT_TRUE(a.act(inertia * m).isApprox(a.act(inertia) * a.act(m), 16 * kTol));
  }
}

TEST(SE3, ForceCrossIsMinusTransposeOfMotionCross) {
  Random random(4);
  const Motion v = random.motion(), m = random.motion();
  const Force f = random.force();
  EXPECT_NEAR(m.dot(v.cross(f)), -v.cross(m).dot(f), kTol);
}

TEST(SE3, ExpAndLog) {
  Random random(5);
  for (const double size : {0.0, 1e-12, 1e-5, 0.05, 1.0, 1.8}) {
    const Motion v(size * random.vec3(), random.vec3());
    EXPECT_TRUE(log6(exp6(v)).isApprox(v, 64 * kTol)) << size;
    EXPECT_TRUE((exp6(v) * exp6(-v)).isApprox(SE3::Identity(), kTol));
    // half the way twice
    EXPECT_TRUE((exp6(0.5 * v) * exp6(0.5 * v)).isApprox(exp6(v), kTol));
  }
  // a quarter turn about z at distance 1 from the axis: from the definition of a screw
  const SE3 screw =
      exp6(Motion({0, 0, PI<double>() / 2}, {0, -PI<double>() / 2, 0}));  // axis through (1, 0, 0)
  EXPECT_LE((screw.act(Eigen::Vector3d(1, 0, 0)) - Eigen::Vector3d(1, 0, 0)).norm(), kTol);
}

TEST(Spatial, AngularFirst) {
  const Motion m(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(m.toVector(), (Vector6d() << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(Motion(m.toVector()), m);
  Force f;
  EXPECT_EQ(f.toVector(), Vector6d(Vector6d::Zero()));
  f.linear(Eigen::Vector3d(0, 0, -9.8));
  EXPECT_EQ(f.linear().z(), -9.8);
  EXPECT_EQ((f + f - f).linear().z(), -9.8);
}

}  // namespace
}  // namespace rbd
