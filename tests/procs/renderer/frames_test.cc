#include "procs/renderer/frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

namespace lab::renderer {
namespace {

namespace fs = std::filesystem;
using Steps = std::vector<int64_t>;

class FramesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "lab_frames_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) all.insert(entry.path().filename().string());
    return all;
  }
  fs::path folder_;
};

render::Image plain(int width, int height, uint8_t grey) {
  render::Image image(width, height);
  std::fill(image.rgb.begin(), image.rgb.end(), grey);
  return image;
}

TEST(StepsAtRate, FirstAndLastAlways) {
  EXPECT_EQ(steps_at_rate(20, 0.001, 100), (Steps{0, 50, 100}));
  EXPECT_EQ(steps_at_rate(20, 0.001, 120), (Steps{0, 50, 100, 120}));
  EXPECT_EQ(steps_at_rate(1000, 0.01, 3), (Steps{0, 1, 2, 3}));  // more pictures than steps
  EXPECT_EQ(steps_at_rate(30, 0.01, 10), (Steps{0, 3, 7, 10}));
  EXPECT_EQ(steps_at_rate(20, 0.001, 0), (Steps{0}));
}

// 1/fps from each picture to the next, whatever dt is: as many as the run has, to one.
TEST(StepsOfFilm, LastAsLongAsTheRun) {
  EXPECT_EQ(steps_of_film(20, 0.001, 100), (Steps{0, 50, 100}));
  EXPECT_EQ(steps_of_film(20, 0.001, 120), (Steps{0, 50, 120}));
  EXPECT_EQ(steps_of_film(40, 0.05, 3), (Steps{0, 1, 1, 2, 2, 3, 3}));  // more pictures than steps
  EXPECT_EQ(steps_of_film(20, 0.001, 0), (Steps{0}));
  for (double fps : {1.0, 7.0, 24.0, 30.0, 59.94, 250.0, 5000.0})
    for (double dt : {0.0005, 0.001, 0.003, 0.02, 0.25})
      for (int64_t last_step : {1, 10, 400}) {
        const Steps steps = steps_of_film(fps, dt, last_step);
        const double length = static_cast<double>(steps.size()) / fps,
                     run = static_cast<double>(last_step) * dt;
        EXPECT_NEAR(length, run + 1 / fps, 0.501 / fps) << fps << " " << dt << " " << last_step;
        EXPECT_EQ(steps.back(), last_step);
        for (size_t i = 0; i + 1 < steps.size(); ++i)
          EXPECT_LE(std::abs(static_cast<double>(steps[i]) * dt - static_cast<double>(i) / fps),
                    dt / 2 + 0.5 / fps);
      }
}

TEST_F(FramesTest, NumbersTextsAndBytes) {
  {
    FrameFolder files((folder_ / "a" / "b").string(), {{"run", "1"}});
    for (int i = 0; i < 3; ++i)
      files.write(i, {plain(8, 4, static_cast<uint8_t>(40 * i)), {{"step", std::to_string(i)}}});
    files.finish();
    EXPECT_EQ(files.done(), 3);
  }
  folder_ /= "a/b";
  EXPECT_EQ(names(), (std::set<std::string>{"0000.png", "0001.png", "0002.png"}));
  const render::PngFile second = render::read_png(frame_path(folder_.string(), 1));
  EXPECT_EQ(second.image.rgb, plain(8, 4, 40).rgb);
  EXPECT_EQ(second.texts, (render::PngTexts{{"run", "1"}, {"step", "1"}}));
  folder_ = folder_.parent_path().parent_path();
}

TEST_F(FramesTest, DepthsAndIds) {
  render::Measurement seen;
  seen.width = 3;
  seen.height = 1;
  seen.depth = {0.5f, 1.2344f, INFINITY};
  seen.id = {1, 2, 0};
  FrameFolder files(folder_.string(), {{"run", "1"}});
  files.write_depth(7, seen, {{"step", "9"}});
  files.write_ids(7, seen, {{"step", "9"}}, {"", "base", "arm"});
  files.finish();
  EXPECT_EQ(names(), (std::set<std::string>{"0007.depth.f32", "0007.depth.png", "0007.id.png"}));
  std::vector<float> back(3);
  std::ifstream((folder_ / "0007.depth.f32").string(), std::ios::binary)
      .read(reinterpret_cast<char*>(back.data()), 12);
  EXPECT_EQ(back, seen.depth);
  EXPECT_EQ(fs::file_size(folder_ / "0007.depth.f32"), 12u);
  const render::PngFile ids = render::read_png((folder_ / "0007.id.png").string());
  EXPECT_EQ(ids.texts.back(), (std::pair<std::string, std::string>{"links", "0 nothing, 1 base, 2 arm"}));
  EXPECT_EQ(render::read_png((folder_ / "0007.depth.png").string()).image.width, 3);
}

TEST_F(FramesTest, ErrorsSayWhere) {
  std::ofstream(folder_ / "file") << 1;
  try {
    make_folder((folder_ / "file" / "below").string());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(),
              (folder_ / "file" / "below").string() + ": cannot make this folder: Not a directory");
  }
  FrameFolder files(folder_.string(), {});
  fs::create_directory(folder_ / "0000.png");  // in the picture's way
  files.write(0, {plain(4, 4, 1), {}});
  EXPECT_THROW(files.finish(), std::runtime_error);
}

/// The sheet's cells, found by their colour: no knowledge of how it is laid out.
TEST_F(FramesTest, AContactSheetHasTwelveEvenlyChosenFramesInOrder) {
  constexpr int kFrames = 34;
  std::vector<double> times;
  FrameFolder files(folder_.string(), {{"run", "abc"}, {"renderer", "r"}});
  for (int i = 0; i < kFrames; ++i) {
    render::Image image(64, 48);
    for (size_t k = 0; k < image.rgb.size(); k += 3) {
      image.rgb[k] = 255;
      image.rgb[k + 1] = static_cast<uint8_t>(i);
      image.rgb[k + 2] = 0;
    }
    files.write(i, {image, {{"step", "1"}}});
    times.push_back(0.1 * i);
  }
  files.finish();
  const std::string path = (folder_ / "contact.png").string();
  write_contact_sheet_of(path, folder_.string(), times);
  const render::PngFile sheet = render::read_png(path);
  EXPECT_EQ(sheet.texts, (render::PngTexts{{"run", "abc"}, {"renderer", "r"}}));
  std::vector<int> found;
  int pixels = 0;
  for (int y = 0; y < sheet.image.height; ++y)
    for (int x = 0; x < sheet.image.width; ++x) {
      const uint8_t* p = sheet.image.at(x, y);
      if (p[0] != 255 || p[2] != 0) continue;
      ++pixels;
      if (std::find(found.begin(), found.end(), p[1]) == found.end()) found.push_back(p[1]);
    }
  ASSERT_EQ(found.size(), 12u);
  EXPECT_EQ(pixels, 12 * 64 * 48) << "whole, and none overlaps";
  for (int i = 0; i < 12; ++i) EXPECT_EQ(found[i], i * (kFrames - 1) / 11) << "read like a page";
}

TEST_F(FramesTest, TimesStandBelowTheirPictures) {
  const std::string one = (folder_ / "1.png").string(), other = (folder_ / "2.png").string();
  write_contact_sheet(one, {{plain(64, 48, 10), 0}, {plain(64, 48, 20), 1.5}}, {});
  write_contact_sheet(other, {{plain(64, 48, 10), 0}, {plain(64, 48, 20), 1.25}}, {});
  const render::Image a = render::read_png(one).image, b = render::read_png(other).image;
  ASSERT_EQ(a.rgb.size(), b.rgb.size());
  int right_edge = 0;  // of the first picture
  for (int x = 0; x < a.width; ++x)
    if (a.at(x, 20)[0] == 10) right_edge = x;
  int differing = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      if (a.at(x, y)[0] != b.at(x, y)[0]) {
        ++differing;
        EXPECT_GT(x, right_edge);
        EXPECT_GT(y, 48);
      }
  EXPECT_GT(differing, 4) << "1.50 s is not 1.25 s";
}

}  // namespace
}  // namespace lab::renderer
