#include "core/util/atomic_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace lab {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "atomicXXXXXX";
    ASSERT_TRUE(mkdtemp(name.data()));
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string content(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  int files() const { return static_cast<int>(std::distance(fs::directory_iterator(folder_), {})); }
  static std::string message(const std::string& path) {
    try {
      write_atomically(path, "text");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

TEST_F(AtomicFileTest, TheNewContentReplacesTheOld) {
  const std::string path = folder_ / "a.txt";
  const std::string large(3'000'000, 'x');
  write_atomically(path, "old and longer");
  write_atomically(path, "new");
  EXPECT_EQ(content(path), "new");
  EXPECT_EQ(write_and_rename(path, hidden_part(path), large, false).error, 0);
  EXPECT_EQ(content(path), large);
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, AnErrorLeavesTheOldContentAndNoPart) {
  const std::string path = folder_ / "a.txt", part = hidden_part(path);
  write_atomically(path, "old");
  fs::create_symlink("/dev/full", part);
  const WriteOutcome full = write_and_rename(path, part, "new", false);
  EXPECT_EQ(full.error, ENOSPC);
  EXPECT_TRUE(full.created);
  EXPECT_EQ(content(path), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, MessagesSayWhatFailed) {
  const std::string nowhere = folder_ / "none/a.txt", taken = folder_ / "taken";
  EXPECT_EQ(message(nowhere), nowhere + ": cannot be created (No such file or directory)");
  fs::create_directories(taken);
  EXPECT_EQ(message(taken), taken + ": cannot be written (Is a directory)");
  EXPECT_EQ(files(), 1);
}

TEST(HiddenPart, IsBesideTheFile) {
  EXPECT_EQ(hidden_part("runs/a/b.png"), "runs/a/.b.png.part");
  EXPECT_EQ(hidden_part("b.png"), ".b.png.part");
}

}  // namespace
}  // namespace lab
