// The renderer as a participant, alone with messages made by hand and a clock of numbers: what it waits for, what it draws and how
// it ends.
#include "procs/renderer/role.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <lab/end_t.hpp>
#include <lab/robot_state_t.hpp>

#include "lab/run/run.h"
#include "tests/procs/renderer/sample.h"
#include "tests/support/paths.h"
#include "tests/wire/protocol/message.h"
#include "wire/log/log_writer.h"
#include "wire/schema/codec.h"

namespace lab::renderer {
namespace {

/// A run of 200 steps, of which every fiftieth is drawn.
class RoleTest : public testing::Test {
 protected:
  RoleTest() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~RoleTest() override { std::filesystem::remove_all(folder_); }

  void tick(Micros now) { role_.tick(now_ = now); }
  void hear_run() { role_.receive(Channel::Run, encode(run_), now_); }
  Bytes state(int64_t step, int64_t run) const {
    auto m = message_of<robot_state_t>(run, step);
    m.nq = m.nv = 6;
    m.q = {-0.5, 0.6, -1.0, 0, 0.4, 0.001 * static_cast<double>(step)};
    m.v = m.tau = std::vector<double>(6);
    return encode(m);
  }
  void hear_state(int64_t step, int64_t run = 0) {
    role_.receive(Channel::RobotState, state(step, run == 0 ? run_.run : run), now_);
  }
  void hear_end(int64_t step) {
    role_.receive(Channel::End, encode(message_of<end_t>(run_.run, step)), now_);
  }
  /// Draws what it can now.
  void draw() {
    for (int n = 0; n < 10 && !role_.outcome().ended; ++n) tick(now_ + 1);
  }

  std::string folder_ = lab::build_path("tests/procs/renderer/role_test");
  Experiment experiment_ = sample_experiment("{fps: 2, size: [160, 120]}");
  run_t run_ = make_run(experiment_, load_robot(experiment_));
  std::vector<int64_t> frames_;  // steps, as told
  Micros now_ = 0;
  RendererRole role_{[this] {
                       Experiment settings = experiment_;
                       settings.ready = 0.15;
                       settings.deadline = 0.2;
                       return settings;
                     }(),
                     folder_,
                     [this](Channel channel, std::span<const uint8_t> bytes) {
                       EXPECT_EQ(channel, Channel::Frame);
                       frames_.push_back(decode<frame_t>(bytes).step);
                     }};
};

TEST_F(RoleTest, WithoutARunItEndsAfterTheTimeItWasGiven) {
  tick(0);
  EXPECT_EQ(role_.state(), "STARTING");
  tick(150'000);
  EXPECT_FALSE(role_.outcome().ended);
  tick(150'001);
  EXPECT_TRUE(role_.outcome().ended);
  EXPECT_EQ(role_.outcome().exit_code, kNotReady);
  EXPECT_EQ(role_.outcome().reason, "no RUN from the simulator in 0.15 s");
}

TEST_F(RoleTest, StoppedBeforeARunItHasNotFailed) {
  role_.stop(0);
  tick(1);
  EXPECT_TRUE(role_.outcome().ended);
  EXPECT_EQ(role_.outcome().exit_code, kOk);
  EXPECT_EQ(role_.outcome().reason, "");
}

TEST_F(RoleTest, DrawsTheStatesOfItsRunInOrder) {
  hear_state(0);  // before RUN nothing is known
  hear_run();
  EXPECT_EQ(role_.state(), "READY");
  hear_run();  // somebody else has asked for it again
  hear_state(0, run_.run + 1);
  draw();
  EXPECT_EQ(role_.step(), -1) << "drew a state of another run, or none";
  for (int64_t step : {100, 50, 1, 0, 51}) hear_state(step);
  draw();
  EXPECT_EQ(role_.step(), 100);
  EXPECT_EQ(role_.state(), "RUNNING");
  for (int64_t step = 101; step <= 200; ++step) hear_state(step);
  draw();
  EXPECT_FALSE(role_.outcome().ended) << "END has not come";
  hear_end(200);
  draw();
  ASSERT_TRUE(role_.outcome().ended);
  EXPECT_EQ(role_.outcome().exit_code, kOk) << role_.outcome().reason;
  EXPECT_EQ(frames_, (std::vector<int64_t>{0, 50, 100, 150, 200}));
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/contact.png"));
}

TEST_F(RoleTest, FillsGapsFromTheLog) {
  LogWriter log(folder_ + "/log.lcm");
  for (const int64_t step : {0, 50, 100}) log.add(step, "ROBOT_STATE", state(step, run_.run));
  log.flush();
  hear_run();
  for (const int64_t step : {0, 100, 150, 200}) hear_state(step);  // 50 was lost
  hear_end(200);
  draw();
  EXPECT_EQ(frames_, (std::vector<int64_t>{0, 50, 100, 150, 200}));
}

TEST_F(RoleTest, OfARunThatBreaksOffItKeepsWhatItHas) {
  hear_run();
  hear_state(0);
  hear_state(50);
  draw();
  tick(now_ + 199'000);
  EXPECT_FALSE(role_.outcome().ended);
  tick(now_ + 2'000);
  ASSERT_TRUE(role_.outcome().ended);
  EXPECT_EQ(role_.outcome().exit_code, kOk);
  EXPECT_EQ(frames_, (std::vector<int64_t>{0, 50}));
}

}  // namespace
}  // namespace lab::renderer
