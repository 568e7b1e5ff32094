// The laws in task space against statics, finite differences of the kinematics alone, and least squares.
#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <Eigen/QR>
#include <cmath>

#include "procs/controller/controller.h"
#include "procs/simulator/simulator.h"
#include "tests/support/refusal.h"

namespace lab::controller {
namespace {

constexpr const char* kTool = "arm_tool_link";

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

Experiment impedance(std::array<double, 2> stiffness, std::array<double, 2> damping, double kp = 0,
                     double kd = 0) {
  Experiment e;
  e.controller.kind = "cartesian_impedance";
  e.controller.frame = kTool;
  e.controller.stiffness = stiffness;
  e.controller.damping = damping;
  e.controller.kp.value = kp;
  e.controller.kd.value = kd;
  return e;
}

RobotState somewhere() {
  RobotState s;
  s.q = Eigen::VectorXd::LinSpaced(6, -0.6, 0.8);
  s.v = Eigen::VectorXd::LinSpaced(6, 0.9, -0.5);
  s.tau = Eigen::VectorXd::Zero(6);
  return s;
}

Reference elsewhere() {
  Reference r;
  r.q = Eigen::VectorXd::LinSpaced(6, 0.2, -0.3);
  r.v = Eigen::VectorXd::LinSpaced(6, -0.4, 0.1);
  r.a = Eigen::VectorXd::LinSpaced(6, 1, 2);
  return r;
}

Eigen::VectorXd tau_of(const Experiment& e, const rbd::Model& model, const RobotState& s,
                       const Reference& r) {
  const Config config = make_config(e, model);
  State state = initial(config);
  return step(config, state, {.state = s, .reference = r}).command.tau;
}

rbd::SE3 tool(const rbd::Model& model, const Eigen::VectorXd& q) {
  rbd::Data data(model);
  rbd::forwardKinematics(model, data, q);
  return data.oMf[model.frameId(kTool)];
}

/// (rotation vector of the turn, way) from one tool pose to another, world axes.
rbd::Vector6d way(const rbd::SE3& from, const rbd::SE3& to) {
  rbd::Vector6d d;
  d.head<3>() = rbd::log3(Eigen::Matrix3d(to.rotation() * from.rotation().transpose()));
  d.tail<3>() = to.translation() - from.translation();
  return d;
}

/// Speed of the tool by central differences; error h^2/6 of the third derivative, about 1e-9.
rbd::Vector6d speed(const rbd::Model& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  const double h = 1e-5;
  return way(tool(model, q - h * v), tool(model, q + h * v)) / (2 * h);
}

// What the springs do is minus the slope of their energy 1/2 kr |turn|^2 + 1/2 kt |way|^2; what the dampers do is minus
// the slope of Rayleigh's function 1/2 dr |w|^2 + 1/2 dt |v|^2 of the lag. Both from forward kinematics alone.
TEST(Impedance, SpringsAndDampersComeFromPotentials) {
  const rbd::Model model = arm();
  const RobotState s = somewhere();
  const Reference r = elsewhere();
  rbd::Data data(model);
  const Eigen::VectorXd nle = rbd::nonLinearEffects(model, data, s.q, s.v);
  const auto energy = [&](const Eigen::VectorXd& q) {
    const rbd::Vector6d d = way(tool(model, q), tool(model, r.q));
    return 0.5 * 40 * d.head<3>().squaredNorm() + 0.5 * 700 * d.tail<3>().squaredNorm();
  };
  const auto loss = [&](const Eigen::VectorXd& v) {
    const rbd::Vector6d d = speed(model, r.q, r.v) - speed(model, s.q, v);
    return 0.5 * 3 * d.head<3>().squaredNorm() + 0.5 * 50 * d.tail<3>().squaredNorm();
  };
  const Eigen::VectorXd springs = tau_of(impedance({40, 700}, {0, 0}), model, s, r) - nle,
                        both = tau_of(impedance({40, 700}, {3, 50}), model, s, r) - nle;
  for (int i = 0; i < 6; ++i) {
    const double h = 1e-4;  // error h^2 / 6 of third derivatives of some 1e3: 1e-5
    const Eigen::VectorXd by = h * Eigen::VectorXd::Unit(6, i);
    EXPECT_NEAR(springs[i], -(energy(s.q + by) - energy(s.q - by)) / (2 * h), 1e-4);
    EXPECT_NEAR(both[i] - springs[i], -(loss(s.v + by) - loss(s.v - by)) / (2 * h), 1e-4);
  }
  EXPECT_GT(springs.norm(), 10);
  EXPECT_GT((both - springs).norm(), 10);
}

/// Where a steady wrench on the tool has moved it once all is at rest. `q`: also where the joints are.
rbd::Vector6d displacement(const Experiment& e, const rbd::Model& model, const Eigen::VectorXd& q0,
                           const rbd::Vector6d& wrench, Eigen::VectorXd& q) {
  Experiment at = e;
  at.simulator.q0.value = std::vector<double>(q0.begin(), q0.end());
  const simulator::Config plant = simulator::make_config(at, model);
  simulator::State body = simulator::initial(plant);
  const Config config = make_config(at, model);
  State state = initial(config);
  const Reference r{.step = 0, .q = q0, .v = Eigen::VectorXd::Zero(6), .a = Eigen::VectorXd::Zero(6)};
  Action push{"push", kTool, "", "", {}};
  push.values.assign(wrench.begin(), wrench.end());
  push.values.push_back(60);  // s: longer than the run
  const std::vector<Action> once{push};
  for (int k = 0; k < 20000; ++k) {
    const Command command = step(config, state, {.state = body.robot, .reference = r}).command;
    EXPECT_FALSE(
        simulator::step(plant, body, {.command = &command, .actions = k ? std::span<const Action>() : once})
            .abort);
  }
  EXPECT_LT(body.robot.v.norm(), 1e-9) << "not at rest";
  q = body.robot.q;
  return way(tool(model, q0), tool(model, q));
}

const Eigen::VectorXd kBent = (Eigen::VectorXd(6) << 0.3, 0.5, 0.4, 0.2, 0.7, -0.2).finished();

// Statics: the wrench bends the springs by itself over the stiffness, whatever the arm's shape and weight.
TEST(Impedance, GivesWayByForceOverStiffness) {
  const rbd::Model model = arm();
  const rbd::Vector6d wrench = (rbd::Vector6d() << 2, -1, 3, 20, -10, 15).finished();
  Eigen::VectorXd q;
  const rbd::Vector6d moved = displacement(impedance({40, 800}, {8, 100}), model, kBent, wrench, q);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(moved[i], wrench[i] / (i < 3 ? 40 : 800), 1e-8) << i;
}

// The posture does not help against the push, though its springs are stretched: only its share beside the tool acts.
TEST(Impedance, PostureBearsNothingOfThePush) {
  const rbd::Model model = arm();
  const rbd::Vector6d force = (rbd::Vector6d() << 0, 0, 0, 20, -10, 15).finished();
  Eigen::VectorXd q;
  const rbd::Vector6d moved = displacement(impedance({0, 800}, {0, 100}, 30, 15), model, kBent, force, q);
  for (int i = 3; i < 6; ++i) EXPECT_NEAR(moved[i], force[i] / 800, 1e-8) << i;
  EXPECT_GT((q - kBent).cwiseAbs().maxCoeff(), 0.02);  // 30 Nm/rad would bear a good part of it
}

// In motion too: with and without the posture's torque the tool accelerates alike (J M^-1 tau0 = 0), the joints do not.
TEST(Impedance, PostureDoesNotMoveTheTool) {
  const rbd::Model model = arm();
  const RobotState s = somewhere();
  const Reference r = elsewhere();
  const auto acceleration = [&](double kp, double kd, Eigen::VectorXd& a) {
    rbd::Data data(model);
    a = rbd::aba(model, data, s.q, s.v, tau_of(impedance({0, 700}, {0, 50}, kp, kd), model, s, r));
    rbd::forwardKinematics(model, data, s.q, s.v, a);
    return rbd::getFrameClassicalAcceleration(model, data, model.frameId(kTool), rbd::LOCAL_WORLD_ALIGNED);
  };
  Eigen::VectorXd with, without;
  const rbd::Motion one = acceleration(25, 5, with), other = acceleration(0, 0, without);
  EXPECT_LT((one.linear() - other.linear()).norm(), 1e-10 * other.linear().norm());  // eps cond(M)
  EXPECT_GT((with - without).norm(), 1);
}

// Without any hold on the tool all of the posture acts: a PD with everything compensated.
TEST(Impedance, WithoutStiffnessAndDampingThePostureIsFree) {
  const rbd::Model model = arm();
  const RobotState s = somewhere();
  const Reference r = elsewhere();
  rbd::Data data(model);
  const Eigen::VectorXd wanted =
      25 * (r.q - s.q) + 5 * (r.v - s.v) + rbd::nonLinearEffects(model, data, s.q, s.v);
  EXPECT_LT((tau_of(impedance({0, 0}, {0, 0}, 25, 5), model, s, r) - wanted).norm(), 1e-11);
}

// Upright the arm is stretched out: directions that no joint can move are left alone, and nothing is out of bounds.
TEST(Impedance, IsFiniteWhereTheArmIsSingular) {
  const rbd::Model model = arm();
  RobotState s = somewhere();
  s.q.setZero();
  s.v.setZero();
  Reference r = elsewhere();
  r.q.setConstant(0.1);
  r.v.setZero();
  const Eigen::VectorXd tau = tau_of(impedance({40, 700}, {3, 50}, 25, 5), model, s, r);
  EXPECT_TRUE(tau.allFinite());
  EXPECT_LT(tau.cwiseAbs().maxCoeff(), 300);
}

Experiment com(double gain, double kp, double kd) {
  Experiment e;
  e.controller.kind = "com_velocity";
  e.controller.com_gain = gain;
  e.controller.kp.value = kp;
  e.controller.kd.value = kd;
  return e;
}

Eigen::Vector3d com_at(const rbd::Model& model, const Eigen::VectorXd& q) {
  rbd::Data data(model);
  return rbd::centerOfMass(model, data, q);
}

/// Velocity of the centre of mass by central differences; error h^2/6 |v|^3 reach, about 2e-8 at 10 rad/s.
Eigen::Vector3d com_speed(const rbd::Model& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  const double h = 1e-5;
  return (com_at(model, q + h * v) - com_at(model, q - h * v)) / (2 * h);
}

/// The joint velocities that the law is after: forward dynamics gives a = a_ref + kd (v_d - v).
Eigen::VectorXd wanted_velocity(const Experiment& e, double kd, const rbd::Model& model, const RobotState& s,
                                const Reference& r) {
  rbd::Data data(model);
  return s.v + (rbd::aba(model, data, s.q, s.v, tau_of(e, model, s, r)) - r.a) / kd;
}

TEST(ComVelocity, MovesTheCentreOfMassAsWanted) {
  const rbd::Model model = arm();
  const RobotState s = somewhere();
  const Reference r = elsewhere();
  const Eigen::VectorXd v = wanted_velocity(com(8, 3, 40), 40, model, s, r);
  const Eigen::Vector3d wanted = com_speed(model, r.q, r.v) + 8 * (com_at(model, r.q) - com_at(model, s.q));
  EXPECT_LT((com_speed(model, s.q, v) - wanted).norm(), 1e-7);
  EXPECT_GT(wanted.norm(), 0.1);
}

// .. and of all velocities that do it, it takes the one nearest to the posture's: least squares by another method.
TEST(ComVelocity, IsTheLeastChangeOfThePosture) {
  const rbd::Model model = arm();
  const RobotState s = somewhere();
  const Reference r = elsewhere();
  const Eigen::VectorXd v = wanted_velocity(com(8, 3, 40), 40, model, s, r), posture = r.v + 3 * (r.q - s.q);
  Eigen::MatrixXd J(3, 6);
  for (int i = 0; i < 6; ++i) J.col(i) = com_speed(model, s.q, Eigen::VectorXd::Unit(6, i));
  const Eigen::Vector3d wanted = com_speed(model, r.q, r.v) + 8 * (com_at(model, r.q) - com_at(model, s.q));
  const Eigen::VectorXd change =
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(J).solve(wanted - J * posture);
  EXPECT_LT((v - posture - change).norm(), 1e-7);  // differences of 1e-9 through the inverse of J
}

// e'' + kd e' + kd com_gain e = 0 for the centre of mass: with kd = 4 com_gain it dies like (1 + at) exp(-at), a = kd / 2
TEST(ComVelocity, ErrorsDieAsTheFormulaSays) {
  const rbd::Model model = arm();
  Experiment e = com(10, 10, 40);
  e.simulator.dt = 1e-4;
  const Eigen::VectorXd offset = 0.01 * Eigen::VectorXd::LinSpaced(6, 1, -0.5);
  const Eigen::VectorXd start = kBent + offset;
  e.simulator.q0.value = std::vector<double>(start.begin(), start.end());
  const simulator::Config plant = simulator::make_config(e, model);
  simulator::State body = simulator::initial(plant);
  const Config config = make_config(e, model);
  State state = initial(config);
  const Reference r{.step = 0, .q = kBent, .v = Eigen::VectorXd::Zero(6), .a = Eigen::VectorXd::Zero(6)};
  const Eigen::Vector3d goal = com_at(model, kBent), first = com_at(model, start) - goal;
  for (int k = 1; k <= 2000; ++k) {
    const Command command = step(config, state, {.state = body.robot, .reference = r}).command;
    simulator::step(plant, body, {.command = &command});
    const double t = k * 1e-4, decay = (1 + 20 * t) * std::exp(-20 * t);
    // 1 % for the curvature of the kinematics (offset 0.01 rad) and the integrator
    ASSERT_LT((com_at(model, body.robot.q) - goal - decay * first).norm(), 0.01 * first.norm()) << t;
  }
}

TEST(ComVelocity, LeavesAloneWhatTheJointsCannotMove) {
  const rbd::Model model = arm();
  RobotState s = somewhere();
  s.q << 0, 0, -1.57079632679, 0, 0, 0;  // stretched straight up: the centre of mass can only go along x
  s.v.setZero();
  Reference r = elsewhere();
  r.v.setZero();
  r.a.setZero();
  const Eigen::VectorXd v = wanted_velocity(com(8, 0, 40), 40, model, s, r);
  EXPECT_LT(v.cwiseAbs().maxCoeff(), 20);
  const Eigen::Vector3d wanted = 8 * (com_at(model, r.q) - com_at(model, s.q)),
                        got = com_speed(model, s.q, v);
  EXPECT_LT(wanted.z(), -0.05);  // down, which cannot be had
  EXPECT_NEAR(got.x(), wanted.x(), 1e-6);
  EXPECT_NEAR(got.y(), 0, 1e-6);
  EXPECT_NEAR(got.z(), 0, 1e-6);
}

TEST(TaskLaws, GainsCanBeSetWhileTheyRun) {
  const rbd::Model model = arm();
  const RobotState s = somewhere();
  const Reference r = elsewhere();
  const auto live = [&](const Experiment& e, const Action& action) {
    const Config config = make_config(e, model);
    State state = initial(config);
    const std::vector<Action> actions{action};
    Output out = step(config, state, {.state = s, .reference = r, .actions = actions});
    EXPECT_TRUE(out.events.empty()) << action.key;
    return out.command.tau;
  };
  EXPECT_EQ(live(impedance({1, 2}, {3, 50}), {"set", "controller", "stiffness", "", {40, 700}}),
            tau_of(impedance({40, 700}, {3, 50}), model, s, r));
  EXPECT_EQ(live(impedance({40, 700}, {0, 1}), {"set", "controller", "damping", "", {3, 50}}),
            tau_of(impedance({40, 700}, {3, 50}), model, s, r));
  EXPECT_EQ(live(com(1, 3, 40), {"set", "controller", "com_gain", "", {8}}),
            tau_of(com(8, 3, 40), model, s, r));
}

std::string refusal(const Experiment& e, const rbd::Model& model) {
  return test::refusal_of([&] { make_config(e, model); });
}

TEST(TaskLaws, RefuseWhatTheyCannotDo) {
  Experiment e = impedance({1, 1}, {0, 0});
  e.file = "x.yaml";
  e.controller.frame = "arm_tol_link";
  EXPECT_EQ(
      refusal(e, arm()),
      "x.yaml: controller.frame: 'manipulator' has no frame 'arm_tol_link'; did you mean 'arm_tool_link'?");
  e.controller.frame = "";
  EXPECT_TRUE(
      refusal(e, arm()).starts_with("x.yaml: controller.frame: is missing; name the frame that "
                                    "cartesian_impedance holds, one of universe, "));
  rbd::Model humanoid;
  rbd::buildModels::humanoid(humanoid);
  EXPECT_EQ(refusal(com(1, 1, 1), humanoid),
            "experiment: controller.kind: 'com_velocity' needs a fixed base; 'humanoid' floats");
}

}  // namespace
}  // namespace lab::controller
