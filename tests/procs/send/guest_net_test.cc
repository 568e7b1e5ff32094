// A program that is no part of a run, with labs made of one thread that answers. Runs in a private network namespace
// (tests/support/netns.sh).
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <lab/reply_t.hpp>
#include <lab/request_t.hpp>
#include <lab/run_t.hpp>
#include <thread>

#include "procs/send/guest.h"
#include "procs/send/send.h"
#include "tests/wire/bus/bus_user.h"
#include "tests/wire/protocol/message.h"
#include "wire/schema/codec.h"

namespace lab::send {
namespace {

/// A bus on which labs answer each NEED: run 1 at once and again, the others later.
class Labs {
 public:
  Labs(const std::string& url, std::vector<int64_t> others)
      : bus_(open_bus(url)), others_(std::move(others)) {}
  ~Labs() {
    over_ = true;
    thread_.join();
  }

 private:
  void answer() {
    while (!over_) {
      bool asked = false;
      bus_->poll(2'000, [&](const Datagram& datagram) { asked |= datagram.channel == "NEED"; });
      if (!asked) continue;
      for (int n = 0; n < 3; ++n) {
        say(1);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      for (const int64_t run : others_) say(run);
    }
  }
  void say(int64_t run) { bus_->publish("RUN", encode(message_of<run_t>(run, kBeforeStart))); }

  std::unique_ptr<Bus> bus_;
  std::vector<int64_t> others_;
  std::atomic<bool> over_ = false;
  std::thread thread_{[this] { answer(); }};
};

TEST(Guest, BindsToTheOnlyLabThatAnswers) {
  Options options;
  options.url = url(next_port());
  const Labs labs(options.url, {});
  Guest guest(options);
  EXPECT_EQ(guest.run(), 0);
  EXPECT_TRUE(guest.bind_to_run());
  EXPECT_EQ(guest.run(), 1);
}

TEST(Guest, OfSeveralLabsOneMustBeNamed) {
  Options options;
  options.url = url(next_port());
  const Labs labs(options.url, {2});
  for (int n = 0; n < 5; ++n) {
    Guest guest(options);
    try {
      guest.bind_to_run();
      ADD_FAILURE() << "bound to " << guest.run();
    } catch (const UsageError& error) {
      EXPECT_STREQ(error.what(),
                   "several labs are on this bus: say which with --run: 0000000000000001 0000000000000002");
    }
  }
  options.run = "2";
  Guest named(options);
  EXPECT_TRUE(named.bind_to_run());
  EXPECT_EQ(named.run(), 2);
}

TEST(Guest, SilenceIsNoLab) {
  Options options;
  options.url = url(next_port());
  options.timeout = 0.2;
  Guest guest(options);
  EXPECT_FALSE(guest.bind_to_run());
}

// What is lost on the way, there or back, is sent again.
TEST(Guest, AsksUntilItIsAnswered) {
  Options options;
  options.url = url(next_port());
  const auto simulator = open_bus(options.url);
  std::atomic<int> asked = 0;
  std::thread answers([&] {
    for (int n = 0; n < 500 && asked < 3; ++n)
      simulator->poll(10'000, [&](const Datagram& datagram) { asked += datagram.channel == "REQUEST"; });
    simulator->publish("REPLY", encode(message_of<reply_t>(1, kBeforeStart)));
  });
  Guest guest(options);
  EXPECT_TRUE(guest.ask(Channel::Request, encode(message_of<request_t>(1, kBeforeStart)),
                        [](Channel channel, auto) { return channel == Channel::Reply; }));
  answers.join();
  EXPECT_EQ(asked, 3);
}

// The simulator's answer to `reset` is the last that it says: its process may have ended before that is read.
TEST(Guest, BelievesTheSimulatorThatItKnowsThoughItsProcessHasEnded) {
  char name[] = "/tmp/guest-net-test-XXXXXX";
  const std::filesystem::path folder = mkdtemp(name);
  std::filesystem::create_directory(folder / "processes");
  const auto record = [&](int pid) {
    std::ofstream(folder / "processes" / "state") << "process simulator running " << pid << "\n";
  };
  record(getpid());
  Options options;
  options.url = url(next_port());
  options.run_dir = folder;
  options.timeout = 5;
  const auto simulator = open_bus(options.url), stranger = open_bus(options.url);
  Guest guest(options);
  const auto wait_for = [&](Channel wanted) {
    return guest.ask(
        Channel::Request, encode(message_of<request_t>(1, kBeforeStart)),
        [&](Channel channel, auto) { return channel == wanted; }, 300'000);
  };
  simulator->publish("RUN", encode(message_of<run_t>(1, kBeforeStart)));
  EXPECT_TRUE(wait_for(Channel::Run));
  record(1);  // not ours
  stranger->publish("REPLY", encode(message_of<reply_t>(1, kBeforeStart)));
  EXPECT_FALSE(wait_for(Channel::Reply));
  simulator->publish("REPLY", encode(message_of<reply_t>(1, kBeforeStart)));
  EXPECT_TRUE(wait_for(Channel::Reply));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace lab::send
