// The robot of an experiment: same from file and from text, locked joints, armature, refusals, stability.
#include "lab/experiment/robot.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <fstream>
#include <sstream>

#include "lab/check/check.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/tool/procfile.h"
#include "tests/support/paths.h"
#include "tests/support/refusal.h"

namespace lab {
namespace {

Experiment arm3(const std::vector<std::string>& set = {}) {
  return load_experiment(lab::source_path("experiments/arm3_cubic_pd.yaml"), set);
}

std::string refusal(const std::vector<std::string>& set) {
  return test::refusal_of([&] {
    const Experiment e = arm3(set);
    check(e, load_robot(e));
  });
}

TEST(Robot, TextOfRunGivesTheSameRobotAsTheFile) {
  const Experiment e = arm3();
  const Robot from_file = load_robot(e);
  const Robot from_text = load_robot(parse_experiment(canonical(e), "RUN"), from_file.urdf);
  EXPECT_EQ(from_text.hash, from_file.hash);
  EXPECT_EQ(from_text.model.nv, 3);
  EXPECT_EQ(from_text.model.armature, from_file.model.armature);
  EXPECT_EQ(from_text.geometry.visual.size(), from_file.geometry.visual.size());
  EXPECT_EQ(from_file.file, lab::source_path("models/simple_3dof_arm.urdf"));
}

TEST(Robot, HashKnowsWhatChangesTheModelAndNothingElse) {
  const int64_t hash = load_robot(arm3()).hash;
  EXPECT_EQ(load_robot(arm3({"controller.kp=1", "simulator.dt=0.001", "renderer.fps=1"})).hash, hash);
  EXPECT_EQ(load_robot(arm3({"robot.armature=[0.2, 0.2, 0.2]"})).hash, hash);  // the same in other words
  for (const char* change : {"robot.armature=0.3", "robot.mimic=false", "robot.lock.joint3_elbow=0.1",
                             "simulator.gravity=[0, 0, -1.62]"})
    EXPECT_NE(load_robot(arm3({change, "planner.kind=hold"})).hash, hash) << change;
  const Robot builtin = load_robot(parse_experiment("robot: {model: 'builtin:manipulator'}", "x"));
  EXPECT_NE(builtin.hash, hash);
  EXPECT_EQ(builtin.model.nv, 6);
  EXPECT_TRUE(builtin.urdf.empty());
  EXPECT_FALSE(builtin.geometry.visual.empty());
}

// a locked robot is the free one, held there: its dynamics are the matching part of the free one's
TEST(Robot, LockedJointsLeaveTheRestAsItWas) {
  const Robot open = load_robot(arm3()), locked = load_robot(arm3({"robot.lock.joint2_shoulder=0.7"}));
  ASSERT_EQ(locked.model.nv, 2);
  ASSERT_EQ(locked.model.nframes, open.model.nframes);
  const Eigen::Vector3d q(0.4, 0.7, -1.1), v(0.5, 0, 2), a(1, 0, -3);
  rbd::Data free(open.model), held(locked.model);
  const Eigen::VectorXd tau = rbd::rnea(open.model, free, q, v, a);
  const Eigen::VectorXd tau2 = rbd::rnea(locked.model, held, Eigen::Vector2d(q[0], q[2]),
                                         Eigen::Vector2d(v[0], v[2]), Eigen::Vector2d(a[0], a[2]));
  EXPECT_NEAR(tau2[0], tau[0], 1e-12);
  EXPECT_NEAR(tau2[1], tau[2], 1e-12);
  rbd::forwardKinematics(open.model, free, q);
  rbd::forwardKinematics(locked.model, held, Eigen::Vector2d(q[0], q[2]));
  for (int f = 0; f < open.model.nframes; ++f) {
    EXPECT_EQ(locked.model.frames[f].name, open.model.frames[f].name);
    EXPECT_TRUE(held.oMf[f].isApprox(free.oMf[f])) << open.model.frames[f].name;
  }
  ASSERT_EQ(locked.geometry.visual.size(), open.geometry.visual.size());
  for (size_t i = 0; i < open.geometry.visual.size(); ++i) {
    const auto &x = open.geometry.visual[i], &y = locked.geometry.visual[i];
    EXPECT_TRUE((held.oMi[y.parentJoint] * y.placement).isApprox(free.oMi[x.parentJoint] * x.placement))
        << x.name;
    EXPECT_EQ(locked.model.frames[y.parentFrame].name, open.model.frames[x.parentFrame].name);
  }
  EXPECT_EQ(locked.model.upperEffortLimit[1], open.model.upperEffortLimit[2]);
}

TEST(Robot, RefusalsNameTheKeyAndTheCure) {
  EXPECT_EQ(refusal({"robot.lock.joint2_sholder=0.7"}),
            "--set: robot.lock.joint2_sholder: 'simple_3dof_arm' has no such joint; did you mean "
            "'joint2_shoulder'?");
  EXPECT_EQ(refusal({"robot.lock.joint2_shoulder=2"}),
            "--set: robot.lock.joint2_shoulder: 2 is outside the joint's limits -1.57 .. 1.57");
  EXPECT_EQ(refusal({"robot.lock.joint2_shoulder=-2"}),
            "--set: robot.lock.joint2_shoulder: -2 is outside the joint's limits -1.57 .. 1.57");
  EXPECT_EQ(
      refusal({"robot.model=builtin:arm"}),
      "--set: robot.model: 'builtin:arm' is not known; builtin are builtin:manipulator, builtin:humanoid");
  EXPECT_EQ(refusal({"robot.model=urdf"}),
            "--set: robot.model: 'urdf' stands for a text that comes apart, as in a log; name a file");
  EXPECT_TRUE(refusal({"robot.model=nowhere.urdf"})
                  .starts_with("--set: robot.model: 'nowhere.urdf' cannot be found (tried "));
  EXPECT_TRUE(refusal({"robot.model=models/simple_3dof_amr.urdf"})
                  .starts_with("--set: robot.model: 'models/simple_3dof_amr.urdf' cannot be found; did you "
                               "mean 'models/simple_3dof_arm.urdf'? (tried "));
  EXPECT_EQ(refusal({"robot.armature=[1, 2]"}),
            "--set: robot.armature: has 2 numbers, but 'simple_3dof_arm' has 3 joints (joint1_base_rotation, "
            "joint2_shoulder, joint3_elbow)");
  EXPECT_NE(refusal({"robot.floating_base=true", "planner.kind=hold", "controller.kind=none"})
                .find("there is no ground yet"),
            std::string::npos);
  // a file that is no robot: the loader's own line
  EXPECT_NE(refusal({"robot.model=" + lab::source_path("CMakeLists.txt")}).find("CMakeLists.txt:"),
            std::string::npos);
}

TEST(Check, StabilityRatioIsOneAtTheLimit) {
  // one mass: simulate x'' = -(kp x + kd x') / m by semi-implicit Euler just inside and outside the limit
  const double m = 0.3, h = 0.01;
  for (double kp : {0.0, 50.0, 2000.0}) {
    const double kd = (2 - h * h * kp / (2 * m)) * m / h;  // ratio 1
    const Eigen::MatrixXd Minv = Eigen::MatrixXd::Constant(1, 1, 1 / m);
    const auto one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
    EXPECT_NEAR(stability_ratio(Minv, one(kp), one(kd), h), 1, 1e-12);
    for (double factor : {0.98, 1.02}) {
      double x = 0.1, v = 1;
      for (int k = 0; k < 2000; ++k) {
        v -= h * (kp * x + factor * kd * v) / m;
        x += h * v;
      }
      EXPECT_EQ(std::abs(v) < 1, factor < 1) << kp << " " << factor << " " << v;
    }
  }
}

TEST(Check, StabilityRatioTakesTheWorstMode) {
  // M with eigenvalues 0.1 and 10, turned by 0.5 rad
  const double c = std::cos(0.5), s = std::sin(0.5);
  const Eigen::Matrix2d R{{c, -s}, {s, c}};
  const Eigen::MatrixXd Minv = R * Eigen::Vector2d(10, 0.1).asDiagonal() * R.transpose();
  EXPECT_NEAR(stability_ratio(Minv, Eigen::VectorXd::Zero(2), Eigen::VectorXd::Constant(2, 5), 0.01),
              0.01 * 5 / 0.1 / 2, 1e-9);
}

TEST(Check, WarnsBeyondHalfOfTheLimit) {
  const auto warnings = [](const std::vector<std::string>& set) {
    const Experiment e = arm3(set);
    return check(e, load_robot(e));
  };
  EXPECT_TRUE(warnings({}).empty());
  // kd dt / (2 lambda): lambda is the rotor's 0.2 plus little, so kd 21 is just beyond the half
  ASSERT_EQ(warnings({"controller.kd=21"}).size(), 1u);
  EXPECT_NE(warnings({"controller.kd=21"})[0].find("--set: controller.kd: warning: the gains are at 5"),
            std::string::npos);
  EXPECT_TRUE(warnings({"controller.kd=18"}).empty());
  EXPECT_TRUE(warnings({"controller.kd=21", "simulator.dt=0.005"}).empty());
  EXPECT_EQ(warnings({"controller.kd=21", "simulator.dt=0.005", "controller.every=2"}).size(), 1u);
  ASSERT_EQ(warnings({"robot.armature=0"}).size(), 1u);
  EXPECT_NE(warnings({"robot.armature=0"})[0].find("it will not hold"), std::string::npos);
  EXPECT_EQ(warnings({"simulator.damping=30"}).size(), 1u);
  EXPECT_EQ(warnings({"planner.duration=0.3"}).size(), 3u);  // every joint faster than it may
  EXPECT_EQ(warnings({"simulator.duration=2.999", "planner.duration=3"}).size(), 1u);
}

TEST(Procfile, ListsTheProcessesOfARun) {
  Experiment e = arm3();
  EXPECT_EQ(procfile(e, "runs/a b"),
            "#lab: simulator required=yes restart=never\n"
            "simulator: exec lab-simulator --experiment 'runs/a b/experiment.yaml' --run-dir 'runs/a b'\n"
            "#lab: planner required=yes restart=never\n"
            "planner: exec lab-planner --run-dir 'runs/a b'\n"
            "#lab: controller required=yes restart=never\n"
            "controller: exec lab-controller --run-dir 'runs/a b'\n"
            "#lab: logger required=yes restart=never\n"
            "logger: exec lab-logger --run-dir 'runs/a b'\n"
            "#lab: renderer required=no restart=never\n"
            "renderer: exec lab-renderer --run-dir 'runs/a b'\n");
  e = arm3({"renderer.enabled=false", "processes.controller=python3 my.py {run_dir}",
            "processes.extra=lab-spy", "faults.drop=5", "seed=7"});
  const std::string text = procfile(e, "r");
  EXPECT_NE(text.find("controller: export LAB_FAULT_DROP=5,7; python3 my.py r\n"), std::string::npos) << text;
  EXPECT_NE(text.find("extra: export LAB_FAULT_DROP=5,7; lab-spy\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("renderer"), std::string::npos) << text;
}

}  // namespace
}  // namespace lab
