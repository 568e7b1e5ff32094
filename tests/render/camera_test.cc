#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::render {
namespace {

using Eigen::Vector3d;

TEST(Camera, PixelsByHand) {
  // One metre above the origin, looking along +x at a wall 2 m away; 90 degrees high: the picture is 4 m high
  // there.
  Camera camera;
  camera.eye = {0, 0, 1};
  camera.target = {2, 0, 1};
  camera.up = {0, 0, 1};
  camera.fov = M_PI / 2;
  const auto expect = [&](const Vector3d& point, const Vector3d& pixel) {
    EXPECT_LT((camera.pixel(point, 400, 200) - pixel).norm(), 1e-9)
        << camera.pixel(point, 400, 200).transpose();
  };
  expect({2, 0, 1}, {200, 100, 2});
  expect({2, 2, 1}, {100, 100, 2});  // +y is on the left
  expect({2, 0, 3}, {200, 0, 2});    // up is up
  expect({4, 0, 3}, {200, 50, 4});   // twice as far, half as high
  EXPECT_LT(camera.pixel({-1, 0, 1}, 400, 200).z(), 0);
}

TEST(Camera, ProjectionAgreesWithPixel) {
  Camera camera;
  camera.eye = {1.2, -0.7, 0.9};
  camera.target = {-0.1, 0.2, 0.3};
  camera.fov = 0.8;
  const int w = 320, h = 200;
  const Eigen::Matrix4d m = camera.projection(double(w) / h, 0.1, 10) * camera.view().matrix();
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(.3, -.2, .5), Vector3d(-1, 1, 0)}) {
    const Eigen::Vector4d c = m * p.homogeneous();
    const Vector3d pixel = camera.pixel(p, w, h);
    EXPECT_NEAR((c.x() / c.w() + 1) / 2 * w, pixel.x(), 1e-9);
    EXPECT_NEAR((1 - c.y() / c.w()) / 2 * h, pixel.y(), 1e-9);
    EXPECT_NEAR(c.w(), pixel.z(), 1e-12);
    EXPECT_LT(std::abs(c.z() / c.w()), 1);
  }
  const auto depth = [&](double z) {
    const Eigen::Vector4d c = camera.projection(1, 0.1, 10) * Eigen::Vector4d(0, 0, -z, 1);
    return c.z() / c.w();
  };
  EXPECT_NEAR(depth(0.1), -1, 1e-12);
  EXPECT_NEAR(depth(10), 1, 1e-12);
}

TEST(Camera, NonsenseIsRefused) {
  Camera camera;
  camera.eye = camera.target;
  EXPECT_THROW(camera.view(), std::invalid_argument);
  camera = Camera();
  camera.up = camera.eye - camera.target;
  EXPECT_THROW(camera.view(), std::invalid_argument);
  camera = Camera();
  camera.eye.x() = NAN;
  EXPECT_THROW(camera.view(), std::invalid_argument);
  for (double fov : {0.0, -1.0, 4.0, double(NAN)}) {
    camera = Camera();
    camera.fov = fov;
    EXPECT_THROW(camera.view(), std::invalid_argument);
  }
}

// Every corner is in the picture, and the box fills most of it in one direction.
TEST(Camera, AutoFrameSeesTheWholeBoxAndFillsThePicture) {
  const Bounds boxes[] = {{Vector3d(-.3, -.3, 0), Vector3d(.3, .3, 1.2)},
                          {Vector3d(-2, -.1, 0), Vector3d(2, .1, .1)},
                          {Vector3d(5, 6, 7), Vector3d(5.01, 6.01, 7.01)},
                          {Vector3d(-50, -50, 0), Vector3d(50, 50, 80)},
                          {Vector3d(0, 0, 0), Vector3d(0, 0, 2)}};
  for (const Bounds& box : boxes) {
    for (const std::string& view : view_names()) {
      for (const auto& [w, h] : {std::pair(640, 480), std::pair(300, 900)}) {
        const Camera camera = auto_frame(box, view, double(w) / h);
        double fill = 0;
        for (int i = 0; i < 8; ++i) {
          const Vector3d p = camera.pixel(box.corner(static_cast<Bounds::CornerType>(i)), w, h);
          EXPECT_GT(p.z(), 0);
          const double x = std::abs(p.x() / w * 2 - 1), y = std::abs(p.y() / h * 2 - 1);
          EXPECT_LT(x, 1) << view;
          EXPECT_LT(y, 1) << view;
          fill = std::max({fill, x, y});
        }
        EXPECT_GE(fill, box.volume() > 0 ? 0.8 : 0.0) << view << " " << box.min().transpose();
      }
    }
  }
}

TEST(Camera, NamedViewsLookTheirWay) {
  const Bounds box(Vector3d(-.5, -.5, 0), Vector3d(.5, .5, 1));
  const auto moves = [&](const std::string& view, const Vector3d& by) {  // where a step shows in the picture
    const Camera camera = auto_frame(box, view);
    const Vector3d middle(0, 0, .5);
    return Vector3d(camera.pixel(middle + by, 640, 480) - camera.pixel(middle, 640, 480));
  };
  EXPECT_GT(moves("front", {0, .1, 0}).x(), 5);  // from +x: +y is on the right
  EXPECT_LT(moves("front", {.1, 0, 0}).z(), 0);  // and +x comes nearer
  EXPECT_GT(moves("side", {.1, 0, 0}).x(), 5);
  EXPECT_GT(moves("top", {.1, 0, 0}).x(), 5);
  EXPECT_LT(moves("top", {0, .1, 0}).y(), -5);
  EXPECT_LT(moves("iso", {0, 0, .1}).y(), -5);
  for (const char* view : {"front", "side"}) EXPECT_LT(moves(view, {0, 0, .1}).y(), -5);
}

TEST(Camera, OrthographicByHand) {
  // A picture 4 m high of 400 x 200 pixels: 2 cm each, however far away.
  Camera camera;
  camera.eye = {0, 0, 1};
  camera.target = {2, 0, 1};
  camera.height = 4;
  const int w = 400, h = 200;
  const Eigen::Matrix4d m = camera.projection(double(w) / h, -5, 10) * camera.view().matrix();
  for (double far : {-3.0, 2.0, 9.0}) {
    const Vector3d p = camera.pixel({far, .5, 1.2}, w, h);
    EXPECT_LT((p - Vector3d(200 - 25, 100 - 10, far)).norm(), 1e-9) << p.transpose();
    const Eigen::Vector4d c = m * Eigen::Vector4d(far, .5, 1.2, 1);
    EXPECT_NEAR(c.w(), 1, 1e-12);
    EXPECT_NEAR((c.x() + 1) / 2 * w, p.x(), 1e-9);
    EXPECT_NEAR((1 - c.y()) / 2 * h, p.y(), 1e-9);
    EXPECT_NEAR(c.z(), (far + 5) / 15 * 2 - 1, 1e-12);  // depth is linear
  }
}

// The directions of an iso view by its angles, and every corner in the picture, orthographic too.
TEST(Camera, ViewsByAngle) {
  const Bounds box(Vector3d(-.2, -.4, 0), Vector3d(.6, .4, 1.1));
  for (double azimuth : {-2.5, 0.0, 1.2}) {
    for (double elevation : {-.3, 0.2, 1.5, M_PI / 2}) {
      for (bool orthographic : {false, true}) {
        View view{azimuth, elevation};
        view.orthographic = orthographic;
        const Camera camera = auto_frame(box, view, 1.5);
        const Vector3d towards = (camera.eye - camera.target).normalized();
        EXPECT_NEAR(std::asin(towards.z()), elevation, 1e-6);
        if (elevation < 1.5) {
          EXPECT_NEAR(std::atan2(towards.y(), towards.x()), azimuth, 1e-9);
        }
        double fill = 0;
        for (int i = 0; i < 8; ++i) {
          const Vector3d p = camera.pixel(box.corner(static_cast<Bounds::CornerType>(i)), 300, 200);
          fill = std::max({fill, std::abs(p.x() / 150 - 1), std::abs(p.y() / 100 - 1)});
        }
        EXPECT_LT(fill, 1);
        EXPECT_GT(fill, .85);
        view.distance = 2;  // everything half as large
        const Camera away = auto_frame(box, view, 1.5);
        if (orthographic) {
          EXPECT_NEAR(away.height, 2 * camera.height, 1e-9);
        } else {
          EXPECT_NEAR((away.eye - away.target).norm(), 2 * (camera.eye - camera.target).norm(), 1e-9);
        }
      }
    }
  }
}

TEST(Camera, AnOrbitSeesEverythingAtEveryAngleFromOneDistance) {
  const Bounds box(Vector3d(0, 0, 0), Vector3d(2, .3, .5));
  View view;
  view.orbit = .5;
  const Camera start = auto_frame(box, view, 4. / 3);
  for (double t = 0; t < 14; t += .37) {
    const Camera camera = turned(start, view.orbit * t);
    EXPECT_NEAR((camera.eye - camera.target).norm(), (start.eye - start.target).norm(), 1e-9);
    EXPECT_NEAR(camera.eye.z(), start.eye.z(), 1e-9);
    for (int i = 0; i < 8; ++i) {
      const Vector3d p = camera.pixel(box.corner(static_cast<Bounds::CornerType>(i)), 640, 480);
      EXPECT_TRUE(p.x() > 0 && p.x() < 640 && p.y() > 0 && p.y() < 480) << t;
    }
  }
  const Vector3d towards = turned(start, 1).eye - start.target;
  EXPECT_NEAR(std::atan2(towards.y(), towards.x()), view.azimuth + 1, 1e-9);
}

TEST(Camera, MovedAlongSeesTheSame) {
  const Camera camera = auto_frame(Bounds(), "iso", 1);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(2.1, Vector3d(1, -1, .4).normalized()).toRotationMatrix();
  motion.translation() = Vector3d(3, -8, 1);
  for (const Vector3d& p : {Vector3d(.1, .2, .3), Vector3d(-.4, 0, .9)})
    EXPECT_LT((moved(camera, motion).pixel(motion * p, 100, 100) - camera.pixel(p, 100, 100)).norm(), 1e-9);
}

TEST(Camera, AutoFrameErrorsAndEmptyBox) {
  EXPECT_NO_THROW(auto_frame(Bounds()).view());
  try {
    auto_frame(Bounds(), "isometric");
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("'isometric' (known: iso, front, side, top)"), std::string::npos)
        << e.what();
  }
  EXPECT_THROW(auto_frame(Bounds(Vector3d(0, 0, 0), Vector3d(1, 1, HUGE_VAL))), std::invalid_argument);
  EXPECT_THROW(auto_frame(Bounds(), "iso", 0), std::invalid_argument);
  for (const View& view : {View{NAN, 0}, View{0, 2}, View{0, 0, 0}, View{0, 0, 1, INFINITY}})
    EXPECT_THROW(auto_frame(Bounds(), view), std::invalid_argument);
  Camera flat;
  flat.height = -1;
  EXPECT_THROW(flat.view(), std::invalid_argument);
}

}  // namespace
}  // namespace lab::render
