// The direct loop against lab-solo's log: every logged state and reference, bit for bit, and the same metrics.
#include "procs/solo/direct.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lab/evaluation/read_run.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/run/run.h"
#include "procs/logger/log_files.h"
#include "procs/solo/solo.h"
#include "tests/support/paths.h"

namespace lab {
namespace {

bool same_bits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<size_t>(a.size())) == 0;
}

struct Case {
  const char* file;
  std::vector<std::string> overrides;
  const char* ends = "";  ///< in the reason of a run that ends early
};

class Direct : public testing::TestWithParam<Case> {};

TEST_P(Direct, GivesWhatTheLogOfLabSoloHolds) {
  const Case& c = GetParam();
  const Experiment e = load_experiment(lab::source_path("experiments/") + c.file, c.overrides);
  const Robot robot = load_robot(e);
  const std::optional<lab::Run> direct = solo::run_direct(e, robot.model);
  ASSERT_TRUE(direct.has_value());

  char name[] = "/tmp/lab-direct-test-XXXXXX";
  const std::string dir = mkdtemp(name);
  Outcome outcome;
  {
    logger::LogFiles files(dir);
    outcome = solo::run(e, robot, files, [](int64_t) { return true; });
  }
  const bool closed = std::filesystem::exists(dir + "/log.lcm");
  if (closed) {
    const LoggedRun logged = read_run(dir + "/log.lcm");
    ASSERT_EQ(direct->steps.size(), logged.run.steps.size());
    StepReader ours(direct->steps), theirs(logged.run.steps);
    for (size_t k = 0; k < direct->steps.size(); ++k) {
      const auto& [a, r, stored, work] = ours.at(k);
      const auto& [b, s, logged_stored, logged_work] = theirs.at(k);
      ASSERT_EQ(a.step, b.step);
      ASSERT_TRUE(a.time == b.time && same_bits(a.q, b.q) && same_bits(a.v, b.v) && same_bits(a.tau, b.tau))
          << "state " << a.step;
      ASSERT_EQ(r.step, s.step);
      ASSERT_TRUE(same_bits(r.q, s.q) && same_bits(r.v, s.v) && same_bits(r.a, s.a))
          << "reference " << r.step;
      ASSERT_TRUE(stored == logged_stored && work == logged_work) << "energy " << a.step;
    }
    EXPECT_EQ(evaluate(*direct, e.expect).dump(), evaluate(logged.run, logged.experiment.expect).dump());
  }
  EXPECT_EQ(direct->aborted, outcome.exit_code != kOk);
  EXPECT_EQ(direct->reason, outcome.reason);
  EXPECT_NE(direct->reason.find(c.ends), std::string::npos) << direct->reason;
  EXPECT_EQ(direct->aborted, *c.ends != 0);
  std::filesystem::remove_all(dir);
}

INSTANTIATE_TEST_SUITE_P(
    Experiments, Direct,
    testing::Values(
        Case{"cubic_pd.yaml", {}}, Case{"arm3_cubic_pd.yaml", {}},
        Case{"arm3_sinusoid_ct.yaml", {"simulator.duration=1"}},
        Case{"point_to_point.yaml", {"simulator.duration=3"}},
        Case{"free_swing.yaml", {"simulator.duration=1"}}, Case{"cubic_pd.yaml", {"planner.lead=0"}},
        Case{"cubic_pd.yaml", {"planner.lead=128", "simulator.duration=0.5"}},
        Case{"sinusoid_ct.yaml", {"controller.every=7", "simulator.integrator=rk4", "simulator.duration=1"}},
        // a dt that is no whole number of microseconds, a log with every third step and the last
        Case{"sinusoid_pd.yaml", {"logger.every=3", "simulator.dt=0.0012345", "simulator.duration=1"}},
        // efforts at their limits, dry friction, a controller that is wrong about the masses
        Case{"cubic_pd.yaml",
             {"controller.kp=1e6", "controller.kind=pd_gravity", "controller.model.mass_scale=1.5",
              "simulator.friction=0.3", "simulator.damping=0.1"}},
        // what sensors say is not the truth; a payload, pushes, soft stops
        Case{"noise_and_delay.yaml", {"planner.lead=2", "controller.every=3"}},
        Case{"payload.yaml", {"evaluation.band=0.05", "evaluation.frame=arm_tool_link"}},
        Case{"pushed.yaml", {}}, Case{"joint_limits.yaml", {}},
        Case{"payload.yaml", {"simulator.noise.v=0.01", "simulator.delay=0.003"}},
        Case{"waypoints.yaml", {"simulator.duration=1"}}, Case{"circle_arm3.yaml", {"simulator.duration=1"}},
        Case{"line_arm.yaml", {"simulator.duration=1"}},
        // two ways to end early
        Case{"arm3_cubic_pd.yaml", {"simulator.damping=1e6"}, "diverged"},
        Case{"sinusoid_pd.yaml",
             {"controller.kp=1.7e308", "planner.amplitude=1.5", "planner.phase=1.57"},
             "not finite"}),
    [](const auto& info) { return "Case" + std::to_string(info.index); });

TEST(DirectLoop, CanBeStopped) {
  const Experiment e =
      load_experiment(lab::source_path("experiments/live.yaml"), {"simulator.clock=lockstep"});
  int asked = 0;
  EXPECT_FALSE(solo::run_direct(e, load_robot(e).model, [&] { return ++asked < 3; }).has_value());
  EXPECT_EQ(asked, 3);
}

// The id by which messages of other runs are told from ours.
TEST(RunNumber, IsAHashInLockstepAndNewAtEveryStartInRealTime) {
  const auto id = [](const char* file, std::vector<std::string> overrides) {
    const Experiment e = load_experiment(lab::source_path("experiments/") + file, overrides);
    return make_run(e, load_robot(e)).run;
  };
  const int64_t one = id("arm3_cubic_pd.yaml", {});
  EXPECT_EQ(id("arm3_cubic_pd.yaml", {}), one);
  EXPECT_NE(id("arm3_cubic_pd.yaml", {"seed=7"}), one);
  EXPECT_NE(id("arm3_cubic_pd.yaml", {"controller.kp=1"}), one) << "experiment";
  EXPECT_NE(id("arm3_cubic_pd.yaml", {"robot.armature=0.3"}), one) << "model";
  const std::vector<std::string> live{"simulator.clock=realtime"};
  EXPECT_NE(id("arm3_cubic_pd.yaml", live), id("arm3_cubic_pd.yaml", live));
}

}  // namespace
}  // namespace lab
