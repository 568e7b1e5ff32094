// The bus and the logs against stock LCM programs: lcm-logger, lcm-logplayer, Python's lcm.
// Runs in a private network namespace (tests/support/netns.sh).
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <lab/command_t.hpp>
#include <lab/input_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>

#include "tests/support/paths.h"
#include "tests/wire/bus/noise.h"
#include "wire/bus/bus.h"
#include "wire/log/log_reader.h"
#include "wire/log/log_writer.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

using Clock = std::chrono::steady_clock;

// A child process; ended when the object goes.
class Child {
 public:
  explicit Child(std::vector<std::string> words) {
    std::vector<char*> argv;
    for (std::string& w : words) argv.push_back(w.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      signal(SIGINT, SIG_DFL);
      execvp(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Child() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  // Exit code, or 128 + signal; waits for the end at most ten seconds.
  int wait(int with_signal = 0) {
    if (with_signal) kill(pid_, with_signal);
    const auto deadline = Clock::now() + std::chrono::seconds(10);
    int status = 0;
    while (Clock::now() < deadline) {
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        pid_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      }
      usleep(1000);
    }
    return -1;
  }

 private:
  pid_t pid_ = 0;
};

const std::string kUrl = "udpm://239.255.76.67:7690?ttl=0";
std::string scratch(const std::string& name) {
  std::filesystem::create_directories(lab::build_path("tests/wire/tools_net_test"));
  return lab::build_path("tests/wire/tools_net_test/" + name);
}
bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null").c_str()) == 0;
}

class StockTools : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Bus> bus_ = open_bus(kUrl + "&backend=" + GetParam(), [] {
    BusOptions options;
    options.channels = {"DATA", "PONG"};  // a poll for the others' sake waits
    return options;
  }());
};

TEST_P(StockTools, LoggerWritesWhatWePublish) {
  if (!has_program("lcm-logger")) GTEST_SKIP() << "needs lcm-logger";
  const std::string file = scratch("logger.lcm");
  std::filesystem::remove(file);
  Child logger({"lcm-logger", "-q", "-f", "--flush-interval=1",
                "--lcm-url=" + kUrl + "&recv_buf_size=4194304", file});  // 1.3.1 forgot -l
  // it is listening once something of ours is in its file
  const auto deadline = Clock::now() + std::chrono::seconds(10);
  const auto size = [&] {
    std::error_code none;
    const auto n = std::filesystem::file_size(file, none);
    return none ? 0 : n;
  };
  while (size() == 0 && Clock::now() < deadline) {
    bus_->publish("READY", Bytes{1});
    bus_->poll(2000, [](const Datagram&) {});
  }
  ASSERT_GT(size(), 0u) << "lcm-logger never wrote anything";
  std::vector<Bytes> sent;
  for (uint32_t i = 0; i < 100; ++i) sent.push_back(noise(i == 50 ? 150'000 : 10 + i, i));
  // lcm-logger queues 30 messages and drops the rest without a word: hand it ten, see them in the file, go
  // on. It flushes only when something new comes.
  std::vector<Bytes> got;
  const auto read = [&] {
    got.clear();
    LogReader reader(file);
    LogEvent e;
    while (reader.next(e)) {
      if (e.channel == "DATA") got.emplace_back(e.data.begin(), e.data.end());
    }
    EXPECT_TRUE(reader.skipped().empty());
    return got.size();
  };
  for (size_t i = 0; i < sent.size(); ++i) {
    bus_->publish("DATA", sent[i]);
    while (i % 10 == 9 && read() <= i && Clock::now() < deadline) {
      bus_->publish("TICK", Bytes{1});
      bus_->poll(2000, [](const Datagram&) {});
    }
  }
  EXPECT_EQ(got.size(), sent.size());
  EXPECT_TRUE(got == sent);
  EXPECT_EQ(logger.wait(SIGINT), 0);
}

TEST_P(StockTools, LogplayerPlaysOurLog) {
  if (!has_program("lcm-logplayer")) GTEST_SKIP() << "needs lcm-logplayer";
  const std::string file = scratch("player.lcm");
  std::vector<Bytes> sent;
  {
    LogWriter writer(file);
    for (uint32_t i = 0; i < 100; ++i) {
      sent.push_back(noise(i == 50 ? 150'000 : 10 + i, i));
      writer.add(1000 * i, "DATA", sent.back());
    }
    writer.finish();
  }
  Child player({"lcm-logplayer", "-s", "10", "-l", kUrl, file});
  std::vector<Bytes> got;
  const auto deadline = Clock::now() + std::chrono::seconds(10);
  while (got.size() < sent.size() && Clock::now() < deadline) {
    bus_->poll(100'000, [&](const Datagram& d) {
      if (d.channel == "DATA") got.emplace_back(d.data.begin(), d.data.end());
    });
  }
  EXPECT_EQ(got.size(), sent.size());
  EXPECT_TRUE(got == sent);
  EXPECT_EQ(player.wait(), 0);
}

TEST_P(StockTools, PythonEchoesAllSizes) {
  const std::string python = lab::build_path("pyenv/bin/python3");
  if (!std::filesystem::exists(python)) GTEST_SKIP() << "needs " << python << " (tests/conformance/pyenv.sh)";
  Child echo(
      {python, lab::source_path("tests/conformance/python_lcm.py"), "echo", kUrl + "&recv_buf_size=4194304"});
  const auto deadline = Clock::now() + std::chrono::seconds(30);
  const auto ask = [&](const Bytes& data, int64_t wait_us) {
    bus_->publish("PING", data);
    const auto until = std::min(deadline, Clock::now() + std::chrono::microseconds(wait_us));
    bool back = false;
    while (!back && Clock::now() < until) {
      bus_->poll(10'000,
                 [&](const Datagram& d) { back |= d.channel == "PONG" && std::ranges::equal(d.data, data); });
    }
    return back;
  };
  while (!ask({7}, 50'000) && Clock::now() < deadline) {  // until it listens
  }
  for (const size_t n : {0, 1, 1000, 60'000, 65'494, 65'495, 150'000})
    EXPECT_TRUE(ask(noise(n, 1), 10'000'000)) << n;
  const std::string stop = "stop";
  EXPECT_TRUE(ask(Bytes(stop.begin(), stop.end()), 10'000'000));
  EXPECT_EQ(echo.wait(), 0);
}

INSTANTIATE_TEST_SUITE_P(Backends, StockTools, testing::Values("own", "liblcm"),
                         [](const auto& info) { return info.param; });

TEST(PythonLog, DecodesOurMessagesAndEncodesTheSameBytes) {
  const std::string python = lab::build_path("pyenv/bin/python3");
  if (!std::filesystem::exists(python)) GTEST_SKIP() << "needs " << python << " (tests/conformance/pyenv.sh)";
  const std::string types = scratch("python_types"), file = scratch("python.lcm");
  std::filesystem::create_directories(types);
  ASSERT_EQ(std::system(("lcm-gen -p --ppath " + types + " " + lab::source_path("lcmtypes/*.lcm")).c_str()),
            0);
  {
    LogWriter writer(file);
    run_t run{};
    run.experiment = "robot: Größe\n";
    run.njoints = 2;
    run.joint_names = {"shoulder", "elbow"};
    writer.add(0, "RUN", encode(run));
    for (int i = 0; i < 50; ++i) {
      robot_state_t state{};
      state.step = i;
      state.nq = state.nv = i % 8;
      state.q.assign(i % 8, 0.1 * i);
      state.v.assign(i % 8, -1e-300);
      state.tau.assign(i % 8, 1e300);
      writer.add(i, "ROBOT_STATE", encode(state));
      command_t command{};
      command.nv = 1;
      command.tau = {i / 3.0};
      writer.add(i, "COMMAND", encode(command));
      input_t input{};
      input.action.n = i % 3;
      input.action.values.assign(i % 3, 2.5);
      input.action.verb = "goal";
      writer.add(i, "INPUT", encode(input));
    }
    writer.finish();
  }
  const std::string out = scratch("python.out");
  const std::string command =
      python + " " + lab::source_path("tests/conformance/python_lcm.py") + " log " + file + " " + types;
  EXPECT_EQ(std::system((command + " > " + out).c_str()), 0) << command;
  FILE* f = std::fopen(out.c_str(), "r");
  int count = 0;
  ASSERT_EQ(std::fscanf(f, "%d", &count), 1);
  std::fclose(f);
  EXPECT_EQ(count, 151);
}

}  // namespace
}  // namespace lab
