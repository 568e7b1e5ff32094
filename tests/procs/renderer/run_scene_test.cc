// The scenes of a run: who stands where, and what the camera sees of it. No OpenGL.
#include "procs/renderer/run_scene.h"

#include <gtest/gtest.h>
#include <rbd/algorithm/kinematics.h>

#include <cmath>
#include <set>

#include "tests/procs/renderer/sample.h"

namespace lab::renderer {
namespace {

using render::Body;

void remember_all(RunScene& run, const rbd::Model& model, int64_t last = 200, double error = 0) {
  for (int64_t step = 0; step <= last; ++step) run.remember(sample_moment(model, step, error));
}

TEST(RunScene, SamplesAreTenMillisecondsApartButNotMoreThanAThousand) {
  Experiment e = sample_experiment();
  EXPECT_EQ(sample_gap(e), 1);
  e.simulator.dt = 0.001;
  EXPECT_EQ(sample_gap(e), 10);
  e.simulator.dt = 0.02;
  EXPECT_EQ(sample_gap(e), 1);
  e.simulator.dt = 0.001;
  e.simulator.duration = 100;
  EXPECT_EQ(sample_gap(e), 100);
}

TEST(RunScene, GhostsStandEvenlyAlongTheWay) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  remember_all(run, robot.model);  // the last quarter of it at rest
  constexpr int kPoses = 6;
  const render::Scene scene = run.ghosts(kPoses).scene;
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

TEST(RunScene, GhostsHaveTheirTraceWithABeadForEach) {
  const Experiment e = sample_experiment("{trace: effector_body}");
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  remember_all(run, robot.model);
  std::map<std::string, int> bodies;
  for (const Body& body : run.ghosts(6).scene.bodies) ++bodies[body.name];
  EXPECT_EQ(bodies["trace"], 1);
  EXPECT_EQ(bodies["bead"], 6);
}

TEST(RunScene, GhostsAreTintedFromBlueToRed) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  remember_all(run, robot.model);
  std::map<int, Eigen::Vector4f> tint;
  for (const Body& body : run.ghosts(5).scene.bodies) tint[body.group] = body.tint;
  EXPECT_GT(tint[1][2], tint[1][0]);
  for (int k = 2; k <= 4; ++k) EXPECT_GT(tint[k][0], tint[k - 1][0]);
  EXPECT_EQ(tint[0][3], 0) << "the last one has its own colours";
}

TEST(RunScene, WhatStandsStillHasNoGhost) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  remember_all(run, robot.model);
  int bases = 0;
  for (const Body& body : run.ghosts(6).scene.bodies) bases += body.name == "universe";
  EXPECT_EQ(bases, 1);
  RunScene resting(robot, e);
  for (int64_t step = 0; step < 9; ++step) {
    Snapshot snapshot = sample_moment(robot.model, 0);
    snapshot.step = step;
    resting.remember(snapshot);
  }
  for (const Body& body : resting.ghosts(6).scene.bodies) EXPECT_EQ(body.group, 0);
}

TEST(RunScene, TheReferenceIsAGhostOnlyWhereItIsNotTheRobot) {
  const Experiment e = sample_experiment("{reference: true}");
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  const auto ghosts = [&](double error) {
    int n = 0;
    for (const Body& body : run.shot(sample_moment(robot.model, 50, error)).scene.bodies)
      n += body.group != 0;
    return n;
  };
  EXPECT_EQ(ghosts(0), 0);
  EXPECT_EQ(ghosts(0.2), 6) << "all but the base";
}

TEST(RunScene, ASnapshotMayHaveNoVelocities) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  Snapshot snapshot = sample_moment(robot.model, 50);
  const std::vector<Body> moving = run.shot(snapshot).robot;
  run.shot(sample_moment(robot.model, 90));  // elsewhere
  snapshot.v.resize(0);
  const std::vector<Body> still = run.shot(snapshot).robot;
  ASSERT_EQ(moving.size(), still.size());
  for (size_t i = 0; i < still.size(); ++i)
    EXPECT_EQ(moving[i].pose.matrix(), still[i].pose.matrix()) << still[i].name;
}

TEST(RunScene, PicturesDoNotDependOnWhatComesLater) {  // live pictures are those from the log
  const Experiment e = sample_experiment("{trace: effector_body}");
  const Robot robot = load_robot(e);
  RunScene live(robot, e), after(robot, e);
  remember_all(live, robot.model, 80);
  remember_all(after, robot.model, 200);
  const Snapshot now = sample_moment(robot.model, 80);
  const render::Scene a = live.shot(now).scene, b = after.shot(now).scene;
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  const auto &one = *a.bodies[0].parts[0].mesh, &other = *b.bodies[0].parts[0].mesh;
  EXPECT_EQ(a.bodies[0].name, "trace");
  EXPECT_EQ(one.positions, other.positions);
  EXPECT_EQ(one.colours, other.colours);
}

/// The largest error seen so far has the end of the scale: colours go all the way to it.
TEST(RunScene, ATraceByErrorHasAColourForEachError) {
  const Experiment e = sample_experiment("{trace: effector_body}");
  const Robot robot = load_robot(e);
  RunScene run(robot, e, {"error", {}, {}});
  for (int64_t step = 0; step <= 100; ++step)
    run.remember(sample_moment(robot.model, step, 0.001 * static_cast<double>(step)));
  const render::Scene scene = run.shot(sample_moment(robot.model, 100, 0.1)).scene;
  std::set<std::vector<float>> colours;
  for (const auto& colour : scene.bodies[0].parts[0].mesh->colours)
    colours.insert({colour[0], colour[1], colour[2]});
  EXPECT_GT(colours.size(), 50u);
}

/// A film: each picture extends the trace of the one before. A picture's own share is the piece at the end.
TEST(RunScene, ATraceCostsThePictureTheSameHoweverLongItIs) {
  const Experiment e = sample_experiment("{trace: effector_body}");
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  remember_all(run, robot.model, 150);
  std::set<const render::Mesh*> kept;
  std::vector<render::MeshPtr> alive;  // no address is used twice
  size_t made = 0, largest = 0, last = 0, whole = 0;
  for (int64_t step = 10; step <= 140; ++step) {
    size_t own = 0;
    last = 0;
    const Shot shot = run.shot(sample_moment(robot.model, step));
    for (const render::Part& part : shot.scene.bodies[0].parts) {
      last += part.mesh->positions.size();
      if (!kept.insert(part.mesh.get()).second) continue;
      alive.push_back(part.mesh);
      own += part.mesh->positions.size();
    }
    made += own;
    largest = std::max(largest, own);
    whole += last;
  }
  const size_t piece =
      10 * (render::Trace::kPieceRings + 6);  // ten sides; the rings of the end and of its cap
  EXPECT_GT(last, 12 * render::Trace::kPieceRings) << "more than one piece";
  EXPECT_LE(largest, 2 * piece) << "one piece finished, one begun";
  EXPECT_LT(made, whole * 3 / 4);
}

TEST(RunScene, PicturesOutOfOrderHaveTheSameTrace) {
  const Experiment e = sample_experiment("{trace: effector_body}");
  const Robot robot = load_robot(e);
  RunScene forwards(robot, e), backwards(robot, e);
  remember_all(forwards, robot.model);
  remember_all(backwards, robot.model);
  const auto positions = [&](RunScene& run, int64_t step) {
    std::vector<Eigen::Vector3f> all;
    const Shot shot = run.shot(sample_moment(robot.model, step));
    for (const render::Part& part : shot.scene.bodies[0].parts)
      all.insert(all.end(), part.mesh->positions.begin(), part.mesh->positions.end());
    return all;
  };
  const auto early = positions(forwards, 40), late = positions(forwards, 120);
  EXPECT_EQ(positions(backwards, 120), late);
  EXPECT_EQ(positions(backwards, 40), early);
}

TEST(RunScene, TheCameraKeepsToThePlanUnlessTheRunLeftIt) {
  const Experiment e = sample_experiment();
  const Robot robot = load_robot(e);
  const auto eye = [&](double error) {
    RunScene run(robot, e);
    remember_all(run, robot.model, 200, error);
    run.finish_run();
    return run.shot(sample_moment(robot.model, 0)).camera.eye;
  };
  EXPECT_EQ(eye(0.01), RunScene(robot, e).shot(sample_moment(robot.model, 0)).camera.eye);
  const Eigen::Vector3d far = eye(2.5);
  EXPECT_NE(far, eye(0));
  // and then everything is in the picture
  RunScene run(robot, e);
  remember_all(run, robot.model, 200, 2.5);
  run.finish_run();
  for (int64_t step = 0; step <= 200; step += 20) {
    const Snapshot snapshot = sample_moment(robot.model, step, 2.5);
    for (const Body& body : run.shot(snapshot).scene.bodies) {
      const render::Bounds box = render::bounds(body);
      for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d pixel =
            run.shot(snapshot).camera.pixel(box.corner(static_cast<render::Bounds::CornerType>(i)), 640, 480);
        EXPECT_TRUE(pixel.x() > 0 && pixel.x() < 640 && pixel.y() > 0 && pixel.y() < 480) << body.name;
      }
    }
  }
}

TEST(RunScene, AFollowedFrameStaysWhereItIsInThePicture) {
  const Experiment e = sample_experiment("{follow: effector_body}");
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  rbd::Data data(robot.model);
  std::vector<Eigen::Vector3d> pixels;
  for (int64_t step : {0, 60, 90, 200}) {
    const Snapshot snapshot = sample_moment(robot.model, step);
    rbd::forwardKinematics(robot.model, data, snapshot.q);
    pixels.push_back(run.shot(snapshot).camera.pixel(
        data.oMf[robot.model.frameId("effector_body")].translation(), 640, 480));
  }
  for (const Eigen::Vector3d& pixel : pixels) EXPECT_LT((pixel - pixels[0]).norm(), 1e-9);
}

TEST(RunScene, AnOrbitGoesRoundAtItsSpeed) {
  const Experiment e = sample_experiment("{orbit: 0.5}");
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  const render::Camera a = run.shot(sample_moment(robot.model, 0)).camera,
                       b = run.shot(sample_moment(robot.model, 200)).camera;
  const Eigen::Vector3d from = a.eye - a.target, to = b.eye - b.target;
  EXPECT_LT((a.target - b.target).norm(), 1e-12);
  EXPECT_NEAR(from.z(), to.z(), 1e-12);
  EXPECT_NEAR(std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x()), 1.0, 1e-12);
}

TEST(RunScene, UnknownFramesAreNamedWithWhatIsNear) {
  for (const std::string key : {"trace", "follow"}) {
    const Experiment e = sample_experiment("{" + key + ": efector_body}");
    try {
      RunScene run(load_robot(e), e);
      FAIL();
    } catch (const ExperimentError& error) {
      EXPECT_EQ(std::string(error.what()),
                "sample:4: renderer." + key + ": no frame 'efector_body'; did you mean 'effector_body'?");
    }
  }
}

}  // namespace
}  // namespace lab::renderer
