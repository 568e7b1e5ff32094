#include "rbd/algorithm/data.h"

#include <gtest/gtest.h>

#include "rbd/rbd.h"
#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

TEST(PaddedMatrix, CopiesAreDeepAndMovesKeepTheNumbers) {
  PaddedMatrix a(6, 3);
  a.setRandom();
  EXPECT_EQ(a.outerStride(), 8);
  PaddedMatrix b = a;
  EXPECT_EQ(testing::distance(b, a), 0);
  EXPECT_NE(b.data(), a.data());
  b(0, 0) += 1;
  EXPECT_NE(testing::distance(b, a), 0);
  const PaddedMatrix c = std::move(b);
  EXPECT_EQ(b.size(), 0);
  EXPECT_EQ(c(0, 0), a(0, 0) + 1);
  PaddedMatrix d(2, 2);
  d = a;
  EXPECT_EQ(testing::distance(d, a), 0);
  const Eigen::MatrixXd plain = a;
  EXPECT_EQ(plain.outerStride(), 6);
  EXPECT_EQ(testing::distance(plain, a), 0);
}

TEST(Data, SizesAndStart) {
  const Model model = testing::randomTree(5, 8, true);
  const Data data = model.createData();
  EXPECT_EQ(static_cast<int>(data.oMi.size()), model.njoints);
  EXPECT_EQ(static_cast<int>(data.oMf.size()), model.nframes);
  EXPECT_EQ(static_cast<int>(data.joints.size()), model.njoints);
  EXPECT_EQ(data.J.cols(), model.nv);
  EXPECT_EQ(data.M.rows(), model.nv);
  EXPECT_EQ(testing::distance(data.tau, Eigen::VectorXd::Zero(model.nv)), 0);
}

// A copy computes the same and does not write into the original; joints point at their own Data.
TEST(Data, CopiesAreIndependent) {
  const Model model = testing::randomTree(6, 8, true);
  const testing::State s = testing::randomState(model, 6), t = testing::randomState(model, 7);
  Data one(model);
  forwardKinematics(model, one, s.q, s.v);
  Data two = one;
  EXPECT_EQ(two.oMi[3].translation(), one.oMi[3].translation());
  forwardKinematics(model, two, t.q, t.v);
  const int iq = model.joints[2].idx_q();
  EXPECT_EQ(one.joints[2].joint_q()[0], s.q[iq]);
  EXPECT_EQ(two.joints[2].joint_q()[0], t.q[iq]);
  EXPECT_EQ(two.joints[1].joint_v().size(), 6);
  const Data three = std::move(two);
  EXPECT_EQ(three.joints[2].joint_q()[0], t.q[iq]);
  EXPECT_THROW(forwardKinematics(model, two, t.q), std::invalid_argument);  // moved from
  two = three;
  forwardKinematics(model, two, s.q, s.v);
  EXPECT_EQ(two.oMi[3].translation(), one.oMi[3].translation());
}

}  // namespace
}  // namespace rbd
