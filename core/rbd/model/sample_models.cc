#include "rbd/model/sample_models.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "rbd/model/sample_parts.h"

namespace rbd::buildModels {
namespace {

using V = Eigen::Vector3d;

JointModel jointOf(char axis) {
  switch (axis) {
    case 'x':
      return JointModelRX();
    case 'y':
      return JointModelRY();
    case 'z':
      return JointModelRZ();
    default:
      return JointModelFreeFlyer();
  }
}

Inertia inertiaOf(const SamplePart& part) {
  switch (part.shape) {
    case Shape::Box:
      return Inertia::FromBox(part.mass, part.size.x(), part.size.y(), part.size.z());
    case Shape::Cylinder:
      return Inertia::FromCylinder(part.mass, part.size.x(), part.size.y());
    default:
      return Inertia::FromSphere(part.mass, part.size.x());
  }
}

// Same limits for every entry of one joint.
struct Limits {
  double effort, velocity, angle;
};

void addPart(Model& model, const SamplePart& part, const Limits& limits) {
  JointIndex joint = model.jointId(part.parent);
  if (std::string(part.joint) != "universe") {
    const JointModel kind = jointOf(part.axis);
    const SE3 placement(rpyToMatrix(0, part.pitch, 0), part.origin);
    if (part.axis == 'f') {
      joint = model.addJoint(joint, kind, placement, part.joint);
    } else {
      const auto one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
      joint = model.addJoint(joint, kind, placement, part.joint, one(limits.effort), one(limits.velocity),
                             one(-limits.angle), one(limits.angle));
    }
  }
  model.appendBodyToJoint(joint, inertiaOf(part), SE3(Eigen::Matrix3d::Identity(), part.centre));
}

// Couples two joints. The leader's limits shrink so that the follower keeps within its own, which a follower
// no longer has.
void follow(Model& model, const std::string& follower, const std::string& leader, double multiplier) {
  const JointIndex f = model.jointId(follower), l = model.jointId(leader);
  const double share = std::min(1.0, 1 / std::abs(multiplier));  // both sets of limits are alike, and even
  if (const JointModel& joint = model.joints[l]; !joint.mimics()) {
    model.lowerPositionLimit[joint.idx_q()] *= share;
    model.upperPositionLimit[joint.idx_q()] *= share;
    model.lowerVelocityLimit[joint.idx_v()] *= share;
    model.upperVelocityLimit[joint.idx_v()] *= share;
  }
  model.setMimic(f, l, multiplier);
}

}  // namespace

std::vector<SamplePart> manipulatorParts() {
  const double right = PI<double>() / 2;
  const Shape c = Shape::Cylinder, b = Shape::Box;
  return {
      {"universe", "universe", ' ', V(0, 0, 0), 0, c, V(0.10, 0.15, 0), V(0, 0, 0.075), 6.0},
      {"joint1_base_yaw", "universe", 'z', V(0, 0, 0.15), 0, c, V(0.08, 0.15, 0), V(0, 0, 0.075), 4.0},
      {"joint2_shoulder", "joint1_base_yaw", 'y', V(0, 0, 0.15), 0, c, V(0.05, 0.45, 0), V(0, 0, 0.225), 5.0},
      {"joint3_elbow", "joint2_shoulder", 'y', V(0, 0, 0.45), right, c, V(0.045, 0.20, 0), V(0, 0, 0.10),
       2.5},
      {"joint4_forearm_roll", "joint3_elbow", 'z', V(0, 0, 0.20), 0, c, V(0.04, 0.20, 0), V(0, 0, 0.10), 2.0},
      {"joint5_wrist_pitch", "joint4_forearm_roll", 'y', V(0, 0, 0.20), 0, c, V(0.04, 0.10, 0), V(0, 0, 0.05),
       1.0},
      {"joint6_tool_roll", "joint5_wrist_pitch", 'z', V(0, 0, 0.10), 0, b, V(0.06, 0.06, 0.08), V(0, 0, 0.04),
       0.5},
  };
}

void manipulator(Model& model, bool mimic) {
  Model arm;
  arm.name = "manipulator";
  const Limits strong{300, 6, PI<double>()}, weak{150, 6, PI<double>()};
  int row = 0;
  for (const SamplePart& part : manipulatorParts()) addPart(arm, part, row++ < 4 ? strong : weak);
  // rotors: 1e-4 kg m^2 behind a gear of 50. M is at least this much of the identity, so that PD gains of a
  // few dozen stay stable at time steps of 10 ms
  arm.armature.setConstant(0.25);

  const auto body = [&arm](const char* frame, const char* joint) {
    const JointIndex i = arm.jointId(joint);
    arm.addBodyFrame(frame, i, SE3::Identity(), arm.getFrameId(joint));
  };
  body("arm_base_link", "universe");
  body("upperarm_body", "joint2_shoulder");
  body("forearm_body", "joint3_elbow");
  body("wrist_body", "joint5_wrist_pitch");
  const JointIndex last = arm.jointId("joint6_tool_roll");
  arm.addFrame(Frame("arm_tool_link", last, arm.getFrameId("joint6_tool_roll"),
                     SE3(Eigen::Matrix3d::Identity(), V(0, 0, 0.08)), OP_FRAME));
  body("effector_body", "joint6_tool_roll");
  if (mimic) follow(arm, "joint6_tool_roll", "joint4_forearm_roll", -1);
  model = std::move(arm);
}

std::vector<SamplePart> humanoidParts() {
  const Shape c = Shape::Cylinder, b = Shape::Box, s = Shape::Sphere;
  std::vector<SamplePart> parts = {
      {"root_joint", "universe", 'f', V(0, 0, 0), 0, b, V(0.18, 0.26, 0.16), V(0, 0, 0), 10.0}};
  // row order is depth first, children by name: left leg, right leg, torso with head, left arm, right arm
  const auto leg = [&](bool left) {
    const double y = left ? 0.09 : -0.09;
    const auto n = [left](const char* l, const char* r) { return left ? l : r; };
    const char* yaw = n("left_hip_yaw", "right_hip_yaw");
    const char* roll = n("left_hip_roll", "right_hip_roll");
    const char* pitch = n("left_hip_pitch", "right_hip_pitch");
    const char* knee = n("left_knee", "right_knee");
    const char* ankle = n("left_ankle_pitch", "right_ankle_pitch");
    const char* foot = n("left_ankle_roll", "right_ankle_roll");
    parts.push_back({yaw, "root_joint", 'z', V(0, y, -0.08), 0, s, V(0.05, 0, 0), V(0, 0, 0), 1.0});
    parts.push_back({roll, yaw, 'x', V(0, 0, 0), 0, s, V(0.05, 0, 0), V(0, 0, 0), 1.0});
    parts.push_back({pitch, roll, 'y', V(0, 0, 0), 0, c, V(0.06, 0.38, 0), V(0, 0, -0.19), 5.5});
    parts.push_back({knee, pitch, 'y', V(0, 0, -0.38), 0, c, V(0.045, 0.36, 0), V(0, 0, -0.18), 3.5});
    parts.push_back({ankle, knee, 'y', V(0, 0, -0.36), 0, s, V(0.035, 0, 0), V(0, 0, 0), 0.4});
    parts.push_back({foot, ankle, 'x', V(0, 0, 0), 0, b, V(0.22, 0.09, 0.05), V(0.04, 0, -0.05), 1.1});
  };
  const auto arm = [&](bool left) {
    const double y = left ? 0.20 : -0.20;
    const auto n = [left](const char* l, const char* r) { return left ? l : r; };
    const char* pitch = n("left_shoulder_pitch", "right_shoulder_pitch");
    const char* roll = n("left_shoulder_roll", "right_shoulder_roll");
    const char* yaw = n("left_shoulder_yaw", "right_shoulder_yaw");
    const char* elbow = n("left_elbow", "right_elbow");
    const char* turn = n("left_wrist_yaw", "right_wrist_yaw");
    const char* tilt = n("left_wrist_roll", "right_wrist_roll");
    const char* hand = n("left_wrist_pitch", "right_wrist_pitch");
    parts.push_back({pitch, "torso_pitch", 'y', V(0, y, 0.36), 0, s, V(0.05, 0, 0), V(0, 0, 0), 0.8});
    parts.push_back({roll, pitch, 'x', V(0, 0, 0), 0, s, V(0.05, 0, 0), V(0, 0, 0), 0.8});
    parts.push_back({yaw, roll, 'z', V(0, 0, 0), 0, c, V(0.04, 0.26, 0), V(0, 0, -0.13), 1.6});
    parts.push_back({elbow, yaw, 'y', V(0, 0, -0.26), 0, c, V(0.035, 0.12, 0), V(0, 0, -0.06), 0.7});
    parts.push_back({turn, elbow, 'z', V(0, 0, -0.12), 0, c, V(0.03, 0.12, 0), V(0, 0, -0.06), 0.5});
    parts.push_back({tilt, turn, 'x', V(0, 0, -0.12), 0, s, V(0.025, 0, 0), V(0, 0, 0), 0.2});
    parts.push_back({hand, tilt, 'y', V(0, 0, 0), 0, b, V(0.03, 0.08, 0.14), V(0, 0, -0.08), 0.5});
  };
  leg(true);
  leg(false);
  parts.push_back({"torso_yaw", "root_joint", 'z', V(0, 0, 0.10), 0, c, V(0.08, 0.06, 0), V(0, 0, 0), 2.0});
  parts.push_back(
      {"torso_pitch", "torso_yaw", 'y', V(0, 0, 0.05), 0, b, V(0.18, 0.30, 0.40), V(0, 0, 0.20), 16.0});
  parts.push_back(
      {"head_yaw", "torso_pitch", 'z', V(0, 0, 0.42), 0, c, V(0.04, 0.06, 0), V(0, 0, 0.02), 0.6});
  parts.push_back({"head_pitch", "head_yaw", 'y', V(0, 0, 0.06), 0, s, V(0.10, 0, 0), V(0.01, 0, 0.09), 3.6});
  arm(true);
  arm(false);
  return parts;
}

void humanoid(Model& model, bool mimic) {
  Model body;
  body.name = "humanoid";
  for (const SamplePart& part : humanoidParts()) {
    addPart(body, part, {200, 10, 2.5});
    const JointIndex i = body.jointId(part.joint);
    body.addBodyFrame(std::string(part.joint) + "_body", i, SE3::Identity(), body.getFrameId(part.joint));
  }
  // rotors behind gears, on the joints; the free-flyer has none
  body.armature.tail(body.nv - 6).setConstant(0.02);
  if (mimic) {
    for (const std::string side : {"left_", "right_"}) {
      follow(body, side + "knee", side + "hip_pitch", -2);
      follow(body, side + "ankle_pitch", side + "knee", -0.5);
    }
  }
  model = std::move(body);
}

}  // namespace rbd::buildModels
