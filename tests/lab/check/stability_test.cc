// What `check` says of a loop's stability against what the loop does: just inside the limit a nudge dies, just outside it
// grows, for every law.
#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "core/util/number.h"
#include "lab/check/check.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/robot.h"
#include "procs/solo/direct.h"

namespace lab {
namespace {

TEST(SpectralRadius, IsThatOfEigensSolver) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int n : {1, 2, 6, 13})
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return 1e3 * normal(random); });
      const double solver = A.eigenvalues().cwiseAbs().maxCoeff();
      EXPECT_NEAR(spectral_radius(A) / solver, 1, 1e-7) << A;  // log(condition) / 2^30, and rounding
    }
  EXPECT_EQ(spectral_radius(Eigen::MatrixXd::Zero(3, 3)), 0);
  EXPECT_EQ(spectral_radius((Eigen::Matrix2d() << 0, 1, 0, 0).finished()), 0) << "nilpotent";
  EXPECT_NEAR(spectral_radius((Eigen::Matrix2d() << 0, -2, 2, 0).finished()), 2, 1e-9)
      << "complex eigenvalues";
  EXPECT_NEAR(spectral_radius((Eigen::Matrix2d() << 1, 1, 0, 1).finished()), 1, 1e-7) << "a Jordan block";
}

struct Case {
  const char* kind;
  const char* gains;  // %g is the one that is turned up
  double gravity = -9.81;
};

Experiment experiment(const Case& test, double gain) {
  char gains[300];
  std::snprintf(gains, sizeof gains, test.gains, gain);
  return parse_experiment(R"(
robot: {model: "builtin:manipulator"}
simulator: {dt: 0.005, duration: 2, q0: [0.3, 0.5, 0.4, 0.2, 0.7, -0.2], v0: 1e-6, gravity: [0, 0, )" +
                              number(test.gravity) + R"(]}
planner: {kind: hold}
expect: {max_error: {max: 1}}
controller: {kind: )" + std::string(test.kind) +
                              ", " + gains + "}\n",
                          "x.yaml");
}

/// The percentage that `check` warns of; 0 if it does not.
double warned(const Experiment& e) {
  for (const std::string& warning : check(e, load_robot(e)))
    if (const size_t at = warning.find("the gains are at "); at != std::string::npos)
      return std::stod(warning.substr(at + 17));
  return 0;
}

class Stability : public testing::TestWithParam<Case> {};

TEST_P(Stability, TheLimitIsWhereItExplodes) {
  double inside = 0, outside = 1e5;  // the gain at the limit, by bisection of what is said
  for (int i = 0; i < 40; ++i) {
    const double middle = (inside + outside) / 2;
    (warned(experiment(GetParam(), middle)) >= 100 ? outside : inside) = middle;
  }
  ASSERT_LT(outside, 9e4);
  for (const double factor : {0.97, 1.03}) {
    const Experiment e = experiment(GetParam(), factor * outside);
    const lab::Run run = *solo::run_direct(e, load_robot(e).model);
    const double last = run.aborted ? INFINITY : run.steps.back().state.v.cwiseAbs().maxCoeff();
    if (factor < 1)
      EXPECT_LT(last, 1e-6) << "gain " << factor * outside;
    else
      EXPECT_GT(last, 1e-3) << "gain " << factor * outside;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Laws, Stability,
    testing::Values(
        Case{"pd_gravity", "kp: 100, kd: %g"}, Case{"computed_torque", "kp: 100, kd: %g"},
        // the controller's masses are half of the arm's; no gravity, so that the arm stays where the nudge begins
        Case{"computed_torque", "kp: 100, model: {mass_scale: 0.5}, kd: %g", 0},
        Case{"cartesian_impedance", "frame: arm_tool_link, stiffness: [40, 800], damping: [8, %g]"},
        Case{"cartesian_impedance",
             "frame: arm_tool_link, stiffness: [0, 800], damping: [0, 100], kp: 20, kd: %g"},
        Case{"com_velocity", "com_gain: 5, kp: 5, kd: %g"},
        Case{"com_velocity", "kp: 5, kd: 40, com_gain: %g"}));

TEST(StabilityOfSomebodyElses, IsNotJudged) {
  Experiment e = experiment({"pd", "kp: 100, kd: %g"}, 1e4);
  EXPECT_GT(warned(e), 100);
  e.processes["controller"] = "python3 mine.py";
  e.controller.kind = "mine";
  EXPECT_EQ(warned(e), 0);
}

}  // namespace
}  // namespace lab
