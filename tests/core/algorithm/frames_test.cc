// Every claim of docs/frames.md, by finite differences: what the three references mean for velocities,
// Jacobians, accelerations and forces. The page names the test of each claim.
//
// Central differences of step h are wrong by about h^2 (motions of order one to ten, on robots of a few
// metres) and eps / h: with h = 1e-5 first derivatives are good to kRate, second ones (h = 1e-4) to kSecond.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/algorithm/random_tree.h"

namespace rbd {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::times;

constexpr ReferenceFrame kReferences[] = {WORLD, LOCAL, LOCAL_WORLD_ALIGNED};
constexpr double kStep = 1e-5, kRate = 1e-6, kSecond = 2e-5;

// A random robot that moves along q(t), v(t) with constant joint accelerations, and one frame of it, far out.
class Frames : public ::testing::TestWithParam<int> {
 protected:
  unsigned seed = static_cast<unsigned>(GetParam());
  Model model = testing::randomTree(seed, 4 + GetParam(), GetParam() % 2 == 0);
  testing::State s = testing::randomState(model, seed);
  Data data{model}, other{model};
  FrameIndex frame = model.nframes - 1;

  void SetUp() override { forwardKinematics(model, data, s.q, s.v, s.a); }
  SE3 pose() const { return data.oMf[frame]; }
  Motion velocity(ReferenceFrame reference) const { return getFrameVelocity(model, data, frame, reference); }
  VectorXd qAt(double t) const { return integrate(model, s.q, t * s.v + 0.5 * t * t * s.a); }
  SE3 poseAt(double t) {
    forwardKinematics(model, other, qAt(t));
    return other.oMf[frame];
  }
  Motion velocityAt(double t, ReferenceFrame reference) {
    forwardKinematics(model, other, qAt(t), s.v + t * s.a);
    return getFrameVelocity(model, other, frame, reference);
  }
  // The plain rate of six numbers.
  Motion rateOfVelocity(ReferenceFrame reference) {
    return (velocityAt(kStep, reference) - velocityAt(-kStep, reference)) * (0.5 / kStep);
  }
  Motion spatial(ReferenceFrame reference) const {
    return getFrameAcceleration(model, data, frame, reference);
  }
  Motion classical(ReferenceFrame reference) const {
    return getFrameClassicalAcceleration(model, data, frame, reference);
  }
  // How the position of a point that is fixed in the body (coordinates in the frame) changes.
  Vector3d rateOfPoint(const Vector3d& in_frame) {
    return (poseAt(kStep).act(in_frame) - poseAt(-kStep).act(in_frame)) / (2 * kStep);
  }
  Vector3d secondRateOfPoint(const Vector3d& in_frame) {
    const double h = 1e-4;
    return (poseAt(h).act(in_frame) - 2 * poseAt(0).act(in_frame) + poseAt(-h).act(in_frame)) / (h * h);
  }
};

// velocities

TEST_P(Frames, AlignedLinearIsTheVelocityOfTheOrigin) {
  const Vector3d rate = rateOfPoint(Vector3d::Zero());
  EXPECT_LE((velocity(LOCAL_WORLD_ALIGNED).linear() - rate).norm(), kRate);
  EXPECT_LE((pose().rotation() * velocity(LOCAL).linear() - rate).norm(), kRate);
}

TEST_P(Frames, WorldLinearIsTheVelocityOfTheBodyPointAtTheWorldsOrigin) {
  const Vector3d point_there = pose().inverse().act(Vector3d::Zero());
  EXPECT_LE((velocity(WORLD).linear() - rateOfPoint(point_there)).norm(), 10 * kRate);
}

TEST_P(Frames, AngularIsTheRateOfTheRotation) {
  const Eigen::Matrix3d rate = (poseAt(kStep).rotation() - poseAt(-kStep).rotation()) / (2 * kStep);
  const Vector3d w = unSkew(times(rate, pose().rotation().transpose()));  // R' R^T
  EXPECT_LE((velocity(WORLD).angular() - w).norm(), kRate);
  EXPECT_LE((velocity(LOCAL_WORLD_ALIGNED).angular() - w).norm(), kRate);
  const Vector3d body = unSkew(times(pose().rotation().transpose(), rate));  // R^T R'
  EXPECT_LE((velocity(LOCAL).angular() - body).norm(), kRate);
}

TEST_P(Frames, OneRigidBodyHasOneWorldVelocity) {
  // two frames on one body, far from each other
  const Frame& f = model.frames[frame];
  const SE3 elsewhere = f.placement * SE3(exp3(Vector3d(1, -2, 0.5)), Vector3d(0.7, -0.4, 2));
  const FrameIndex second = model.addFrame(Frame("elsewhere", f.parentJoint, elsewhere, OP_FRAME));
  Data fresh(model);
  forwardKinematics(model, fresh, s.q, s.v);
  const auto at = [&](FrameIndex i, ReferenceFrame reference) {
    return getFrameVelocity(model, fresh, i, reference);
  };
  const double tol = 1e-12;  // rounding: numbers of order 10
  EXPECT_TRUE(at(second, WORLD).isApprox(at(frame, WORLD), tol));
  EXPECT_FALSE(at(second, LOCAL).isApprox(at(frame, LOCAL), 1e-3));
  EXPECT_FALSE(at(second, LOCAL_WORLD_ALIGNED).isApprox(at(frame, LOCAL_WORLD_ALIGNED), 1e-3));
}

TEST_P(Frames, VelocitiesChangeReferenceThroughThePose) {
  EXPECT_TRUE(velocity(WORLD).isApprox(pose().act(velocity(LOCAL)), 1e-12));
  const SE3 turned(pose().rotation(), Vector3d::Zero()),
      shifted(Eigen::Matrix3d::Identity(), pose().translation());
  EXPECT_TRUE(velocity(LOCAL_WORLD_ALIGNED).isApprox(turned.act(velocity(LOCAL)), 1e-12));
  EXPECT_TRUE(velocity(WORLD).isApprox(shifted.act(velocity(LOCAL_WORLD_ALIGNED)), 1e-12));
}

TEST_P(Frames, RelativeVelocityIsADifferenceInWorld) {
  const FrameIndex base = model.getFrameId(model.names[1]);
  const auto relative = [&](double t) {
    forwardKinematics(model, other, qAt(t));
    return other.oMf[base].actInv(other.oMf[frame]);
  };
  const Motion rate = log6(relative(-kStep).actInv(relative(kStep))) * (0.5 / kStep);  // LOCAL to the frame
  const Motion difference = velocity(WORLD) - getFrameVelocity(model, data, base, WORLD);
  EXPECT_TRUE(pose().actInv(difference).isApprox(rate, kRate));
}

// Jacobians

TEST_P(Frames, SmallStepsOfTheJointsMoveTheFrameByItsJacobians) {
  const double h = 1e-7;  // first order: the rest is of order h^2 times accelerations (up to 100)
  const VectorXd step = h * s.v;
  forwardKinematics(model, other, integrate(model, s.q, step));
  const SE3 after = other.oMf[frame];
  computeJointJacobians(model, data, s.q);
  const auto moved = [&](ReferenceFrame reference) {
    return Motion(Vector6d(times(getFrameJacobian(model, data, frame, reference), step)));
  };
  const double tol = 1e-11;
  EXPECT_TRUE(after.isApprox(pose() * exp6(moved(LOCAL)), tol));
  EXPECT_TRUE(after.isApprox(exp6(moved(WORLD)) * pose(), tol));
  const Motion aligned = moved(LOCAL_WORLD_ALIGNED);
  EXPECT_TRUE(after.isApprox(
      SE3(times(exp3(aligned.angular()), pose().rotation()), pose().translation() + aligned.linear()), tol));
}

// A pose error log6(pose^-1 target) is LOCAL. With the LOCAL Jacobian Newton's steps converge; with another
// reference they do not, unless the frame happens to stand like the world.
TEST_P(Frames, APoseErrorGoesWithTheLocalJacobian) {
  if (model.nv < 6) return;
  const auto after_one_step = [&](ReferenceFrame reference, double size) {
    const VectorXd away = size * s.v;
    forwardKinematics(model, other, integrate(model, s.q, away));
    const Motion error = log6(pose().actInv(other.oMf[frame]));
    computeJointJacobians(model, data, s.q);
    const Eigen::MatrixXd J = getFrameJacobian(model, data, frame, reference);
    return (error.toVector() - times(J, away)).norm() / size;
  };
  // what is left of the error after the step that made it, relative: vanishes with the step, or does not
  EXPECT_LE(after_one_step(LOCAL, 1e-6), 1e-4);
  EXPECT_GE(after_one_step(WORLD, 1e-6), 1e-3);
  EXPECT_GE(after_one_step(LOCAL_WORLD_ALIGNED, 1e-6), 1e-3);
}

// accelerations

TEST_P(Frames, SpatialAccelerationIsThePlainRateOfLocalAndOfWorldVelocity) {
  EXPECT_TRUE(rateOfVelocity(LOCAL).isApprox(spatial(LOCAL), 1e-4));
  EXPECT_TRUE(rateOfVelocity(WORLD).isApprox(spatial(WORLD), 1e-3));
  // it changes reference like a velocity
  const SE3 turned(pose().rotation(), Vector3d::Zero());
  EXPECT_TRUE(spatial(WORLD).isApprox(pose().act(spatial(LOCAL)), 1e-11));
  EXPECT_TRUE(spatial(LOCAL_WORLD_ALIGNED).isApprox(turned.act(spatial(LOCAL)), 1e-11));
}

TEST_P(Frames, ClassicalAccelerationIsThePlainRateOfAlignedVelocity) {
  const Vector3d second = secondRateOfPoint(Vector3d::Zero());
  const double tol = kSecond * std::max(1.0, second.norm());
  EXPECT_LE((classical(LOCAL_WORLD_ALIGNED).linear() - second).norm(), tol);
  EXPECT_LE((pose().rotation() * classical(LOCAL).linear() - second).norm(), tol);
  EXPECT_TRUE(rateOfVelocity(LOCAL_WORLD_ALIGNED).isApprox(classical(LOCAL_WORLD_ALIGNED), 1e-4));
}

TEST_P(Frames, SpatialAndClassicalDifferByOmegaCrossV) {
  for (const ReferenceFrame reference : {LOCAL, LOCAL_WORLD_ALIGNED}) {
    const Motion v = velocity(reference);
    const Motion more(Vector3d::Zero(), v.angular().cross(v.linear()));
    EXPECT_TRUE(classical(reference).isApprox(spatial(reference) + more, 1e-11));
  }
}

TEST_P(Frames, JacobianRatesAreThoseOfTheirNumbers) {
  computeJointJacobiansTimeVariation(model, data, s.q, s.v);
  forwardKinematics(model, data, s.q, s.v, s.a);
  const auto at = [&](double t, ReferenceFrame reference) -> Eigen::MatrixXd {
    return computeFrameJacobian(model, other, integrate(model, s.q, t * s.v), frame, reference);
  };
  for (const ReferenceFrame reference : kReferences) {
    const Eigen::MatrixXd dJ = getFrameJacobianTimeVariation(model, data, frame, reference);
    const Eigen::MatrixXd rate = (at(kStep, reference) - at(-kStep, reference)) / (2 * kStep);
    EXPECT_LE(testing::distance(dJ, rate), 10 * kRate) << reference;
    // J a + dJ v: the spatial acceleration, but in LOCAL_WORLD_ALIGNED the classical one
    const Eigen::MatrixXd J = getFrameJacobian(model, data, frame, reference);
    const Motion wanted = reference == LOCAL_WORLD_ALIGNED ? classical(reference) : spatial(reference);
    EXPECT_LE(testing::distance(times(J, s.a) + times(dJ, s.v), wanted.toVector()), 1e-11) << reference;
  }
}

// forces

TEST_P(Frames, PowerIsTheSameInEveryReference) {
  const Force local = testing::Random(seed).force();
  const SE3 turned(pose().rotation(), Vector3d::Zero());
  const double power = velocity(LOCAL).dot(local);
  EXPECT_NEAR(velocity(WORLD).dot(pose().act(local)), power, 1e-11);
  EXPECT_NEAR(velocity(LOCAL_WORLD_ALIGNED).dot(turned.act(local)), power, 1e-11);
}

// A push at the frame's origin does work along the way of that origin; its efforts are J' f in
// LOCAL_WORLD_ALIGNED.
TEST_P(Frames, APushAtAPointWorksAlongItsWay) {
  const Vector3d push = testing::Random(seed).vec3(10);
  const FrameWrenches wrenches = {{frame, Force(Vector3d::Zero(), push), LOCAL_WORLD_ALIGNED}};
  const VectorXd zero = VectorXd::Zero(model.nv);
  const VectorXd efforts = rnea(model, data, s.q, zero, zero) - rnea(model, other, s.q, zero, zero, wrenches);
  for (int k = 0; k < model.nv; ++k) {
    const auto at = [&](double t) -> Vector3d {
      forwardKinematics(model, other, integrate(model, s.q, t * VectorXd::Unit(model.nv, k)));
      return other.oMf[frame].translation();
    };
    EXPECT_NEAR(efforts[k], push.dot(at(kStep) - at(-kStep)) / (2 * kStep), 100 * kRate) << k;
  }
}

TEST_P(Frames, OneWrenchWrittenThreeWaysGivesTheSameEfforts) {
  const Force local = testing::Random(seed).force();
  const SE3 turned(pose().rotation(), Vector3d::Zero());
  const FrameWrench ways[] = {{frame, local, LOCAL},
                              {frame, turned.act(local), LOCAL_WORLD_ALIGNED},
                              {frame, pose().act(local), WORLD}};
  computeJointJacobians(model, data, s.q);
  const VectorXd free = computeStaticTorque(model, data, s.q, {});
  for (const FrameWrench& way : ways) {
    const Eigen::MatrixXd J = getFrameJacobian(model, data, frame, way.reference);
    const VectorXd efforts = free - computeStaticTorque(model, data, s.q, {way});
    EXPECT_LE(testing::distance(efforts, times(J.transpose(), way.wrench.toVector())), 1e-11);
  }
}

// The numbers of a wrench kept while the robot moves: its efforts change with J alone, as the reference says.
TEST_P(Frames, WhatStaysOfAWrenchWhenTheRobotMoves) {
  for (const ReferenceFrame reference : kReferences) {
    const FrameWrenches wrenches = {{frame, testing::Random(seed).force(), reference}};
    const Eigen::MatrixXd slope = computeStaticTorqueDerivatives(model, data, s.q, wrenches);
    const VectorXd ahead = computeStaticTorque(model, other, integrate(model, s.q, kStep * s.v), wrenches);
    const VectorXd behind = computeStaticTorque(model, other, integrate(model, s.q, -kStep * s.v), wrenches);
    EXPECT_LE(testing::distance(times(slope, s.v), (ahead - behind) / (2 * kStep)), 10 * kRate) << reference;
  }
}

TEST_P(Frames, MomentaAddInWorld) {
  Force sum;
  for (JointIndex i = 1; i < model.njoints; ++i) sum += data.oMi[i].act(model.inertias[i] * data.v[i]);
  const auto moment = [&](double t) -> Vector3d {  // total mass times the centre of mass
    const Vector3d com = centerOfMass(model, other, qAt(t));
    return other.mass[0] * com;
  };
  const Vector3d rate = (moment(kStep) - moment(-kStep)) / (2 * kStep);
  EXPECT_LE((sum.linear() - rate).norm(), 100 * kRate);
  const Vector3d com = centerOfMass(model, data, s.q);
  const Force& hg = computeCentroidalMomentum(model, data, s.q, s.v);
  const SE3 shifted(Eigen::Matrix3d::Identity(), com);
  EXPECT_TRUE(shifted.actInv(sum).isApprox(hg, 1e-11));
}

INSTANTIATE_TEST_SUITE_P(Random, Frames, ::testing::Range(0, 6));

// The page's two pictures with numbers: a turntable about z, a seat at distance r, turning evenly.
class Turntable : public ::testing::Test {
 protected:
  Turntable() {
    model.addJoint(0, JointModelRZ(), SE3(), "turntable");
    model.addFrame(Frame("seat", 1, SE3(Eigen::Matrix3d::Identity(), Vector3d(r, 0, 0)), OP_FRAME));
  }
  double r = 2, w = 3, angle = 0.6;
  Model model;
};

TEST_F(Turntable, ThreeVelocitiesOfOneSeat) {
  Data data(model);
  forwardKinematics(model, data, VectorXd::Constant(1, angle), VectorXd::Constant(1, w));
  const FrameIndex seat = model.frameId("seat");
  const auto linear = [&](ReferenceFrame reference) -> Vector3d {
    return getFrameVelocity(model, data, seat, reference).linear();
  };
  const double tol = 1e-14;
  EXPECT_LE(linear(WORLD).norm(), tol);  // the point of the table on the axis stands still
  EXPECT_LE((linear(LOCAL) - Vector3d(0, r * w, 0)).norm(), tol);
  EXPECT_LE((linear(LOCAL_WORLD_ALIGNED) - r * w * Vector3d(-std::sin(angle), std::cos(angle), 0)).norm(),
            tol);
}

TEST_F(Turntable, NoSpatialAccelerationThoughEverybodyFeelsOne) {
  Data data(model);
  forwardKinematics(model, data, VectorXd::Constant(1, angle), VectorXd::Constant(1, w), VectorXd::Zero(1));
  const FrameIndex seat = model.frameId("seat");
  EXPECT_LE(getFrameAcceleration(model, data, seat, LOCAL).toVector().norm(), 1e-13);
  const Vector3d towards_the_axis(-r * w * w, 0, 0);
  EXPECT_LE((getFrameClassicalAcceleration(model, data, seat, LOCAL).linear() - towards_the_axis).norm(),
            1e-13);
}

// What it reads: the LOCAL classical acceleration of its place, less gravity in its axes.
TEST(FreeFall, AnAccelerometerInFreeFallReadsNothing) {
  Model model;
  model.addJoint(0, JointModelFreeFlyer(), SE3(), "stone");
  const Vector3d com(0.3, -0.2, 0.1);
  model.appendBodyToJoint(1, Inertia(2, com, Vector3d(0.1, 0.2, 0.25).asDiagonal()));
  const SE3 placement(exp3(Vector3d(0.5, 1, -0.3)), com);
  const FrameIndex sensor = model.addFrame(Frame("accelerometer", 1, placement, SENSOR));
  Data data(model);
  const testing::State s = testing::randomState(model, 1);
  const VectorXd a = aba(model, data, s.q, s.v, VectorXd::Zero(6));
  forwardKinematics(model, data, s.q, s.v, a);
  const Vector3d gravity = data.oMf[sensor].rotation().transpose() * model.gravity.linear();
  const Vector3d reads = getFrameClassicalAcceleration(model, data, sensor, LOCAL).linear() - gravity;
  EXPECT_LE(reads.norm(), 1e-13);
  // the spatial one would not do: the stone spins and moves
  EXPECT_GT((getFrameAcceleration(model, data, sensor, LOCAL).linear() - gravity).norm(), 0.1);
}

// The same table a kilometre away: what WORLD says of the linear velocity changes by w times the distance.
TEST_F(Turntable, WorldVelocityDependsOnWhereTheWorldsOriginIs) {
  Model far = model;
  far.setJointPlacement(1, SE3(Eigen::Matrix3d::Identity(), Vector3d(1000, 0, 0)));
  Data here(model), there(far);
  for (auto [m, d] : {std::pair(&model, &here), std::pair(&far, &there)}) {
    forwardKinematics(*m, *d, VectorXd::Constant(1, angle), VectorXd::Constant(1, w));
  }
  const FrameIndex seat = model.frameId("seat");
  for (const ReferenceFrame reference : {LOCAL, LOCAL_WORLD_ALIGNED}) {
    EXPECT_TRUE(getFrameVelocity(far, there, seat, reference)
                    .isApprox(getFrameVelocity(model, here, seat, reference), 1e-11));
  }
  EXPECT_NEAR(getFrameVelocity(far, there, seat, WORLD).linear().y(), -1000 * w, 1e-9);
}

}  // namespace
}  // namespace rbd
