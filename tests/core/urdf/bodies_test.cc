// Masses and inertias: welding, placements, and what is accepted of odd ones.
#include <gtest/gtest.h>
#include <rbd/algorithm/data.h>
#include <rbd/algorithm/kinematics.h>
#include <rbd/algorithm/rnea.h>
#include <rbd/urdf/urdf.h>

#include <Eigen/Geometry>
#include <sstream>

#include "tests/support/paths.h"

namespace rbd::urdf {
namespace {

Loaded robot(const std::string& inside, const Options& options = {}) {
  return loadXML("<robot name='r'>\n" + inside + "</robot>", options);
}

struct Body {
  double mass;
  Eigen::Vector3d com, moments;  // principal moments along the axes of the inertial frame
  Eigen::Vector3d rpy;           // of the inertial frame
};

std::string text(const Eigen::Vector3d& v) {
  std::ostringstream out;
  out.precision(17);
  out << v[0] << " " << v[1] << " " << v[2];
  return out.str();
}

std::string link(const std::string& name, const Body& b) {
  std::ostringstream out;
  out.precision(17);
  out << "<link name='" << name << "'><inertial><origin xyz='" << text(b.com) << "' rpy='" << text(b.rpy)
      << "'/><mass value='" << b.mass << "'/><inertia ixx='" << b.moments[0] << "' ixy='0' ixz='0' iyy='"
      << b.moments[1] << "' iyz='0' izz='" << b.moments[2] << "'/></inertial></link>\n";
  return out.str();
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy,
                  const Eigen::Vector3d& axis = {0, 1, 0}) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
         child + "'/><origin xyz='" + text(xyz) + "' rpy='" + text(rpy) + "'/><axis xyz='" + text(axis) +
         "'/></joint>\n";
}

Eigen::Matrix3d turn(const Eigen::Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

// Six point masses on the principal axes that have together the mass, centre and moments of `b`: the second
// road. Moments along an axis come from the other two; each pair at +-d adds 2 (m/6) d^2 to both others.
struct Point {
  double mass;
  Eigen::Vector3d at;
};
std::vector<Point> points_of(const Body& b, const SE3& link_pose) {
  std::vector<Point> out;
  const double sum = b.moments.sum() / 2;  // integral of r^2
  for (int k = 0; k < 3; ++k) {
    const double d = std::sqrt(3 / b.mass * (sum - b.moments[k]));
    for (double sign : {-1.0, 1.0}) {
      const Eigen::Vector3d p = b.com + turn(b.rpy) * (sign * d * Eigen::Vector3d::Unit(k));
      out.push_back({b.mass / 6, link_pose.act(p)});
    }
  }
  return out;
}

// Three links welded together in odd poses, on one joint; and the same three as 18 point masses.
const Body kA{2.0, {0.1, -0.2, 0.3}, {0.3, 0.4, 0.5}, {0.1, 0.2, 0.3}};
const Body kB{0.7, {-0.4, 0.1, 0.0}, {0.02, 0.03, 0.04}, {-0.5, 0.0, 1.0}};
const Body kC{1.3, {0.0, 0.0, 0.25}, {0.1, 0.1, 0.15}, {0.0, 1.2, 0.0}};
const Eigen::Vector3d kJointAt(0.3, 0.2, 0.1), kJointRpy(0.4, -0.3, 0.2), kAxis(0.6, 0.0, -0.8);
const Eigen::Vector3d kBAt(0.5, 0.0, -0.1), kBRpy(0.0, 0.7, 0.0), kCAt(0.0, -0.3, 0.2), kCRpy(1.0, 0.0, -0.6);

Loaded welded() {
  return robot(link("base", kA) + link("a", kA) + link("b", kB) + link("c", kC) +
               joint("j", "continuous", "base", "a", kJointAt, kJointRpy, kAxis) +
               joint("ab", "fixed", "a", "b", kBAt, kBRpy) + joint("bc", "fixed", "b", "c", kCAt, kCRpy));
}

std::vector<Point> welded_points() {
  const SE3 aMb(turn(kBRpy), kBAt), bMc(turn(kCRpy), kCAt);
  std::vector<Point> all = points_of(kA, SE3::Identity());
  for (const Point& p : points_of(kB, aMb)) all.push_back(p);
  for (const Point& p : points_of(kC, aMb * bMc)) all.push_back(p);
  return all;
}

TEST(UrdfBodies, FixedJointsAreWelded) {
  const Loaded loaded = welded();
  ASSERT_TRUE(loaded.ok());
  const Model& model = loaded.model;
  ASSERT_EQ(model.njoints, 2);

  double mass = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  Eigen::Matrix3d about_origin = Eigen::Matrix3d::Zero();
  for (const Point& p : welded_points()) {
    mass += p.mass;
    moment += p.mass * p.at;
    about_origin += p.mass * (p.at.squaredNorm() * Eigen::Matrix3d::Identity() - p.at * p.at.transpose());
  }
  const Inertia& body = model.inertias[1];
  EXPECT_NEAR(body.mass(), 4.0, 1e-15);
  EXPECT_NEAR(mass, 4.0, 1e-15);
  EXPECT_TRUE(body.lever().isApprox(moment / mass, 1e-14));
  const Eigen::Matrix3d block = body.matrix().topLeftCorner<3, 3>();
  EXPECT_TRUE(block.isApprox(about_origin, 1e-14)) << block << "\n" << about_origin;

  // the frames that remain
  const SE3 aMb(turn(kBRpy), kBAt), bMc(turn(kCRpy), kCAt);
  const Frame& ab = model.frames[model.getFrameId("ab")];
  const Frame& c = model.frames[model.getFrameId("c")];
  EXPECT_EQ(ab.type, FIXED_JOINT);
  EXPECT_EQ(ab.parentJoint, 1);
  EXPECT_TRUE(ab.placement.isApprox(aMb, 1e-15));
  EXPECT_EQ(c.type, BODY);
  EXPECT_EQ(model.frames[c.parentFrame].name, "bc");
  EXPECT_TRUE(c.placement.isApprox(aMb * bMc, 1e-15));
}

// Gravity torque of the welded robot = slope of the potential energy of its 18 point masses, by central
// differences: step 1e-5, third derivative of the order of m g r = 40: error 40 h^2 / 6 < 1e-9, rounding
// 40 eps / h < 1e-9.
TEST(UrdfBodies, GravityTorqueOfTheWeldedRobot) {
  const Model model = welded().model;
  Data data(model);
  const auto energy = [&](double angle) {
    const SE3 moved = SE3(turn(kJointRpy), kJointAt) *
                      SE3(Eigen::AngleAxisd(angle, kAxis).toRotationMatrix(), Eigen::Vector3d::Zero());
    double sum = 0;
    for (const Point& p : welded_points()) sum += p.mass * 9.81 * moved.act(p.at)[2];
    return sum;
  };
  for (double angle : {-2.0, 0.0, 0.7, 3.0}) {
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, angle), zero = Eigen::VectorXd::Zero(1);
    const double slope = (energy(angle + 1e-5) - energy(angle - 1e-5)) / 2e-5;
    EXPECT_NEAR(rnea(model, data, q, zero, zero)[0], slope, 4e-9);
  }
}

// The sample arm stretched out level: each joint carries mass times lever, as in a textbook.
TEST(UrdfBodies, SampleArmHeldLevel) {
  Model model;
  buildModel(lab::source_path("models/simple_3dof_arm.urdf"), model);
  Data data(model);
  const Eigen::Vector3d level(0.3, M_PI / 2, 0), zero = Eigen::Vector3d::Zero();
  const Eigen::VectorXd tau = rnea(model, data, level, zero, zero);
  EXPECT_NEAR(tau[0], 0, 1e-12);                                       // about the vertical
  EXPECT_NEAR(std::abs(tau[1]), 9.81 * (3 * 0.2 + 0.5 * 0.4), 1e-12);  // forearm at 0.2 m, tip at 0.4 m
  EXPECT_NEAR(tau[2], 0, 1e-12);                                       // the ball turns about its centre
}

// A quarter turn of the inertial frame about z swaps Ixx and Iyy; its place moves the centre only.
TEST(UrdfBodies, InertialOriginTurnsTheTensor) {
  const Body body{2, {1, 2, 3}, {1, 2, 2.5}, {0, 0, M_PI / 2}};
  const Loaded loaded =
      robot(link("a", kA) + link("b", body) + joint("j", "continuous", "a", "b", {0, 0, 0}, {0, 0, 0}));
  const Inertia& i = loaded.model.inertias[1];
  EXPECT_TRUE(i.lever().isApprox(Eigen::Vector3d(1, 2, 3), 1e-15));
  EXPECT_TRUE(i.inertia().isApprox(Eigen::Matrix3d(Eigen::Vector3d(2, 1, 2.5).asDiagonal()), 1e-15));
}

// What is welded to the ground belongs to the universe; with a floating base it flies.
TEST(UrdfBodies, WhatStandsOnTheGround) {
  const std::string inside = link("a", kA) + link("b", kB) + joint("f", "fixed", "a", "b", kBAt, kBRpy);
  const Loaded ground = robot(inside);
  EXPECT_EQ(ground.model.nv, 0);
  EXPECT_NEAR(ground.model.inertias[0].mass(), kA.mass + kB.mass, 1e-15);
  Options options;
  options.floating_base = true;
  const Loaded flying = robot(inside, options);
  EXPECT_EQ(flying.model.nv, 6);
  EXPECT_EQ(flying.model.inertias[0].mass(), 0);
  EXPECT_TRUE(flying.model.inertias[1].isApprox(ground.model.inertias[0], 1e-15));
}

// An impossible inertia is refused where it moves alone, and a warning where its body as a whole is possible or never moves.
TEST(UrdfBodies, IndefiniteInertiaIsRefusedWhereItMatters) {
  const auto bad = [](double scale) {
    std::ostringstream out;
    out << "<link name='bad'><inertial><mass value='0.01'/><inertia ixx='" << scale
        << "' ixy='0' ixz='0' iyy='" << scale << "' iyz='0' izz='" << -scale << "'/></inertial></link>\n";
    return out.str();
  };
  const auto severity = [&](double scale, const std::string& type, bool floating) {
    Options options;
    options.floating_base = floating;
    const Loaded loaded =
        robot(link("a", kA) + bad(scale) + joint("j", type, "a", "bad", {0, 0, 0}, {0, 0, 0}), options);
    EXPECT_EQ(loaded.diagnostics.size(), 1u);
    EXPECT_EQ(loaded.diagnostics.at(0).element, "link 'bad'");
    EXPECT_EQ(loaded.diagnostics.at(0).line, 3);
    EXPECT_EQ(loaded.ok(), loaded.diagnostics.at(0).severity != Severity::Error);
    return loaded.diagnostics.at(0).severity;
  };
  EXPECT_EQ(severity(1e-4, "continuous", false), Severity::Error);
  EXPECT_EQ(severity(10, "fixed", false), Severity::Warning);   // never moves
  EXPECT_EQ(severity(1e-4, "fixed", true), Severity::Warning);  // kA carries it
  EXPECT_EQ(severity(10, "fixed", true), Severity::Error);      // more than kA can carry
}

TEST(UrdfBodies, FramesWithoutMassNeedNoWarning) {
  const Loaded loaded = robot(link("a", kA) + "<link name='tool'/>\n" + link("b", kB) +
                              joint("f", "fixed", "b", "tool", {0, 0, 1}, {0, 0, 0}) +
                              joint("j", "continuous", "a", "b", {0, 0, 0}, {0, 0, 0}));
  EXPECT_TRUE(loaded.diagnostics.empty());
  EXPECT_TRUE(loaded.model.inertias[1].isApprox(
      robot(link("a", kA) + link("b", kB) + joint("j", "continuous", "a", "b", {0, 0, 0}, {0, 0, 0}))
          .model.inertias[1],
      0));
}

}  // namespace
}  // namespace rbd::urdf
