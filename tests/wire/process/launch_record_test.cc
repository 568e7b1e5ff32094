// The supervisor's record, with this process as the one that was started, and sockets that no packet is sent from.
#include "wire/process/launch_record.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/paths.h"

namespace lab {
namespace {

class LaunchRecordTest : public testing::Test {
 protected:
  LaunchRecordTest() {
    socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&own), size), 0);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size), 0);
    address_ = uint64_t{INADDR_LOOPBACK} << 16 | ntohs(own.sin_port);
    std::filesystem::create_directories(run_dir_ + "/processes");
    std::ofstream(run_dir_ + "/processes/state")
        << "phase running\nprocess planner starting 0 - 0 - yes never\n"
        << "process controller running " << std::filesystem::read_symlink("/proc/self").string()
        << " - 0 - yes never\n";
  }
  ~LaunchRecordTest() override {
    close(socket_);
    std::filesystem::remove_all(run_dir_);
  }

  std::string run_dir_ = lab::build_path("tests/wire/launch_record_test");
  int socket_ = -1;
  uint64_t address_ = 0;
};

TEST_F(LaunchRecordTest, ASocketIsOursWhereTheProcessHasIt) {
  const LaunchRecord record(run_dir_);
  EXPECT_EQ(record.check(kController, address_), Claim::Ours);
  close(socket_);
  EXPECT_EQ(record.check(kController, address_), Claim::Stranger) << "nobody has that port now";
}

// A Procfile's line is a shell that starts the program.
TEST_F(LaunchRecordTest, ASocketOfAChildIsOurs) {
  if (!std::filesystem::exists("/proc/self/task/" + std::filesystem::read_symlink("/proc/self").string() +
                               "/children"))
    GTEST_SKIP() << "this kernel does not list children";
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {  // keeps the socket until the pipe is closed
    char end = 0;
    close(ends[1]);
    const ssize_t n = read(ends[0], &end, 1);
    _exit(n == 0 ? 0 : 1);
  }
  close(ends[0]);
  close(socket_);
  EXPECT_EQ(LaunchRecord(run_dir_).check(kController, address_), Claim::Ours);
  close(ends[1]);
  EXPECT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_EQ(LaunchRecord(run_dir_).check(kController, address_), Claim::Stranger);
}

TEST_F(LaunchRecordTest, WhatIsNotStartedYetCannotSpeak) {
  EXPECT_EQ(LaunchRecord(run_dir_).check(kPlanner, address_), Claim::Stranger);
  EXPECT_EQ(LaunchRecord(run_dir_ + "/none").check(kController, address_), Claim::Stranger);
}

TEST_F(LaunchRecordTest, WithoutARecordNothingIsKnown) {
  EXPECT_EQ(LaunchRecord("").check(kController, address_), Claim::Unknown);
  EXPECT_EQ(LaunchRecord(run_dir_).check("a guest", address_), Claim::Unknown);
}

}  // namespace
}  // namespace lab
