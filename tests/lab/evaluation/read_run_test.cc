// A run written to a log and read back; and the program lab-experiment on its folder.
#include "lab/evaluation/read_run.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <lab/end_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <nlohmann/json.hpp>

#include "core/util/atomic_file.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/robot.h"
#include "procs/solo/direct.h"
#include "tests/lab/evaluation/by_hand.h"
#include "tests/support/paths.h"
#include "wire/log/log_writer.h"
#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Folder : public testing::Test {
 protected:
  Folder() {
    char name[] = "/tmp/lab-experiment-test-XXXXXX";
    dir_ = mkdtemp(name);
  }
  ~Folder() override { fs::remove_all(dir_); }

  /// Writes experiment.yaml and log.lcm of a run; without END if `cut`.
  void write_run(const Experiment& e, const Robot& robot, const lab::Run& run, bool cut = false) {
    write_atomically(dir_ + "/experiment.yaml", resolve(e));
    LogWriter log(dir_ + "/log.lcm");
    run_t head{};
    head.run = 77, head.step = -1;
    head.experiment = canonical(e);
    head.urdf = robot.urdf;
    head.model_hash = robot.hash;
    head.nq = robot.model.nq, head.nv = robot.model.nv;
    for (int j = 1; j < robot.model.njoints; ++j) head.joint_names.push_back(robot.model.names[j]);
    head.njoints = static_cast<int32_t>(head.joint_names.size());
    log.add(0, "RUN", encode(head));
    for (size_t k = 0; k < run.steps.size(); ++k) {
      const RunStep step = run.steps[k];
      robot_state_t state{};
      to_message(step.state, state);
      state.run = 77, state.step = step.state.step, state.utime = step_utime(state.step, run.dt);
      state.command_step = state.step - 1;
      log.add(state.utime, "ROBOT_STATE", encode(state));
      reference_t reference{};
      to_message(step.reference, reference);
      reference.run = 77, reference.step = state.step, reference.utime = state.utime;
      log.add(state.utime, "REFERENCE", encode(reference));
    }
    end_t end{};
    end.run = 77, end.step = run.steps.back().state.step, end.utime = step_utime(end.step, run.dt);
    if (!cut) log.add(end.utime, "END", encode(end));
    log.finish();
  }

  /// Runs lab-experiment; its words go to out_.
  int call(const std::string& arguments) {
    const int status = std::system(
        (lab::build_path("bin/lab-experiment") + " " + arguments + " > " + dir_ + "/out 2>&1").c_str());
    std::stringstream text;
    text << std::ifstream(dir_ + "/out").rdbuf();
    out_ = text.str();
    return WEXITSTATUS(status);
  }

  std::string dir_, out_;
};

TEST_F(Folder, ARunComesBackFromItsLog) {
  Experiment e =
      load_experiment(lab::source_path("experiments/arm3_cubic_pd.yaml"), {"simulator.damping=0.1"});
  e.robot.model = find_model(e);
  const Robot robot = load_robot(e);
  const lab::Run run = *solo::run_direct(e, robot.model);
  write_run(e, robot, run);
  const LoggedRun back = read_run(dir_ + "/log.lcm");
  EXPECT_EQ(back.id, 77);
  EXPECT_EQ(back.robot.hash, robot.hash);
  EXPECT_FALSE(back.run.aborted);
  EXPECT_EQ(evaluate(back.run, e.expect),
            evaluate(run, e.expect));  // bit for bit: the wire carries doubles whole

  EXPECT_EQ(call("evaluate " + dir_), 0) << out_;
  EXPECT_NE(out_.find("joint2_shoulder"), std::string::npos) << out_;
  EXPECT_NE(out_.find("ok      final_error"), std::string::npos) << out_;
  const json metrics = json::parse(std::ifstream(dir_ + "/metrics.json"));
  EXPECT_EQ(metrics["max_error"], evaluate(run, {})["max_error"]);
  EXPECT_EQ(metrics["run"], "000000000000004d");

  EXPECT_EQ(call("manifest " + dir_ + " --exit simulator=0 --exit planner=5 --wall 1.5"), 0) << out_;
  const json manifest = json::parse(std::ifstream(dir_ + "/manifest.json"));
  EXPECT_EQ(manifest["exit_codes"]["planner"], 5);
  EXPECT_EQ(manifest["wall_seconds"], 1.5);
  EXPECT_EQ(manifest["passed"], true);
  EXPECT_EQ(manifest["hashes"]["log.lcm"].get<std::string>().size(), 16u);
  EXPECT_TRUE(manifest["hashes"]["telemetry.lcm"].is_null());
  EXPECT_EQ(manifest["experiment"], "arm3_cubic_pd");
}

TEST_F(Folder, AVerdictThatFailsIsExitCodeOne) {
  const Experiment e =
      load_experiment(lab::source_path("experiments/cubic_pd.yaml"), {"expect.max_error.max=0.001"});
  const Robot robot = load_robot(e);
  write_run(e, robot, *solo::run_direct(e, robot.model));
  EXPECT_EQ(call("evaluate " + dir_), 1);
  EXPECT_NE(out_.find("FAILED  max_error 0.8"), std::string::npos) << out_;
}

TEST_F(Folder, ALogWithoutEndIsARunThatFailed) {
  const Experiment e = load_experiment(lab::source_path("experiments/cubic_pd.yaml"));
  const Robot robot = load_robot(e);
  lab::Run run = *solo::run_direct(e, robot.model);
  test::keep_first(run, 100);
  write_run(e, robot, run, true);
  EXPECT_EQ(call("evaluate " + dir_), 1);
  EXPECT_NE(out_.find("FAILED  the run ended at step 99 of 300: the log has no END"), std::string::npos)
      << out_;
}

TEST_F(Folder, FaultsAreOneLineAndTheRightExitCode) {
  const std::string yaml = lab::source_path("experiments/cubic_pd.yaml");
  const auto one_line = [&] { return std::count(out_.begin(), out_.end(), '\n') == 1; };
  EXPECT_EQ(call("check " + yaml), 0) << out_;
  EXPECT_EQ(out_, yaml + ": ok (manipulator, nq 6, nv 6; 300 steps of 0.01 s)\n");
  EXPECT_EQ(call("check " + yaml + " --set controler.kp=1"), 3);
  EXPECT_EQ(out_, "lab-experiment: --set: unknown section 'controler'; did you mean 'controller'?\n");
  EXPECT_EQ(call("resolve " + yaml + " --set simulator.dt=0"), 3);
  EXPECT_EQ(out_, "lab-experiment: --set: simulator.dt: 0 is too small; give at least 1e-06 (s)\n");
  EXPECT_EQ(call("resolve " + yaml + " --set robot.model=gone.urdf"), 3);
  EXPECT_TRUE(one_line()) << out_;
  EXPECT_EQ(call("resolve " + yaml + " -o /proc/nowhere/experiment.yaml"), 3);
  EXPECT_EQ(out_,
            "lab-experiment: /proc/nowhere/experiment.yaml: cannot be created (No such file or directory)\n");
  EXPECT_EQ(call("resolve " + yaml + " -o /dev/full/x"), 3);
  EXPECT_EQ(call("check /nowhere.yaml"), 3);
  EXPECT_EQ(out_, "lab-experiment: /nowhere.yaml: cannot be read (No such file or directory)\n");
  EXPECT_EQ(call("evaluate " + dir_), 3);
  EXPECT_TRUE(one_line()) << out_;
  EXPECT_EQ(call("frobnicate"), 2);
  EXPECT_EQ(call(""), 2);
  EXPECT_EQ(call("--help"), 0);
  EXPECT_NE(out_.find("example: lab-experiment check"), std::string::npos);
}

// a resolved experiment stands alone: it runs the same from another folder
TEST_F(Folder, ResolvedExperimentRunsTheSameElsewhere) {
  const std::string yaml = lab::source_path("experiments/arm3_sinusoid_ct.yaml"),
                    resolved = dir_ + "/experiment.yaml";
  ASSERT_EQ(call("resolve " + yaml + " --set controller.kp=90 -o " + resolved), 0) << out_;
  const Experiment before = load_experiment(yaml, {"controller.kp=90"}), after = load_experiment(resolved);
  EXPECT_EQ(canonical(after), canonical(before));
  EXPECT_EQ(load_robot(after).hash, load_robot(before).hash);
}

}  // namespace
}  // namespace lab
