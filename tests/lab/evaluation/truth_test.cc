// A run with noise and delay, written by solo and read back: the metrics are of the robot, not of its sensors.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <lab/command_t.hpp>
#include <lab/robot_state_t.hpp>
#include <nlohmann/json.hpp>

#include "lab/evaluation/read_run.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/run/run.h"
#include "procs/logger/log_files.h"
#include "procs/solo/direct.h"
#include "procs/solo/solo.h"
#include "tests/support/paths.h"
#include "wire/log/log_reader.h"
#include "wire/log/log_writer.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

class Truth : public testing::Test {
 protected:
  Truth() {
    char name[] = "/tmp/lab-truth-test-XXXXXX";
    dir_ = mkdtemp(name);
    experiment_ = load_experiment(
        lab::source_path("experiments/noise_and_delay.yaml"),
        {"simulator.duration=0.4",
         "simulator.pushes=[{time: 0.1, duration: 0.1, frame: effector_body, force: [20, 0, 5]}]",
         "simulator.payloads=[{time: 0.2, frame: effector_body, mass: 1}]", "controller.every=3",
         "simulator.integrator=rk4"});
    robot_ = load_robot(experiment_);
    logger::LogFiles files(dir_);
    outcome_ = solo::run(experiment_, robot_, files, [](int64_t) { return true; });
  }
  ~Truth() override { fs::remove_all(dir_); }

  std::string log() const { return dir_ + "/log.lcm"; }
  /// Writes the log again with every message as `change` leaves it, and the digests of that; what it says no to is left out.
  void rewrite(const std::function<bool(Channel, Bytes&)>& change) {
    LogReader reader(log());
    LogWriter writer(dir_ + "/other.lcm");
    StepRecord record;
    for (LogEvent event; reader.next(event);) {
      const Channel channel = *channel_of(event.channel);
      Bytes bytes(event.data.begin(), event.data.end());
      if (!change(channel, bytes)) continue;
      if (channel == Channel::RobotState) {
        auto state = decode<robot_state_t>(bytes);
        if (state.step > 0) state.digest = record.digest();
        bytes = encode(state);
        record.clear(state.step);
      }
      record.store(channel, bytes, false);
      writer.add(event.utime, event.channel, bytes);
    }
    writer.finish();
  }
  std::string complaint() {
    try {
      read_run(dir_ + "/other.lcm");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  }

  std::string dir_;
  Experiment experiment_;
  Robot robot_;
  Outcome outcome_;
};

TEST_F(Truth, ComesBackFromTheLogToTheLastBit) {
  ASSERT_EQ(outcome_.exit_code, kOk) << outcome_.reason;
  const LoggedRun back = read_run(log());
  const lab::Run run = *solo::run_direct(experiment_, robot_.model);  // the same steps without any log
  ASSERT_EQ(back.run.steps.size(), run.steps.size());
  for (size_t k = 0; k < run.steps.size(); ++k) {
    ASSERT_EQ(back.run.steps[k].state.q, run.steps[k].state.q) << k;
    ASSERT_EQ(back.run.steps[k].state.v, run.steps[k].state.v) << k;
  }
  const nlohmann::json metrics = evaluate(back.run, {});
  EXPECT_EQ(metrics, evaluate(run, {}));
  EXPECT_LT(metrics["energy_drift_relative"].get<double>(), 1e-9)
      << "a push's force, a payload and rk4 balance";

  // the log itself has what the sensors said: 5 steps old, and noisy
  LogReader reader(log());
  int64_t states = 0;
  for (LogEvent event; reader.next(event);) {
    if (event.channel != "ROBOT_STATE") continue;
    const auto message = decode<robot_state_t>(event.data);
    const RobotState was = run.steps[static_cast<size_t>(std::max<int64_t>(message.step - 5, 0))].state;
    for (int i = 0; i < 6; ++i) {
      ASSERT_NE(message.q[i], was.q[i]);
      ASSERT_LT(std::abs(message.q[i] - was.q[i]), 8.6 * 1e-4);
    }
    ++states;
  }
  EXPECT_EQ(states, 401);
}

TEST_F(Truth, IsRefusedWhenTheLogDoesNotFollowFromItself) {
  rewrite([](Channel, Bytes&) { return true; });
  EXPECT_EQ(complaint(), "none");
  rewrite([](Channel channel, Bytes& bytes) {
    if (channel != Channel::Command) return true;
    auto message = decode<command_t>(bytes);
    if (message.step == 30) message.tau[1] = std::nextafter(message.tau[1], 1e9), bytes = encode(message);
    return true;
  });
  EXPECT_TRUE(complaint().starts_with(
      dir_ + "/other.lcm: the log does not follow from its own commands: at step 31 "))
      << complaint();
  rewrite([](Channel channel, Bytes& bytes) {
    return channel != Channel::Command || decode<command_t>(bytes).step != 60;
  });
  EXPECT_EQ(complaint(), dir_ + "/other.lcm: COMMAND 60, which led to step 61, is not in the log");
  rewrite([](Channel channel, Bytes& bytes) {
    return channel != Channel::RobotState || decode<robot_state_t>(bytes).step != 7;
  });
  EXPECT_EQ(complaint(), dir_ + "/other.lcm: step 7 is not in the log; the true states need every step");
}

// Planner and controller, when they restart, fold the log of their run: a step that is not what was written is left out.
TEST_F(Truth, WhoRestartsIsGivenWholeStepsOnly) {
  const auto steps = [](const std::string& path, int64_t run) {
    size_t count = 0;
    log_reader(path)(
        run, [&](Channel channel, std::span<const uint8_t>) { count += channel == Channel::RobotState; });
    return count;
  };
  const int64_t run = read_run(log()).id;
  EXPECT_EQ(steps(log(), run), 401u);
  std::fstream file(log(), std::ios::in | std::ios::out | std::ios::binary);
  LogReader reader(log());
  for (LogEvent event; reader.next(event);) {
    if (event.channel != "ROBOT_STATE" || peek_step(event.data) != 200) continue;
    file.seekp(static_cast<std::streamoff>(event.offset + event.bytes.size() - 50));
    file.put(static_cast<char>(event.data[event.data.size() - 50] ^ 1));
  }
  file.close();
  EXPECT_EQ(steps(log(), run), 400u);
}

}  // namespace
}  // namespace lab
