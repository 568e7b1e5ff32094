// Lines and circles, by forward kinematics of what the planner says: is the frame on the curve, when it should be; are v
// and a derivatives; does what the arm is free to do stay where it was.
#include "procs/planner/cartesian_path.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <Eigen/LU>
#include <cmath>

#include "procs/planner/planner.h"
#include "tests/support/refusal.h"

namespace lab::planner {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

const char* const kFrame = "arm_tool_link";

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

Experiment path(const std::string& kind, bool keep, double dt = 1e-3) {
  Experiment e;
  e.file = "x.yaml";
  e.simulator.dt = dt;
  e.simulator.duration = 100;
  e.simulator.q0.value = std::vector<double>{0.5, 0.3, 0.6, 0.2, 0.6, 0};
  e.planner.kind = kind;
  e.planner.frame = kFrame;
  e.planner.duration = 2;
  e.planner.keep_orientation = keep;
  e.planner.to = {0.5, -0.3, 0.5};
  e.planner.center = {0.55, 0.1, 0.55};
  e.planner.normal = {1, 0.2, 0.3};
  return e;
}

Reference at(const Config& config, double t) {
  State state = initial(config);
  return step(config, state, {.step = std::llround(t / config.dt)}).reference;
}

rbd::SE3 frame(const rbd::Model& model, const VectorXd& q) {
  rbd::Data data(model);
  rbd::forwardKinematics(model, data, q);
  return data.oMf[model.frameId(kFrame)];
}

/// Plain loops: g++ 12 gives false alarms about Eigen's largest coefficients with AVX-512.
double largest_share(const VectorXd& v, const VectorXd& of) {
  double most = 0;
  for (Eigen::Index i = 0; i < v.size(); ++i) most = std::max(most, std::abs(v[i]) / of[i]);
  return most;
}

/// 10 x^3 - 15 x^4 + 6 x^5
double progress(double x) { return x >= 1 ? 1 : x * x * x * (10 - 15 * x + 6 * x * x); }

/// The start turned about the axis, by the rotation matrix of the whole angle.
Vector3d turned(const Experiment& e, const Vector3d& start, double share) {
  const auto& [x, y, z] = *e.planner.center;
  const auto& [nx, ny, nz] = e.planner.normal;
  const Eigen::AngleAxisd turn(2 * M_PI * e.planner.turns * share, Vector3d(nx, ny, nz).normalized());
  return Vector3d(x, y, z) + turn * (start - Vector3d(x, y, z));
}

std::string refusal(const Experiment& e, const rbd::Model& model = arm()) {
  return test::refusal_of([&] { make_config(e, model); });
}

TEST(CartesianPath, TheFrameIsOnTheLineAndKeepsItsOrientation) {
  const rbd::Model model = arm();
  for (bool keep : {false, true}) {
    const Experiment e = path("line", keep);
    const Config c = make_config(e, model);
    const rbd::SE3 start = frame(model, c.q0);
    const Vector3d to((*e.planner.to)[0], (*e.planner.to)[1], (*e.planner.to)[2]);
    double most_turned = 0;
    for (double t = 0; t < 2.2; t += 0.007) {
      const rbd::SE3 pose = frame(model, at(c, t).q);
      // the tolerance is checked at five places of each piece, the one of the largest error among them
      const double share = progress(std::round(t * 1000) / 2000);
      EXPECT_LE((pose.translation() - (start.translation() + share * (to - start.translation()))).norm(),
                1.1 * kPathTolerance)
          << t;
      most_turned =
          std::max(most_turned, Eigen::AngleAxisd(pose.rotation() * start.rotation().transpose()).angle());
    }
    if (keep)
      EXPECT_LE(most_turned, 1.1 * kTurnTolerance);
    else
      EXPECT_GT(most_turned, 0.1) << "free to turn, and it does";
    EXPECT_LE((frame(model, at(c, 50).q).translation() - to).norm(), 1e-8);
    EXPECT_EQ(at(c, 50).v.norm(), 0);
  }
}

TEST(CartesianPath, TheFrameIsOnTheCircleAndComesBack) {
  const rbd::Model model = arm();
  for (bool keep : {false, true})
    for (double turns : {1.0, -1.0, 3.0, 0.3}) {
      SCOPED_TRACE("turns " + std::to_string(turns) + (keep ? ", orientation kept" : ""));
      Experiment e = path("circle", keep);
      e.planner.turns = turns;
      const Config c = make_config(e, model);
      const Vector3d start = frame(model, c.q0).translation();
      for (double t = 0; t < 2.2; t += 0.007) {
        const double share = progress(std::round(t * 1000) / 2000);
        EXPECT_LE((frame(model, at(c, t).q).translation() - turned(e, start, share)).norm(),
                  1.1 * kPathTolerance)
            << t;
      }
      // the same posture after whole turns, as near as inverse kinematics looks for the nearest to q0: 1e-6 rad
      if (turns == std::floor(turns)) {
        EXPECT_LE((at(c, 2.5).q - c.q0).norm(), 1e-6);
      }
    }
}

TEST(CartesianPath, WhatTheArmIsFreeToDoStaysNearTheStart) {
  const rbd::Model model = arm();
  Experiment e = path("circle", false);
  e.planner.turns = 2;
  const Config c = make_config(e, model);
  rbd::Data data(model);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, 6);
  double away = 0;
  for (double t = 0.1; t < 2; t += 0.05) {
    // nearest to q0 of all that hold the frame there: the way to q0 has no part along which the frame can stay
    const VectorXd q = at(c, t).q;
    rbd::computeJointJacobians(model, data, q);
    rbd::getFrameJacobian(model, data, model.frameId(kFrame), rbd::LOCAL_WORLD_ALIGNED, J);
    const Eigen::Matrix<double, 3, 6> L = J.bottomRows<3>();
    const Eigen::Matrix<double, 6, 1> back = c.q0 - q;
    const Eigen::Matrix3d inverse = Eigen::Matrix3d(L * L.transpose()).inverse();
    const Eigen::Matrix<double, 6, 1> free = back - L.transpose() * (inverse * (L * back));
    EXPECT_LE(free.norm(), 2e-4) << t;
    away = std::max(away, (c.q0 - q).norm());
  }
  EXPECT_GT(away, 0.2) << "while it does move";
}

// v against q and a against v by central differences; off by h^2 / 6 of the jerk, and for a, where the jerk jumps at a
// knot, by half of h times it.
TEST(CartesianPath, VelocityAndAccelerationAreDerivatives) {
  for (const char* kind : {"line", "circle"})
    for (bool keep : {false, true}) {
      double steps_of_a[2] = {0, 0}, fastest = 0;
      for (int fine : {0, 1}) {
        const double h = fine ? 5e-5 : 1e-4;
        const Config c = make_config(path(kind, keep, h), arm());
        std::vector<Reference> r;
        for (int k = 0; k * h <= 2.01; ++k) {
          r.push_back(at(c, k * h));
          for (int i = 0; i < 6 && k > 0; ++i)
            steps_of_a[fine] = std::max(steps_of_a[fine], std::abs(r[k].a[i] - r[k - 1].a[i]));
          fastest = std::max(fastest, largest_share(r[k].v, c.v_max));
        }
        const double jerk = steps_of_a[fine] / h;
        for (size_t k = 1; k + 1 < r.size(); ++k)
          for (int i = 0; i < 6; ++i) {
            ASSERT_NEAR((r[k + 1].q[i] - r[k - 1].q[i]) / (2 * h), r[k].v[i], h * h / 6 * jerk * 1.05 + 1e-11)
                << kind << k;
            ASSERT_NEAR((r[k + 1].v[i] - r[k - 1].v[i]) / (2 * h), r[k].a[i], h / 2 * jerk * 1.05)
                << kind << k;
          }
      }
      EXPECT_NEAR(steps_of_a[0] / steps_of_a[1], 2, 0.1) << "a jump of the acceleration would stay as large";
      EXPECT_GT(fastest, 0.05);
    }
}

TEST(CartesianPath, DurationZeroIsTheShortestWithinTheShare) {
  Experiment e = path("circle", true);
  e.planner.duration = 0;
  e.planner.speed = 0.3;
  const Config c = make_config(e, arm());
  double speed = 0;
  for (double t = 0; t < c.motion->duration; t += 0.001)
    speed = std::max(speed, largest_share(at(c, t).v, c.v_max));
  EXPECT_LE(speed, 0.3);
  EXPECT_GE(speed, 0.3 * 0.998);  // the margin of sampling is 0.1 %
}

// The same for the acceleration, with a bound so low that speeds do not matter.
TEST(CartesianPath, DurationZeroIsTheShortestWithinTheBoundOfAcceleration) {
  for (const char* kind : {"line", "circle"}) {
    Experiment e = path(kind, true);
    e.planner.duration = 0;
    e.planner.acceleration.value = std::vector<double>{0.1, 0.2, 0.3, 0.15, 0.25, 0.3};
    const Config c = make_config(e, arm());
    double most = 0, speed = 0;
    for (double t = 0; t < c.motion->duration; t += 0.001) {
      const Reference r = at(c, t);
      most = std::max(most, largest_share(r.a, c.a_max));
      speed = std::max(speed, largest_share(r.v, c.v_max));
    }
    EXPECT_LE(most, 1) << kind;
    EXPECT_GE(most, 0.998) << kind;  // the margin of sampling is 0.1 %
    EXPECT_LT(speed, 0.9 * c.speed) << kind;
  }
}

// Only the first joints move the middle of the wrist; those of the wrist only turn it. So the frame there is on its path with
// few pieces, and still turns too far between the knots.
TEST(CartesianPath, AFrameInTheMiddleOfTheWristKeepsItsOrientationToo) {
  const struct {
    const char* kind;
    double wrist;
  } rows[] = {{"line", 0.1}, {"line", 0.05}, {"circle", 0.6}, {"circle", 0.1}};
  const rbd::Model model = arm();
  const rbd::FrameIndex middle = model.frameId("effector_body");
  rbd::Data data(model);
  const auto rotation = [&](const VectorXd& q) {
    rbd::forwardKinematics(model, data, q);
    return Eigen::Quaterniond(data.oMf[middle].rotation());
  };
  for (const auto& row : rows) {
    Experiment e = path(row.kind, true);
    e.planner.frame = "effector_body";
    e.simulator.q0.value = std::vector<double>{0.5, 0.3, 0.6, 0.2, row.wrist, 0};
    const Config c = make_config(e, model);
    const Eigen::Quaterniond start = rotation(c.q0);
    double most = 0;
    for (double t = 0; t < 2; t += 0.001) most = std::max(most, rotation(at(c, t).q).angularDistance(start));
    EXPECT_LE(most, 1.1 * kTurnTolerance)
        << row.kind << " " << row.wrist;  // as above: checked at five places
  }
}

TEST(CartesianPath, LedAwayItGoesOnWhereItWas) {
  const rbd::Model model = arm();
  const Experiment e = path("circle", true);
  const Config c = make_config(e, model);
  const Vector3d start = frame(model, c.q0).translation(), left = turned(e, start, progress(0.35));
  State state = initial(c);
  double missed = 1;
  Reference r;
  for (int64_t k = 0; k < 12000; ++k) {
    std::vector<Action> actions;
    if (k == 700) actions = {{"goal", "", "", "", {0, 0, 0, 0, 0, 0}}};
    if (k == 5000) actions = {{"set", "planner", "motion", "on", {}}};
    const Output out = step(c, state, {.step = k, .actions = actions});
    ASSERT_TRUE(out.events.empty()) << out.events[0].why;
    r = out.reference;
    if (k > 5000) missed = std::min(missed, (frame(model, r.q).translation() - left).norm());
  }
  EXPECT_LE(missed, 3 * c.dt) << "at 3 m/s at most";
  EXPECT_EQ(r.q, at(c, 12).q);
}

TEST(CartesianPath, TheSameBytesEveryTime) {
  const Config a = make_config(path("circle", false), arm()), b = make_config(path("circle", false), arm());
  for (double t = 0; t < 2; t += 0.1) EXPECT_EQ(at(a, t).q, at(b, t).q);
}

TEST(CartesianPath, WhatCannotBeIsRefusedWithThePlaceAndTheReason) {
  Experiment e = path("line", false);
  e.where = {{"planner.to", "x.yaml:9"}};
  e.planner.to = {10, 0, 0.5};
  const std::string far = refusal(e);
  EXPECT_EQ(far.rfind("x.yaml:9: planner.to: 'arm_tool_link' ", 0), 0u) << far;
  EXPECT_NE(far.find(" % of the line, ("), std::string::npos) << far;
  // the arm reaches 0.45 + 0.2 + 0.2 + 0.1 + 0.08 = 1.03 m from its shoulder; knots are 9.6 m / 1024 apart
  const Vector3d from = frame(arm(), make_config(path("line", false), arm()).q0).translation();
  const double share = std::stod(far.substr(far.find(" at ") + 4)) / 100;
  const double reached = (from + share * (Vector3d(10, 0, 0.5) - from) - Vector3d(0, 0, 0.3)).norm();
  EXPECT_GT(reached, 1.02) << far;
  EXPECT_LT(reached, 1.045) << far;
  e.planner.to.reset();
  EXPECT_EQ(refusal(e),
            "x.yaml:9: planner.to: is missing; a line needs the position where it ends, [x, y, z]");
  e.planner.frame = "arm_tol_link";
  EXPECT_EQ(refusal(e), "x.yaml: planner.frame: no frame 'arm_tol_link'; did you mean 'arm_tool_link'?");
  e.planner.frame = "arm_base_link";
  EXPECT_EQ(refusal(e),
            "x.yaml: planner.frame: frame 'arm_base_link' stands on the ground; name one that moves");
  e.planner.frame = "";
  EXPECT_EQ(refusal(e), "x.yaml: planner.frame: is missing; a line is the path of a frame");

  e = path("circle", true);
  e.planner.normal = {0, 0, 0};
  EXPECT_EQ(refusal(e), "x.yaml: planner.normal: has length 0; it must point somewhere");
  e = path("circle", true);
  e.planner.center.reset();
  EXPECT_EQ(refusal(e), "x.yaml: planner.center: is missing; a circle needs a point of its axis, [x, y, z]");
  const Vector3d start = frame(arm(), make_config(path("circle", true), arm()).q0).translation();
  e.planner.center = {start[0], start[1], start[2]};
  EXPECT_NE(refusal(e).find("0 m from the axis of its circle"), std::string::npos) << refusal(e);
}

TEST(CartesianPath, AJointThatWouldHaveToGoBeyondItsLimitIsNamed) {
  rbd::Model model = arm();
  model.lowerPositionLimit[0] = 0.3;  // the line needs the base at -0.5
  const std::string why = refusal(path("line", true), model);
  EXPECT_NE(why.find("joint 'joint1_base_yaw' is at its limit"), std::string::npos) << why;
}

}  // namespace
}  // namespace lab::planner
