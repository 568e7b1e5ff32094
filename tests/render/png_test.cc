#include "render/png.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

namespace lab::render {
namespace {

namespace fs = std::filesystem;

class PngTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "lab_png_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }
  size_t files() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }

  fs::path folder_;
};

Image noise(int width, int height, unsigned seed) {
  Image image(width, height);
  std::mt19937 random(seed);
  for (uint8_t& byte : image.rgb) byte = static_cast<uint8_t>(random());
  return image;
}

std::string error_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST_F(PngTest, ComesBackByteForByte) {
  for (const auto& [w, h] : {std::pair(1, 1), std::pair(3, 7), std::pair(160, 120), std::pair(641, 2)}) {
    const Image image = noise(w, h, 7);
    const std::string path = (folder_ / "a.png").string();
    write_png(path, image, {{"run", "0123abcd"}, {"time", "1.25 s"}, {"empty", ""}});
    const PngFile back = read_png(path);
    EXPECT_EQ(back.image.width, w);
    EXPECT_EQ(back.image.height, h);
    EXPECT_EQ(back.image.rgb, image.rgb);
    EXPECT_EQ(back.texts, (PngTexts{{"run", "0123abcd"}, {"time", "1.25 s"}, {"empty", ""}}));
    EXPECT_EQ(files(), 1u) << "no temporary file may stay";
  }
}

TEST_F(PngTest, SixteenBitGrey) {
  std::mt19937 random(5);
  std::vector<uint16_t> values(37 * 11);
  for (uint16_t& v : values) v = static_cast<uint16_t>(random());
  const std::string path = (folder_ / "depth.png").string();
  write_png16(path, 37, 11, values, {{"unit", "0.001 m"}});
  const PngFile back = read_png(path);  // as 8 bits: the upper byte of each
  EXPECT_EQ(back.texts, (PngTexts{{"unit", "0.001 m"}}));
  ASSERT_EQ(back.image.width, 37);
  ASSERT_EQ(back.image.height, 11);
  for (size_t i = 0; i < values.size(); ++i)
    for (int c = 0; c < 3; ++c) ASSERT_EQ(back.image.rgb[3 * i + c], values[i] >> 8);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(bytes[24], 16) << "bits";
  EXPECT_EQ(bytes[25], 0) << "grey";
  EXPECT_NE(error_of([&] { write_png16(path, 37, 12, values); }).find("37 x 12"), std::string::npos);
}

TEST_F(PngTest, SameBytesForSamePicture) {
  const Image image = noise(50, 40, 3);
  write_png((folder_ / "a.png").string(), image, {{"k", "v"}});
  write_png((folder_ / "b.png").string(), image, {{"k", "v"}});
  const auto bytes = [&](const char* name) {
    std::ifstream file(folder_ / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_EQ(bytes("a.png"), bytes("b.png"));
}

TEST_F(PngTest, MissingFolderIsAnError) {
  const std::string path = (folder_ / "none" / "a.png").string();
  const std::string error = error_of([&] { write_png(path, noise(2, 2, 1)); });
  EXPECT_NE(error.find(path), std::string::npos) << error;
  EXPECT_NE(error.find("No such file"), std::string::npos) << error;
}

TEST_F(PngTest, UnwritableFolderIsAnError) {
  if (geteuid() == 0) {
    // root may write everywhere; a folder in the place of the temporary file stops it too
    fs::create_directory(folder_ / ".a.png.part");
  } else {
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  }
  const std::string error = error_of([&] { write_png((folder_ / "a.png").string(), noise(2, 2, 1)); });
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_NE(error.find("a.png: cannot write picture: "), std::string::npos) << error;
  EXPECT_FALSE(fs::exists(folder_ / "a.png"));
}

TEST_F(PngTest, FullDiskIsAnErrorAndLeavesNothing) {
  // /dev/full says "no space left" to every write; a link to it stands where the temporary file goes.
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  fs::create_symlink("/dev/full", folder_ / ".a.png.part");
  const std::string error = error_of([&] { write_png((folder_ / "a.png").string(), noise(9, 9, 1)); });
  EXPECT_NE(error.find("No space left"), std::string::npos) << error;
  EXPECT_EQ(files(), 0u);
}

TEST_F(PngTest, FailedRenameLeavesNoTemporaryFile) {
  fs::create_directory(folder_ / "a.png");  // a folder cannot be replaced by a file
  EXPECT_NE(error_of([&] { write_png((folder_ / "a.png").string(), noise(2, 2, 1)); }), "");
  EXPECT_EQ(files(), 1u);
}

TEST_F(PngTest, BadArgumentsAreRefused) {
  const std::string path = (folder_ / "a.png").string();
  EXPECT_THROW(write_png(path, Image()), std::invalid_argument);
  Image cut(4, 4);
  cut.rgb.pop_back();
  EXPECT_THROW(write_png(path, cut), std::invalid_argument);
  EXPECT_THROW(write_png(path, Image(2, 2), {{"", "v"}}), std::invalid_argument);
  EXPECT_THROW(write_png(path, Image(2, 2), {{std::string(80, 'k'), "v"}}), std::invalid_argument);
  EXPECT_THROW(write_png(path, Image(2, 2), {{"k", std::string("a\0b", 3)}}), std::invalid_argument);
  EXPECT_EQ(files(), 0u);
}

TEST_F(PngTest, BrokenFilesAreErrors) {
  const std::string path = (folder_ / "a.png").string();
  EXPECT_NE(error_of([&] { read_png(path); }).find("cannot open"), std::string::npos);
  write_png(path, noise(64, 64, 5));
  const auto size = fs::file_size(path);
  fs::resize_file(path, size / 2);
  const std::string error = error_of([&] { read_png(path); });
  EXPECT_NE(error.find(path), std::string::npos) << error;
  EXPECT_NE(error.find("cut short"), std::string::npos) << error;
  std::ofstream(path) << "this is no picture at all, and long enough for a header";
  EXPECT_NE(error_of([&] { read_png(path); }), "");
}

}  // namespace
}  // namespace lab::render
