// What comes out of a sound URDF: joints, order, axes, limits, frames.
#include <gtest/gtest.h>
#include <rbd/algorithm/data.h>
#include <rbd/algorithm/kinematics.h>
#include <rbd/urdf/urdf.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <limits>
#include <locale>
#include <random>
#include <sstream>
#include <thread>

#include "tests/support/paths.h"

namespace rbd::urdf {
namespace {

const double kInf = std::numeric_limits<double>::infinity();
const std::string kArm = lab::source_path("models/simple_3dof_arm.urdf");

Eigen::VectorXd one(double x) { return Eigen::VectorXd::Constant(1, x); }
SE3 at(double x, double y, double z) { return SE3(Eigen::Matrix3d::Identity(), {x, y, z}); }

std::string link(const std::string& name) {
  return "<link name='" + name +
         "'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
         "izz='1'/></inertial></link>\n";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& inside = "<axis xyz='0 0 1'/>") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
         child + "'/>" + inside + "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\n";
}
Loaded robot(const std::string& inside, const Options& options = {}) {
  return loadXML("<robot name='r'>\n" + inside + "</robot>", options);
}

// Joints and frames as one text: easy to compare, easy to read when it differs.
std::string outline(const Model& model) {
  std::ostringstream out;
  for (int i = 0; i < model.njoints; ++i) out << model.names[i] << "<" << model.parents[i] << " ";
  out << "|";
  for (const Frame& f : model.frames) {
    out << " " << f.name << ":" << frameTypeName(f.type) << "@" << f.parentJoint << "<" << f.parentFrame;
  }
  return out.str();
}

void expect_equal(const Model& a, const Model& b, double tol) {
  ASSERT_EQ(outline(a), outline(b));
  ASSERT_EQ(a.nq, b.nq);
  ASSERT_EQ(a.nv, b.nv);
  for (int i = 0; i < a.njoints; ++i) {
    SCOPED_TRACE(a.names[i]);
    EXPECT_EQ(a.joints[i].shortname(), b.joints[i].shortname());
    EXPECT_TRUE(a.joints[i].axis().isApprox(b.joints[i].axis(), tol));
    EXPECT_TRUE(a.jointPlacements[i].isApprox(b.jointPlacements[i], tol));
    EXPECT_TRUE(a.inertias[i].isApprox(b.inertias[i], tol));
  }
  for (int i = 0; i < a.nframes; ++i) EXPECT_TRUE(a.frames[i].placement.isApprox(b.frames[i].placement, tol));
  EXPECT_EQ(a.lowerPositionLimit, b.lowerPositionLimit);
  EXPECT_EQ(a.upperPositionLimit, b.upperPositionLimit);
  EXPECT_EQ(a.upperEffortLimit, b.upperEffortLimit);
  EXPECT_EQ(a.upperVelocityLimit, b.upperVelocityLimit);
  EXPECT_EQ(a.damping, b.damping);
  EXPECT_EQ(a.friction, b.friction);
}

// The sample arm against the same arm built by hand from its drawing. The file writes its inertias with nine
// digits, hence 1e-9.
TEST(UrdfModel, SampleArmEqualsTheOneBuiltByHand) {
  Model hand;
  hand.name = "simple_3dof_arm";
  const Inertia base(10, Eigen::Vector3d::Zero(), 0.1 * Eigen::Matrix3d::Identity());
  hand.appendBodyToJoint(0, base);
  hand.addBodyFrame("base_link", 0);
  const auto add = [&](int parent, const JointModel& kind, double height, const char* name, const char* body,
                       double angle, double effort, const Inertia& inertia, double com) {
    const int i =
        hand.addJoint(parent, kind, at(0, 0, height), name, one(effort), one(2), one(-angle), one(angle));
    hand.appendBodyToJoint(i, inertia, at(0, 0, com));
    hand.addBodyFrame(body, i, SE3::Identity(), hand.nframes - 1);
    return i;
  };
  const int i1 = add(0, JointModelRZ(), 0.05, "joint1_base_rotation", "link1", 3.14, 100,
                     Inertia::FromCylinder(5, 0.05, 0.5), 0.25);
  const int i2 = add(i1, JointModelRY(), 0.5, "joint2_shoulder", "link2", 1.57, 100,
                     Inertia::FromCylinder(3, 0.04, 0.4), 0.2);
  add(i2, JointModelRY(), 0.4, "joint3_elbow", "end_effector", 2.5, 50, Inertia::FromSphere(0.5, 0.03), 0);

  Model model;
  EXPECT_TRUE(buildModel(kArm, model).empty()) << "the sample must be clean";
  EXPECT_EQ(model.name, "simple_3dof_arm");
  EXPECT_EQ(model.njoints, 4);
  EXPECT_EQ(model.nframes, 8);
  // addJoint hangs a joint's frame on its parent's joint frame, the URDF on the parent link: compare without
  const auto tree_of = [](const Model& m) {
    std::string all;
    for (const Frame& f : m.frames)
      all += f.name + frameTypeName(f.type) + std::to_string(f.parentJoint) + " ";
    return all;
  };
  EXPECT_EQ(tree_of(model), tree_of(hand));
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(model.names[i], hand.names[i]);
    EXPECT_EQ(model.joints[i].shortname(), hand.joints[i].shortname());
    EXPECT_TRUE(model.jointPlacements[i].isApprox(hand.jointPlacements[i], 0));
    EXPECT_TRUE(model.inertias[i].isApprox(hand.inertias[i], 1e-9)) << model.names[i];
  }
  EXPECT_EQ(model.lowerPositionLimit, hand.lowerPositionLimit);
  EXPECT_EQ(model.upperPositionLimit, hand.upperPositionLimit);
  EXPECT_EQ(model.upperEffortLimit, hand.upperEffortLimit);
  EXPECT_EQ(model.upperVelocityLimit, hand.upperVelocityLimit);
}

TEST(UrdfModel, TextAndFileAreTheSame) {
  std::ifstream in(kArm);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  Model from_file, from_text;
  buildModel(kArm, from_file);
  buildModelFromXML(text, from_text);
  expect_equal(from_file, from_text, 0);
}

// Depth first, siblings by name, whatever the order in the file: 20 shuffles of one tree.
TEST(UrdfModel, OrderIsAlphabeticalDepthFirst) {
  std::vector<std::string> parts = {link("root"), link("l1"), link("l2"), link("l3"),
                                    link("l4"),   link("l5"), link("l6")};
  parts.push_back(joint("b", "revolute", "root", "l1"));
  parts.push_back(joint("a", "revolute", "root", "l2"));
  parts.push_back(joint("z", "prismatic", "l2", "l3"));
  parts.push_back(joint("Z", "continuous", "l2", "l4"));
  parts.push_back(joint("a2", "fixed", "l2", "l5"));
  parts.push_back(joint("m", "revolute", "l5", "l6"));
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    std::string inside;
    for (const std::string& part : parts) inside += part;
    const Loaded loaded = robot(inside);
    ASSERT_TRUE(loaded.ok());
    EXPECT_EQ(std::vector<std::string>(loaded.model.names),
              (std::vector<std::string>{"universe", "a", "Z", "m", "z", "b"}));
    std::string frames;
    for (const Frame& f : loaded.model.frames) frames += f.name + " ";
    EXPECT_EQ(frames, "universe root a l2 Z l4 a2 l5 m l6 z l3 b l1 ");
    std::shuffle(parts.begin(), parts.end(), random);
  }
}

TEST(UrdfModel, AxesKeepTheirSignAndAreNormalised) {
  const auto axis_of = [](const std::string& type, const std::string& axis) {
    const Loaded loaded = robot(link("a") + link("b") + joint("j", type, "a", "b", axis));
    EXPECT_TRUE(loaded.ok());
    return loaded.model.joints[1];
  };
  const auto is = [](const JointModel& joint, const std::string& kind, const Eigen::Vector3d& axis) {
    return joint.shortname() == kind && (joint.axis() - axis).norm() <= 4e-16;
  };
  EXPECT_TRUE(is(axis_of("revolute", "<axis xyz='1 0 0'/>"), "RX", {1, 0, 0}));
  EXPECT_TRUE(is(axis_of("revolute", "<axis xyz='0 0 -1'/>"), "RevoluteUnaligned", {0, 0, -1}));
  EXPECT_TRUE(is(axis_of("revolute", "<axis xyz='0 0 2'/>"), "RZ", {0, 0, 1}));
  EXPECT_TRUE(is(axis_of("revolute", "<axis xyz='3 0 4'/>"), "RevoluteUnaligned", {0.6, 0, 0.8}));
  EXPECT_TRUE(is(axis_of("revolute", ""), "RX", {1, 0, 0}));
  EXPECT_TRUE(is(axis_of("prismatic", "<axis xyz='0 1 0'/>"), "PY", {0, 1, 0}));
  EXPECT_TRUE(is(axis_of("prismatic", "<axis xyz='0 -7 0'/>"), "PrismaticUnaligned", {0, -1, 0}));
  EXPECT_TRUE(is(axis_of("continuous", "<axis xyz='0 0 1'/>"), "CZ", {0, 0, 1}));
}

TEST(UrdfModel, LimitsAndDynamics) {
  const auto inside = [](const std::string& type, const std::string& rest) {
    return "<joint name='j' type='" + type + "'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>" +
           rest + "</joint>\n";
  };
  const Model all = robot(link("a") + link("b") +
                          inside("revolute",
                                 "<limit lower='-0.5' upper='2' effort='30' velocity='4'/>"
                                 "<dynamics damping='0.25' friction='0.125'/>"))
                        .model;
  EXPECT_EQ(all.lowerPositionLimit[0], -0.5);
  EXPECT_EQ(all.upperPositionLimit[0], 2);
  EXPECT_EQ(all.upperEffortLimit[0], 30);
  EXPECT_EQ(all.upperVelocityLimit[0], 4);
  EXPECT_EQ(all.damping[0], 0.25);
  EXPECT_EQ(all.friction[0], 0.125);

  const Model free = robot(link("a") + link("b") + inside("continuous", "<dynamics/>")).model;
  EXPECT_EQ(free.lowerPositionLimit[0], -kInf);
  EXPECT_EQ(free.upperPositionLimit[0], kInf);
  EXPECT_EQ(free.upperEffortLimit[0], kInf);
  EXPECT_EQ(free.damping[0], 0);

  // "practically infinite" is infinite: upper - lower must not overflow to it unawares
  const Model huge =
      robot(link("a") + link("b") +
            inside("prismatic", "<limit lower='-1.7e308' upper='1.7e308' effort='1e16' velocity='9'/>"))
          .model;
  EXPECT_EQ(huge.lowerPositionLimit[0], -kInf);
  EXPECT_EQ(huge.upperPositionLimit[0], kInf);
  EXPECT_EQ(huge.upperEffortLimit[0], 1e16);
}

TEST(UrdfModel, FreeFlyerRoot) {
  Model fixed, floating;
  buildModel(kArm, fixed);
  buildModel(kArm, JointModelFreeFlyer(), floating);
  EXPECT_EQ(floating.nq, fixed.nq + 7);
  EXPECT_EQ(floating.nv, fixed.nv + 6);
  EXPECT_EQ(floating.names[1], "root_joint");
  EXPECT_EQ(floating.joints[1].shortname(), "FreeFlyer");
  EXPECT_EQ(floating.inertias[0].mass(), 0);
  EXPECT_TRUE(floating.inertias[1].isApprox(fixed.inertias[0], 0));
  EXPECT_EQ(floating.frames[1].name, "root_joint");
  EXPECT_EQ(floating.frames[2].name, "base_link");
  EXPECT_EQ(floating.frames[2].parentFrame, 1);
  for (int i = 1; i < fixed.njoints; ++i) {
    EXPECT_EQ(floating.names[i + 1], fixed.names[i]);
    EXPECT_EQ(floating.parents[i + 1], fixed.parents[i] + 1);
    EXPECT_TRUE(floating.inertias[i + 1].isApprox(fixed.inertias[i], 0));
  }

  Options options;
  options.floating_base = true;
  const Loaded taken = robot(link("a") + link("b") + joint("root_joint", "revolute", "a", "b"), options);
  ASSERT_FALSE(taken.ok());
  EXPECT_EQ(taken.diagnostics[0].element, "joint 'root_joint'");
}

TEST(UrdfModel, MimicIsFollowed) {
  // the leader comes behind its follower in the model's order, and follows another itself
  const std::string text =
      link("a") + link("b") + link("c") + link("d") + joint("y_lead", "continuous", "a", "b") +
      joint("b_follow", "revolute", "a", "c",
            "<axis xyz='0 0 1'/><mimic joint='m_follow' multiplier='-2' offset='0.5'/>") +
      joint("m_follow", "prismatic", "a", "d", "<axis xyz='0 0 1'/><mimic joint='y_lead' multiplier='3'/>");
  const Loaded loaded = robot(text);
  ASSERT_TRUE(loaded.ok());
  const Model& model = loaded.model;
  EXPECT_EQ(model.nv, 1);
  Data data(model);
  forwardKinematics(model, data, Eigen::VectorXd::Constant(1, 0.1));
  const auto pose = [&](const char* name) { return data.oMi[model.jointId(name)]; };
  EXPECT_NEAR(log3(pose("y_lead").rotation()).norm(), 0.1, 1e-15);
  EXPECT_NEAR(pose("m_follow").translation()[2], 0.3, 1e-15);
  EXPECT_NEAR(log3(pose("b_follow").rotation())[2], -2 * 0.3 + 0.5, 1e-15);
}

TEST(UrdfModel, PlanarAndFloating) {
  const Loaded loaded =
      robot(link("a") + link("b") + link("c") + joint("p", "planar", "a", "b", "<axis xyz='0 1 0'/>") +
            joint("q", "floating", "b", "c"));
  ASSERT_TRUE(loaded.ok());
  EXPECT_EQ(loaded.model.joints[1].shortname(), "Planar");
  EXPECT_EQ(loaded.model.joints[2].shortname(), "FreeFlyer");
  EXPECT_EQ(loaded.model.nq, 11);
  EXPECT_TRUE(loaded.model.joints[1].axis() == Eigen::Vector3d::UnitY());
}

TEST(UrdfModel, MimicCanBeLeftOut) {
  const std::string text = link("a") + link("b") + link("c") + joint("lead", "revolute", "a", "b") +
                           joint("follow", "revolute", "a", "c", "<axis xyz='0 0 1'/><mimic joint='lead'/>");
  EXPECT_EQ(robot(text).model.nv, 1);
  Options options;
  options.mimic = false;
  const Loaded free = robot(text, options);
  ASSERT_TRUE(free.ok());
  EXPECT_EQ(free.model.nv, 2);
  ASSERT_EQ(free.diagnostics.size(), 1u);
  EXPECT_EQ(free.diagnostics[0].severity, Severity::Note);
  EXPECT_EQ(free.diagnostics[0].element, "joint 'follow'");
}

// A chain of 3000 links, joints and fixed joints mixed; names whose alphabetical order is not the chain's.
TEST(UrdfModel, ChainOf3000) {
  const int n = 3000;
  std::string inside = link("l0");
  for (int i = 1; i <= n; ++i) {
    const std::string name = "j" + std::to_string((i * 7919) % n);
    inside += link("l" + std::to_string(i)) + joint(name, i % 3 ? "revolute" : "fixed",
                                                    "l" + std::to_string(i - 1), "l" + std::to_string(i),
                                                    "<axis xyz='0 0 1'/><origin xyz='0.001 0 0'/>");
  }
  const Loaded loaded = robot(inside);
  ASSERT_TRUE(loaded.ok());
  EXPECT_EQ(loaded.model.nv, n - n / 3);
  EXPECT_EQ(loaded.model.nframes, 2 + 2 * n);
  double length = 0, mass = 0;
  for (int i = 1; i < loaded.model.njoints; ++i) {
    EXPECT_EQ(loaded.model.parents[i], i - 1);
    length += loaded.model.jointPlacements[i].translation()[0];
  }
  length += loaded.model.frames[loaded.model.getFrameId("l" + std::to_string(n))].placement.translation()[0];
  for (const Inertia& body : loaded.model.inertias) mass += body.mass();
  EXPECT_NEAR(length, n * 0.001, 1e-9);
  EXPECT_EQ(mass, n + 1);
}

// Numbers are read as they are written, in every spelling that XML files have, whatever the locale.
TEST(UrdfModel, NumbersAreExactInAnyLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const Loaded loaded =
      robot(link("a") + link("b") +
            joint("j", "revolute", "a", "b",
                  "<axis xyz=' 0 0\t1'/><origin xyz='  +.1\n1e-3\t0.30000000000000004 ' rpy='0 0 0'/>"));
  std::locale::global(before);
  ASSERT_TRUE(loaded.ok()) << loaded.diagnostics[0];
  EXPECT_EQ(loaded.model.jointPlacements[1].translation(), Eigen::Vector3d(0.1, 1e-3, 0.30000000000000004));
  EXPECT_EQ(loaded.model.jointPlacements[1].rotation(), Eigen::Matrix3d::Identity());
}

TEST(UrdfModel, RollPitchYawIsFixedAxes) {
  const Loaded loaded =
      robot(link("a") + link("b") +
            joint("j", "revolute", "a", "b", "<axis xyz='0 0 1'/><origin rpy='0.3 -1.1 2.5'/>"));
  const Eigen::Matrix3d wanted =
      (Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-1.1, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_TRUE(loaded.model.jointPlacements[1].rotation().isApprox(wanted, 1e-15));
}

// Nothing is shared between loads.
TEST(UrdfModel, ThreadsMayLoadAtOnce) {
  Model wanted;
  buildModel(kArm, wanted);
  std::vector<Model> models(4);
  std::vector<std::thread> threads;
  for (Model& model : models) {
    threads.emplace_back([&model] {
      for (int k = 0; k < 5; ++k) buildModel(kArm, model);
    });
  }
  for (std::thread& t : threads) t.join();
  for (const Model& model : models) expect_equal(model, wanted, 0);
}

}  // namespace
}  // namespace rbd::urdf
