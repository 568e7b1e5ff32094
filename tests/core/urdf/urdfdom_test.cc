// What is read from a file, against urdfdom's reading of the same file: every number equal to the last bit.
#include <gtest/gtest.h>
#include <rbd/urdf/check_tree.h>
#include <rbd/urdf/read_elements.h>
#include <rbd/urdf/rpy.h>
#include <rbd/urdf/urdf.h>
#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/core/urdf/corpus.h"

namespace rbd::urdf {
namespace {

using Peer = ::urdf::ModelInterfaceSharedPtr;

// Null if urdfdom refuses the text or finds anything to say about it.
Peer parse_with_urdfdom(const std::string& text) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Peer model;
  try {
    model = ::urdf::parseURDF(text);
  } catch (const std::exception&) {
  }
  const bool silent =
      (testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr()).empty();
  return silent ? model : nullptr;
}

void expect_vector(const Eigen::Vector3d& ours, const ::urdf::Vector3& theirs) {
  EXPECT_EQ(ours, Eigen::Vector3d(theirs.x, theirs.y, theirs.z));
}

void expect_origin(const Origin& ours, const ::urdf::Pose& theirs) {
  expect_vector(ours.xyz, theirs.position);
  const ::urdf::Rotation& r = theirs.rotation;
  EXPECT_EQ(rpy_to_quaternion(ours.rpy).coeffs(), Eigen::Vector4d(r.x, r.y, r.z, r.w))
      << ours.rpy.transpose();
}

void expect_link(const Link& ours, const ::urdf::Link& theirs) {
  ASSERT_EQ(ours.inertial.has_value(), theirs.inertial != nullptr);
  if (!ours.inertial) return;
  const ::urdf::Inertial& body = *theirs.inertial;
  expect_origin(ours.inertial->origin, body.origin);
  EXPECT_EQ(ours.inertial->mass, body.mass);
  Eigen::Matrix3d tensor;
  tensor << body.ixx, body.ixy, body.ixz, body.ixy, body.iyy, body.iyz, body.ixz, body.iyz, body.izz;
  EXPECT_EQ(ours.inertial->tensor, tensor);
}

void expect_joint(const Joint& ours, const ::urdf::Joint& theirs) {
  const std::map<JointType, int> types = {
      {JointType::Fixed, ::urdf::Joint::FIXED},           {JointType::Revolute, ::urdf::Joint::REVOLUTE},
      {JointType::Continuous, ::urdf::Joint::CONTINUOUS}, {JointType::Prismatic, ::urdf::Joint::PRISMATIC},
      {JointType::Planar, ::urdf::Joint::PLANAR},         {JointType::Floating, ::urdf::Joint::FLOATING}};
  EXPECT_EQ(types.at(ours.type), theirs.type);
  EXPECT_EQ(ours.parent.link, theirs.parent_link_name);
  EXPECT_EQ(ours.child.link, theirs.child_link_name);
  expect_origin(ours.origin, theirs.parent_to_joint_origin_transform);
  if (ours.type == JointType::Fixed) return;  // has nothing else
  if (ours.type != JointType::Floating) expect_vector(ours.axis, theirs.axis);

  ASSERT_EQ(ours.limit.has_value(), theirs.limits != nullptr);
  if (ours.limit) {
    EXPECT_EQ(ours.limit->lower, theirs.limits->lower);
    EXPECT_EQ(ours.limit->upper, theirs.limits->upper);
    EXPECT_EQ(ours.limit->effort, theirs.limits->effort);
    EXPECT_EQ(ours.limit->velocity, theirs.limits->velocity);
  }
  EXPECT_EQ(ours.damping, theirs.dynamics ? theirs.dynamics->damping : 0);
  EXPECT_EQ(ours.friction, theirs.dynamics ? theirs.dynamics->friction : 0);
  ASSERT_EQ(ours.mimic.has_value(), theirs.mimic != nullptr);
  if (ours.mimic) {
    EXPECT_EQ(ours.mimic->leader, theirs.mimic->joint_name);
    EXPECT_EQ(ours.mimic->multiplier, theirs.mimic->multiplier);
    EXPECT_EQ(ours.mimic->offset, theirs.mimic->offset);
  }
}

// False if one of the two does not read the text.
bool compare(const std::string& text) {
  if (!loadXML(text).ok()) return false;
  const Peer theirs = parse_with_urdfdom(text);
  if (!theirs) return false;
  tinyxml2::XMLDocument document;
  Report report("");
  const Description ours = read_elements(*parse_robot(text, document, report), report);
  EXPECT_EQ(ours.name, theirs->getName());
  EXPECT_EQ(check_tree(ours, report), theirs->getRoot()->name);
  EXPECT_EQ(ours.links.size(), theirs->links_.size());
  EXPECT_EQ(ours.joints.size(), theirs->joints_.size());
  for (const auto& [name, link] : ours.links) expect_link(link, *theirs->getLink(name));
  for (const auto& [name, joint] : ours.joints) expect_joint(joint, *theirs->getJoint(name));
  return true;
}

TEST(UrdfReading, TheLabsRobotsAreReadAsUrdfdomReadsThem) {
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MODEL_DIR)) {
    if (entry.path().extension() != ".urdf") continue;
    SCOPED_TRACE(entry.path());
    std::ifstream in(entry.path());
    EXPECT_TRUE(compare(std::string(std::istreambuf_iterator<char>(in), {})));
    ++compared;
  }
  EXPECT_GE(compared, 1);
}

TEST(UrdfReading, WhatBothAcceptOfTheCorpusIsTheSame) {
  int compared = 0;
  for (const CorpusCase& c : read_corpus(CORPUS)) {
    SCOPED_TRACE(c.name);
    compared += compare(c.text);
  }
  EXPECT_GE(compared, 50);
}

// Angles of every size, with all their digits.
TEST(UrdfReading, AnglesBecomeTheSameQuaternions) {
  std::mt19937_64 random(20261129);
  std::uniform_real_distribution<double> exponent(-8, 1), sign(-1, 1);
  std::string text = "<robot name='r'><link name='l0'/>";
  char part[400];
  for (int i = 0; i < 1000; ++i) {
    double a[3];
    for (double& x : a) x = std::copysign(std::pow(10, exponent(random)), sign(random));
    std::snprintf(part, sizeof part,
                  "<link name='l%d'/><joint name='j%d' type='fixed'><parent link='l%d'/><child link='l%d'/>"
                  "<origin rpy='%.17g %.17g %.17g'/></joint>",
                  i + 1, i, i, i + 1, a[0], a[1], a[2]);
    text += part;
  }
  EXPECT_TRUE(compare(text + "</robot>"));
}

}  // namespace
}  // namespace rbd::urdf
