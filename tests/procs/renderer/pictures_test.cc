// Pixels against the geometry that they show: by pinhole arithmetic and distances to the shapes, not by drawing again.
#include <gtest/gtest.h>
#include <rbd/algorithm/kinematics.h>

#include <cmath>

#include "procs/renderer/painter.h"
#include "render/markers.h"
#include "tests/procs/renderer/sample.h"

namespace lab::renderer {
namespace {

using Eigen::Vector3d;

/// Distance of a point from the surface of a primitive, in its own frame.
double distance(const rbd::GeometryObject& shape, const Vector3d& p) {
  const auto box = [](const Vector3d& d) {  // per axis: how far outside
    return d.cwiseMax(0).norm() + std::min(d.maxCoeff(), 0.0);
  };
  const double across = std::hypot(p.x(), p.y()), r = shape.size[0];
  switch (shape.shape) {
    case rbd::Shape::Box:
      return std::abs(box(p.cwiseAbs() - shape.size / 2));
    case rbd::Shape::Sphere:
      return std::abs(p.norm() - r);
    case rbd::Shape::Cylinder:
      return std::abs(box({across - r, std::abs(p.z()) - shape.size[1] / 2, -1e9}));
    case rbd::Shape::Capsule:
      return std::abs(std::hypot(across, std::max(std::abs(p.z()) - shape.size[1] / 2, 0.0)) - r);
    case rbd::Shape::Mesh:
      break;
  }
  return INFINITY;
}

Vector3d unprojected(const render::Camera& camera, int x, int y, double depth, int width, int height) {
  const double scale =
      camera.orthographic() ? camera.height / height : 2 * std::tan(camera.fov / 2) / height * depth;
  const Vector3d seen((x + .5 - width / 2.0) * scale, (height / 2.0 - y - .5) * scale, -depth);
  return camera.view().inverse() * seen;
}

/// Every pixel that is said to be of a link lies, at its depth, on that link as the snapshot's q puts it.
TEST(Pictures, DepthsAndLinksAreThoseOfThePose) {
  for (const char* keys : {"{size: [320, 240]}", "{size: [320, 240], orthographic: true, camera: side}",
                           "{size: [320, 240], orbit: 1, follow: effector_body}"}) {
    SCOPED_TRACE(keys);
    const Experiment e = sample_experiment(keys);
    const Robot robot = load_robot(e);
    RunScene run(robot, e);
    Painter painter(run);
    rbd::Data data(robot.model);
    for (int64_t step : {0, 70, 200}) {
      const Snapshot snapshot = sample_moment(robot.model, step, 0.1);
      const render::Measurement seen = painter.measure(run.shot(snapshot));
      const render::Camera camera = run.shot(snapshot).camera;
      rbd::forwardKinematics(robot.model, data, snapshot.q);
      std::map<int, int> pixels;
      double worst = 0;
      for (int y = 0; y < seen.height; ++y)
        for (int x = 0; x < seen.width; ++x) {
          const int id = seen.id[seen.at(x, y)];
          if (id == 0) continue;
          ASSERT_LT(static_cast<size_t>(id), run.links().size());
          ++pixels[id];
          const Vector3d point =
              unprojected(camera, x, y, seen.depth[seen.at(x, y)], seen.width, seen.height);
          double nearest = INFINITY;
          for (const auto& shape : robot.geometry.visual) {
            if (robot.model.frames[shape.parentFrame].name != run.links()[static_cast<size_t>(id)]) continue;
            const rbd::SE3 pose = data.oMi[shape.parentJoint] * shape.placement;
            nearest = std::min(nearest,
                               distance(shape, pose.rotation().transpose() * (point - pose.translation())));
          }
          worst = std::max(worst, nearest);
        }
      // Round shapes are drawn with 48 sides: off by r (1 - cos(pi / 48)) at most, 0.3 mm at r = 0.13. Depths as float
      // from a 24 bit buffer whose near plane is 1/100 of the distance: 100 d / 2^24, 0.02 mm at 3 m.
      EXPECT_LT(worst, 4e-4);
      EXPECT_GE(pixels.size(), 5u) << "links seen";
    }
  }
}

TEST(Pictures, LinksAreSeenWhereTheirMiddlesAre) {
  const Experiment e = sample_experiment("{size: [320, 240]}");
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  Painter painter(run);
  rbd::Data data(robot.model);
  int direct = 0;
  for (int64_t step = 0; step <= 200; step += 40) {
    const Snapshot snapshot = sample_moment(robot.model, step);
    const render::Measurement seen = painter.measure(run.shot(snapshot));
    rbd::forwardKinematics(robot.model, data, snapshot.q);
    for (const auto& shape : robot.geometry.visual) {
      const Vector3d pixel = run.shot(snapshot).camera.pixel(
          (data.oMi[shape.parentJoint] * shape.placement).translation(), 320, 240);
      const size_t at = seen.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
      const bool own = run.links()[seen.id[at]] == robot.model.frames[shape.parentFrame].name;
      direct += own;
      EXPECT_LT(seen.depth[at], pixel.z())
          << shape.name << ": its surface, or what hides it, is in front of its middle";
      EXPECT_NE(seen.id[at], 0) << shape.name;
    }
  }
  EXPECT_GT(direct, 6 * static_cast<int>(robot.geometry.visual.size()) / 2);
}

int difference(const uint8_t* a, const uint8_t* b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Where the traced frame was, the trace is; and it is nowhere else.
TEST(Pictures, TheTraceLiesWhereTheToolWas) {
  const std::string size = "size: [320, 240], quality: live, camera: side";  // live: no shadow
  const Experiment with = sample_experiment("{trace: effector_body, " + size + "}"),
                   without = sample_experiment("{" + size + "}");
  const Robot robot = load_robot(with);
  RunScene run(robot, with), bare(robot, without);
  rbd::Data data(robot.model);
  std::vector<Vector3d> points;
  for (int64_t step = 0; step <= 120; ++step) {
    const Snapshot snapshot = sample_moment(robot.model, step);
    run.remember(snapshot);
    rbd::forwardKinematics(robot.model, data, snapshot.q);
    points.push_back(data.oMf[robot.model.frameId("effector_body")].translation());
  }
  const Snapshot now = sample_moment(robot.model, 120);
  Painter painter(run), plain(bare);
  const render::Image a = painter.draw(run.shot(now)).image, b = plain.draw(bare.shot(now)).image;
  const render::Measurement seen = plain.measure(bare.shot(now));
  const render::Camera camera = run.shot(now).camera;
  ASSERT_EQ(camera.eye, bare.shot(now).camera.eye);

  std::vector<Vector3d> pixels;
  for (const Vector3d& point : points) pixels.push_back(camera.pixel(point, 320, 240));
  int shown = 0, blue = 0;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const int x = static_cast<int>(pixels[i].x()), y = static_cast<int>(pixels[i].y());
    if (seen.depth[seen.at(x, y)] < pixels[i].z() + 0.02) continue;  // inside or behind the robot
    ++shown;
    EXPECT_GT(difference(a.at(x, y), b.at(x, y)), 20) << i;
    blue += a.at(x, y)[2] > a.at(x, y)[0];
    if (i < 10) {
      EXPECT_GT(a.at(x, y)[2], a.at(x, y)[0] + 40) << "it begins blue";
    }
  }
  EXPECT_GT(shown, 50);
  EXPECT_GT(blue, 20);

  // 0.0033 of the picture's width is the tube's radius, twice that and a bit the bead's at its end; perspective makes
  // near ones larger by less than a third; one pixel for anti-aliasing
  const double radius = 0.0033 * 320 * 1.33 + 1, bead = 0.007 * 320 * 1.33 + 1;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      if (difference(a.at(x, y), b.at(x, y)) == 0) continue;
      double nearest = (pixels.back().head<2>() - Eigen::Vector2d(x + .5, y + .5)).norm() - bead + radius;
      for (const Vector3d& pixel : pixels)
        nearest = std::min(nearest, (pixel.head<2>() - Eigen::Vector2d(x + .5, y + .5)).norm());
      EXPECT_LT(nearest, radius + 1) << x << ", " << y;  // samples are up to a pixel apart
    }
}

TEST(Pictures, TextsSayStepTimeAndCamera) {
  const Experiment e = sample_experiment("{size: [64, 48], camera: top}");
  const Robot robot = load_robot(e);
  RunScene run(robot, e);
  Painter painter(run);
  const Snapshot snapshot = sample_moment(robot.model, 150);
  const Picture picture = painter.draw(run.shot(snapshot));
  std::map<std::string, std::string> texts(picture.texts.begin(), picture.texts.end());
  EXPECT_EQ(texts["step"], "150");
  EXPECT_EQ(texts["time"], "1.500000 s");
  render::Camera back;  // the camera can be set up again from its text
  ASSERT_EQ(std::sscanf(texts["camera"].c_str(),
                        "top; eye %lf %lf %lf target %lf %lf %lf up %lf %lf %lf m; fov %lf rad", &back.eye[0],
                        &back.eye[1], &back.eye[2], &back.target[0], &back.target[1], &back.target[2],
                        &back.up[0], &back.up[1], &back.up[2], &back.fov),
            10)
      << texts["camera"];
  EXPECT_LT((back.eye - run.shot(snapshot).camera.eye).norm(), 1e-4);
  EXPECT_LT((back.target - run.shot(snapshot).camera.target).norm(), 1e-4);
}

TEST(Pictures, ArrowsAndLegendShowWhatTheySay) {
  const Experiment e = sample_experiment("{size: [320, 240], trace: effector_body}");
  const Robot robot = load_robot(e);
  const auto draw = [&](Extras extras) {
    RunScene run(robot, e, std::move(extras));
    for (int64_t step = 0; step <= 100; ++step) {
      Snapshot snapshot = sample_moment(robot.model, step);
      snapshot.v[0] = 1;
      run.remember(snapshot);
    }
    run.finish_run();
    Snapshot snapshot = sample_moment(robot.model, 60);
    snapshot.v[0] = 1;
    return Painter(run).draw(run.shot(snapshot)).image;
  };
  const render::Image plain = draw({});
  const auto differing = [&](const render::Image& image, int rows_from) {
    int n = 0;
    for (int y = rows_from; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) n += difference(image.at(x, y), plain.at(x, y)) > 10;
    return n;
  };
  for (const char* arrows : {"velocity", "com", "frames"})
    EXPECT_GT(differing(draw({"time", {arrows}, {}}), 0), 100) << arrows;
  const Push push{0.5, 0.7, "effector_body", {0, 0, -80}}, over{0.7, 0.9, "effector_body", {0, 0, -80}};
  const int legend = 240 - 12;
  EXPECT_GT(differing(draw({"time", {"force"}, {push}}), 0),
            differing(draw({"time", {"force"}, {over}}), 0) + 60)
      << "only while it lasts";
  EXPECT_GT(differing(draw({"speed", {}, {}}), legend), 100) << "the scale of the colours";
  EXPECT_EQ(differing(draw({"time", {}, {}}), 0), 0);
  EXPECT_EQ(differing(draw({"time", {"force"}, {}}), legend), 0) << "no push, no scale of forces";
}

}  // namespace
}  // namespace lab::renderer
