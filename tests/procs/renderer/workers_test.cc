#include "procs/renderer/workers.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <stdexcept>
#include <vector>

namespace lab::renderer {
namespace {

namespace fs = std::filesystem;

/// Writes a file for each picture, named after it, holding the process that wrote it.
class FileWorker : public Worker {
 public:
  FileWorker(fs::path folder, std::function<void(int64_t)> before)
      : folder_(std::move(folder)), before_(std::move(before)) {}
  void draw(int64_t index) override {
    if (before_) before_(index);
    std::ofstream(folder_ / std::to_string(index)) << getpid();
  }
  void finish() override { std::ofstream(folder_ / ("finished." + std::to_string(getpid()))) << 1; }

 private:
  fs::path folder_;
  std::function<void(int64_t)> before_;
};

class WorkersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "lab_workers_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override {
    fs::remove_all(folder_);
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a child is left";
    EXPECT_EQ(errno, ECHILD);
  }
  void draw(int64_t count, int workers, std::function<void(int64_t)> before = {}) {
    draw_all(
        count, workers, [&] { return std::make_unique<FileWorker>(folder_, before); },
        [&](int64_t index) { told_.push_back(index); });
  }
  std::string error_of(int64_t count, int workers, std::function<void(int64_t)> before) {
    try {
      draw(count, workers, std::move(before));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
  std::vector<int64_t> told_;
};

TEST_F(WorkersTest, EveryPictureOnceInOrderByAsManyProcesses) {
  for (const auto& [count, workers, processes] :
       {std::tuple(1, 4, 1), std::tuple(7, 1, 1), std::tuple(7, 2, 2), std::tuple(9, 4, 4),
        std::tuple(0, 2, 1)}) {
    SCOPED_TRACE(std::to_string(count) + " by " + std::to_string(workers));
    told_.clear();
    draw(count, workers);
    std::vector<int64_t> all;
    std::set<std::string> writers;
    for (int i = 0; i < count; ++i) {
      all.push_back(i);
      std::string writer;
      std::ifstream(folder_ / std::to_string(i)) >> writer;
      writers.insert(writer);
      EXPECT_NE(writer, std::to_string(getpid()));
      EXPECT_TRUE(fs::exists(folder_ / ("finished." + writer)));
    }
    EXPECT_EQ(told_, all);
    if (count > 0) {
      EXPECT_EQ(writers.size(), static_cast<size_t>(processes));
    }
    for (const auto& entry : fs::directory_iterator(folder_)) fs::remove(entry.path());
  }
}

// The first worker is slow: what the second has drawn meanwhile is told after picture 0, not in place of it.
TEST_F(WorkersTest, APictureIsToldOnceItIsThere) {
  const fs::path told = folder_ / "told";
  const auto wait = [&](int64_t index) {
    for (int n = 0; index == 0 && n < 200; ++n) {
      usleep(1000);
      if (fs::exists(told)) throw std::runtime_error("it was told of before picture 0 was drawn");
    }
  };
  draw_all(
      4, 2, [&] { return std::make_unique<FileWorker>(folder_, wait); },
      [&](int64_t index) { std::ofstream(told) << index; });
  EXPECT_TRUE(fs::exists(told));
}

TEST_F(WorkersTest, TheFirstErrorIsTold) {
  EXPECT_EQ(error_of(8, 2,
                     [](int64_t i) {
                       if (i == 3) throw std::runtime_error("no room\nfor 3");
                     }),
            "no room for 3");
  EXPECT_LT(told_.size(), 4u);
}

TEST_F(WorkersTest, AKilledWorkerIsTold) {
  const std::string error = error_of(8, 4, [](int64_t i) {
    if (i == 2) raise(SIGKILL);
  });
  EXPECT_NE(error.find("killed by signal 9"), std::string::npos) << error;
  EXPECT_NE(error.find("memory"), std::string::npos) << error;
}

TEST_F(WorkersTest, AWorkerThatLeavesIsTold) {
  EXPECT_NE(error_of(4, 2,
                     [](int64_t i) {
                       if (i == 1) _exit(9);
                     })
                .find("exit code 9"),
            std::string::npos);
}

TEST_F(WorkersTest, OthersAreEndedAfterAnError) {
  // worker 0 would never end by itself; the test would not either
  const std::string error = error_of(2, 2, [](int64_t i) {
    if (i == 1) throw std::runtime_error("broken");
    for (;;) pause();
  });
  EXPECT_EQ(error, "broken");
}

TEST(SensibleWorkers, NoneForNothing) {
  EXPECT_EQ(sensible_workers(0), 1);
  EXPECT_EQ(sensible_workers(7), 1);
  EXPECT_LE(sensible_workers(100'000), 8);
}

}  // namespace
}  // namespace lab::renderer
