// The scenes of a run: who stands where, and what the camera sees of it. No OpenGL.
#include "procs/renderer/stage.h"

#include <gtest/gtest.h>
#include <rbd/algorithm/kinematics.h>

#include <cmath>

#include "tests/procs/renderer/sample.h"

namespace lab::renderer {
namespace {

using render::Body;

void remember_all(Stage& stage, const rbd::Model& model, int64_t last = 200, double error = 0) {
  for (int64_t step = 0; step <= last; ++step) stage.remember(sample_moment(model, step, error));
}

TEST(Stage, SamplesAreTenMillisecondsApartButNotMoreThanAThousand) {
  Experiment e = sample_experiment();
  EXPECT_EQ(sample_gap(e), 1);
  e.simulator.dt = 0.001;
  EXPECT_EQ(sample_gap(e), 10);
  e.simulator.dt = 0.02;
  EXPECT_EQ(sample_gap(e), 1);
  e.simulator.dt = 0.001, e.simulator.duration = 100;
  EXPECT_EQ(sample_gap(e), 100);
}

TEST(Stage, GhostsStandEvenlyAlongTheWay) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  Stage stage(robot, e);
  remember_all(stage, robot.model);  // the last quarter of it at rest
  constexpr int kPoses = 6;
  const render::Scene scene = stage.ghosts(kPoses);
  // Along a straight way in joint space, even steps are even steps of joint 1, whatever the time law is: 1.2 rad / 5.
  std::map<int, double> yaw;  // by group; 0 = the solid one
  for (const Body& body : scene.bodies) {
    if (body.name != robot.model.names[1]) continue;
    yaw[body.group] = std::atan2(body.pose.linear()(1, 0), body.pose.linear()(0, 0));
    EXPECT_EQ(body.opacity < 1, body.group != 0);
    EXPECT_EQ(body.casts_shadow, body.group == 0);
  }
  ASSERT_EQ(yaw.size(), static_cast<size_t>(kPoses));
  // The fastest sample covers 1.2 * 1.875 * 0.01 / 1.5 rad; the nearest one is at most half of that away.
  const double half_a_sample = 1.2 * 1.875 * 0.01 / 1.5 / 2;
  for (int k = 0; k + 1 < kPoses; ++k)
    EXPECT_NEAR(yaw[k + 1], -0.5 + 1.2 * k / (kPoses - 1), half_a_sample) << k;
  EXPECT_NEAR(yaw[0], 0.7, 1e-12);
}

TEST(Stage, GhostsAreTintedFromBlueToRed) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  Stage stage(robot, e);
  remember_all(stage, robot.model);
  std::map<int, Eigen::Vector4f> tint;
  for (const Body& body : stage.ghosts(5).bodies) tint[body.group] = body.tint;
  EXPECT_GT(tint[1][2], tint[1][0]);
  for (int k = 2; k <= 4; ++k) EXPECT_GT(tint[k][0], tint[k - 1][0]);
  EXPECT_EQ(tint[0][3], 0) << "the last one has its own colours";
}

TEST(Stage, WhatStandsStillHasNoGhost) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  Stage stage(robot, e);
  remember_all(stage, robot.model);
  int bases = 0;
  for (const Body& body : stage.ghosts(6).bodies) bases += body.name == "universe";
  EXPECT_EQ(bases, 1);
  Stage resting(robot, e);
  for (int64_t step = 0; step < 9; ++step) {
    Moment moment = sample_moment(robot.model, 0);
    moment.step = step;
    resting.remember(moment);
  }
  for (const Body& body : resting.ghosts(6).bodies) EXPECT_EQ(body.group, 0);
}

TEST(Stage, TheReferenceIsAGhostOnlyWhereItIsNotTheRobot) {
  const Experiment e = sample_experiment("{reference: true}");
  const Robot robot = load_robot(e);
  Stage stage(robot, e);
  const auto ghosts = [&](double error) {
    int n = 0;
    for (const Body& body : stage.scene(sample_moment(robot.model, 50, error)).bodies) n += body.group != 0;
    return n;
  };
  EXPECT_EQ(ghosts(0), 0);
  EXPECT_EQ(ghosts(0.2), 6) << "all but the base";
}

TEST(Stage, PicturesDoNotDependOnWhatComesLater) {  // live pictures are those from the log
  const Experiment e = sample_experiment("{trace: effector_body}");
  const Robot robot = load_robot(e);
  Stage live(robot, e), after(robot, e);
  remember_all(live, robot.model, 80);
  remember_all(after, robot.model, 200);
  const Moment now = sample_moment(robot.model, 80);
  const render::Scene a = live.scene(now), b = after.scene(now);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  const auto &one = *a.bodies[0].parts[0].mesh, &other = *b.bodies[0].parts[0].mesh;
  EXPECT_EQ(a.bodies[0].name, "trace");
  EXPECT_EQ(one.positions, other.positions);
  EXPECT_EQ(one.colours, other.colours);
}

TEST(Stage, TheCameraKeepsToThePlanUnlessTheRunLeftIt) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  const auto eye = [&](double error) {
    Stage stage(robot, e);
    remember_all(stage, robot.model, 200, error);
    stage.frame_all();
    return stage.camera(sample_moment(robot.model, 0)).eye;
  };
  EXPECT_EQ(eye(0.01), Stage(robot, e).camera(sample_moment(robot.model, 0)).eye);
  const Eigen::Vector3d far = eye(2.5);
  EXPECT_NE(far, eye(0));
  // and then everything is in the picture
  Stage stage(robot, e);
  remember_all(stage, robot.model, 200, 2.5);
  stage.frame_all();
  for (int64_t step = 0; step <= 200; step += 20) {
    const Moment moment = sample_moment(robot.model, step, 2.5);
    for (const Body& body : stage.scene(moment).bodies) {
      const render::Bounds box = render::bounds(body);
      for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d pixel =
            stage.camera(moment).pixel(box.corner(static_cast<render::Bounds::CornerType>(i)), 640, 480);
        EXPECT_TRUE(pixel.x() > 0 && pixel.x() < 640 && pixel.y() > 0 && pixel.y() < 480) << body.name;
      }
    }
  }
}

TEST(Stage, AFollowedFrameStaysWhereItIsInThePicture) {
  const Experiment e = sample_experiment("{follow: effector_body}");
  const Robot robot = load_robot(e);
  Stage stage(robot, e);
  rbd::Data data(robot.model);
  std::vector<Eigen::Vector3d> pixels;
  for (int64_t step : {0, 60, 90, 200}) {
    const Moment moment = sample_moment(robot.model, step);
    rbd::forwardKinematics(robot.model, data, moment.q);
    pixels.push_back(
        stage.camera(moment).pixel(data.oMf[robot.model.frameId("effector_body")].translation(), 640, 480));
  }
  for (const Eigen::Vector3d& pixel : pixels) EXPECT_LT((pixel - pixels[0]).norm(), 1e-9);
}

TEST(Stage, AnOrbitGoesRoundAtItsSpeed) {
  const Experiment e = sample_experiment("{orbit: 0.5}");
  const Robot robot = load_robot(e);
  Stage stage(robot, e);
  const render::Camera a = stage.camera(sample_moment(robot.model, 0)),
                       b = stage.camera(sample_moment(robot.model, 200));
  const Eigen::Vector3d from = a.eye - a.target, to = b.eye - b.target;
  EXPECT_LT((a.target - b.target).norm(), 1e-12);
  EXPECT_NEAR(from.z(), to.z(), 1e-12);
  EXPECT_NEAR(std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x()), 1.0, 1e-12);
}

TEST(Stage, UnknownFramesAreNamedWithWhatIsNear) {
  for (const std::string key : {"trace", "follow"}) {
    const Experiment e = sample_experiment("{" + key + ": efector_body}");
    try {
      Stage stage(load_robot(e), e);
      FAIL();
    } catch (const ExperimentError& error) {
      EXPECT_EQ(std::string(error.what()),
                "sample:4: renderer." + key + ": no frame 'efector_body'; did you mean 'effector_body'?");
    }
  }
}

}  // namespace
}  // namespace lab::renderer
