// Seeded damages to logs: none is silent. A tenth by default; all 1,000 of each log with LAB_TEST_DAMAGES=all.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <lab/command_t.hpp>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <nlohmann/json.hpp>
#include <random>

#include "core/util/big_endian.h"
#include "lab/evaluation/read_run.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/run/run.h"
#include "procs/logger/log_files.h"
#include "procs/solo/solo.h"
#include "tests/support/paths.h"
#include "wire/log/checked_log.h"
#include "wire/log/event_hash.h"
#include "wire/log/log_reader.h"
#include "wire/log/log_writer.h"
#include "wire/protocol/log_policy.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

Bytes load(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(in), {});
}

void store(const std::string& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

struct Place {
  size_t offset, size;
  std::string channel;
};

std::vector<Place> places_of(const std::string& path) {
  std::vector<Place> places;
  LogReader reader(path);
  for (LogEvent event; reader.next(event);)
    places.push_back({event.offset, event.bytes.size(), std::string(event.channel)});
  return places;
}

/// A sound log, and the log of another run.
struct Log {
  Bytes bytes, other;
  std::vector<Place> places;
};

Bytes solo_log(const std::string& dir, const std::vector<std::string>& set) {
  fs::create_directories(dir);
  const Experiment e = load_experiment(source_path("experiments/cubic_pd.yaml"), set);
  logger::LogFiles files(dir);
  const Outcome outcome = solo::run(e, load_robot(e), files, [](int64_t) { return true; });
  EXPECT_EQ(outcome.exit_code, kOk) << outcome.reason;
  return load(dir + "/log.lcm");
}

template <class T>
Bytes of_step(T message, int64_t run, int64_t step) {
  message.run = run, message.step = step, message.utime = 1'700'000'000'000'000 + 1000 * step;
  if constexpr (requires { message.nq; }) message.nq = 6;
  if constexpr (requires { message.nv; }) message.nv = 6;
  if constexpr (requires { message.q; }) message.q.assign(6, 0.001 * static_cast<double>(step));
  if constexpr (requires { message.v; }) message.v.assign(6, 0.5);
  if constexpr (requires { message.a; }) message.a.assign(6, 0.25);
  if constexpr (requires { message.tau; }) message.tau.assign(6, 0.125);
  return encode(message);
}

/// What the logger writes of a run in real time. Without END the log is left as a kill leaves it.
Bytes realtime_log(const std::string& dir, int64_t steps, bool with_end, uint64_t quota = 0) {
  fs::create_directories(dir);
  const Experiment e =
      load_experiment(source_path("experiments/cubic_pd.yaml"),
                      {"simulator.clock=realtime", "simulator.dt=0.001",
                       "simulator.duration=" + std::to_string(static_cast<double>(steps - 1) * 1e-3)});
  const run_t run = make_run(e, load_robot(e));
  logger::LogFiles files(dir, quota);
  const Publish nobody = [](Channel, std::span<const uint8_t>) {};
  RunLog log(files, nobody);
  log.open(encode(run), run, setup_of(open_run(run)), true, type_messages);
  RealtimeLogPolicy policy(log, 1);
  const auto add = [&](Channel channel, const Bytes& bytes) { policy.receive(channel, bytes, 0); };
  add(Channel::Reference, of_step(reference_t{}, run.run, 0));
  for (int64_t step = 0; step < steps; ++step) {
    if (step % 50 == 7) add(Channel::Event, of_step(event_t{}, run.run, step));
    add(Channel::RobotState, of_step(robot_state_t{}, run.run, step));
    add(Channel::Reference, of_step(reference_t{}, run.run, step + 1));
    if (step > 0) add(Channel::Command, of_step(command_t{}, run.run, step - 1));
    if (step % 64 == 0) log.flush();
  }
  log.flush();
  if (!with_end) return load(dir + "/log.lcm.part");
  end_t end{};
  end.run = run.run, end.step = steps - 1;
  end.utime = 1'700'000'000'000'000 + 1000 * end.step;
  log.set_end(encode(end));
  policy.on_end(0);
  return load(dir + "/log.lcm");
}

/// One damage; says what it is. `before`: it begins before this offset.
class Damage {
 public:
  Damage(const Log& log, uint64_t seed, size_t before) : log_(log), rng_(seed), bytes_(log.bytes) {
    places_ = static_cast<size_t>(std::count_if(log.places.begin(), log.places.end(),
                                                [&](const Place& p) { return p.offset < before; }));
    const size_t at = below(std::min(before, bytes_.size()));
    const std::pair<const char*, std::function<void()>> kinds[] = {
        {"hole", [&] { erase(at, 1 + below(3000)); }},
        {"zeros", [&] { zero(at, 1 + below(600)); }},
        {"a field of zeros", [&] { zero(at, 8); }},
        {"an event doubled", [&] { insert_copy(); }},
        {"two events swapped", [&] { swap(); }},
        {"an event deleted", [&] { erase_event(); }},
        {"a flipped bit", [&] { flip(at); }},
        {"a flipped bit in a header", [&] { flip(place().offset + below(28)); }},
        {"a flipped bit in RUN, TYPE or END", [&] { flip_in_frame(); }},
        {"bits flipped",
         [&] {
           for (size_t n = 2 + below(5); n > 0; --n) flip(below(std::min(before, bytes_.size())));
         }},
        {"cut off", [&] { bytes_.resize(at); }},
        {"cut off after an event", [&] { bytes_.resize(place().offset); }},
        {"an absurd step", [&] { absurd_step(); }},
        {"another run behind", [&] { insert(place().offset, log_.other); }},
        {"a piece of another run",
         [&] {
           insert(place().offset, {log_.other.begin(),
                                   log_.other.begin() + static_cast<ptrdiff_t>(below(log_.other.size()))});
         }},
        {"bytes inserted", [&] { insert(at, Bytes(1 + below(50), static_cast<uint8_t>(rng_()))); }},
    };
    const auto& [name, apply] = kinds[below(std::size(kinds))];
    what = name;
    apply();
  }
  const Bytes& bytes() const { return bytes_; }
  std::string what;

 private:
  size_t below(size_t bound) { return rng_() % bound; }
  const Place& place() { return log_.places[below(places_)]; }
  auto at(size_t offset) { return bytes_.begin() + static_cast<ptrdiff_t>(std::min(offset, bytes_.size())); }
  void erase(size_t offset, size_t size) { bytes_.erase(at(offset), at(offset + size)); }
  void zero(size_t offset, size_t size) { std::fill(at(offset), at(offset + size), 0); }
  void insert(size_t offset, const Bytes& bytes) { bytes_.insert(at(offset), bytes.begin(), bytes.end()); }
  void flip(size_t offset) {
    bytes_[std::min(offset, bytes_.size() - 1)] ^= static_cast<uint8_t>(1 << below(8));
  }
  Bytes event(const Place& p) {
    const auto begin = log_.bytes.begin() + static_cast<ptrdiff_t>(p.offset);
    return {begin, begin + static_cast<ptrdiff_t>(p.size)};
  }
  void insert_copy() {
    const Place& p = place();
    insert(below(2) ? p.offset + p.size : place().offset, event(p));
  }
  void swap() {
    const size_t i = below(places_ - 1), j = below(2) ? i + 1 : below(places_);
    const Place &a = log_.places[std::min(i, j)], &b = log_.places[std::max(i, j)];
    const Bytes first = event(a), second = event(b);
    if (i == j) return flip(a.offset);
    erase(b.offset, b.size), insert(b.offset, first), erase(a.offset, a.size), insert(a.offset, second);
  }
  void erase_event() {
    const Place& p = place();
    erase(p.offset, p.size);
  }
  void flip_in_frame() {
    std::vector<Place> frame;
    for (size_t i = 0; i < places_; ++i)
      if (const std::string& c = log_.places[i].channel; c == "RUN" || c == "TYPE" || c == "END")
        frame.push_back(log_.places[i]);
    const Place& p = frame[below(frame.size())];
    flip(p.offset + below(p.size));
  }
  void absurd_step() {
    const Place& p = place();
    const int64_t steps[] = {1'000'000'000'000, -5, INT64_MAX, 3, 100'000, 1000};
    Bytes step;
    append_big_endian(step, steps[below(std::size(steps))]);
    std::copy(step.begin(), step.end(), at(p.offset + 28 + p.channel.size() + 24));
  }

  const Log& log_;
  std::mt19937_64 rng_;
  Bytes bytes_;
  size_t places_;  ///< that may be damaged
};

class DamagedLog : public testing::Test {
 protected:
  DamagedLog() {
    char name[] = "/tmp/lab-damaged-log-test-XXXXXX";
    dir_ = mkdtemp(name);
  }
  ~DamagedLog() override { fs::remove_all(dir_); }

  static int damages() {
    const char* wanted = getenv("LAB_TEST_DAMAGES");
    return wanted && std::string(wanted) == "all" ? 1000 : 100;
  }
  Log log_of(const Bytes& bytes, const Bytes& other) const {
    store(dir_ + "/whole.lcm", bytes);
    return {bytes, other, places_of(dir_ + "/whole.lcm")};
  }
  LogFindings read(const Bytes& bytes) {
    store(file(), bytes);
    return read_checked(file(), [](Channel, std::span<const uint8_t>) {});
  }
  std::string file() const { return dir_ + "/damaged.lcm"; }
  /// Whether evaluate would say that all is well.
  bool evaluates_as_good() const {
    try {
      const LoggedRun run = read_run(file());
      return run.log.sound() && !run.run.aborted;
    } catch (const std::runtime_error&) {
      return false;
    }
  }
  /// None of the damages may be silent. In a log without END, those before `proven` may not.
  void none_is_silent(const Log& log, bool has_end, size_t proven) {
    const LogFindings whole = read(log.bytes);
    ASSERT_TRUE(whole.sound()) << text_of(whole.damages[0]);
    ASSERT_EQ(whole.has_end, has_end);
    for (int seed = 0; seed < damages(); ++seed) {
      const Damage damage(log, static_cast<uint64_t>(seed), proven);
      if (damage.bytes() == log.bytes) continue;  // zeros where zeros were
      const LogFindings found = read(damage.bytes());
      const bool cut = damage.what.starts_with("cut off") && !has_end;
      EXPECT_TRUE(cut || !(has_end ? found.complete() : found.sound())) << damage.what << ", seed " << seed;
      if (has_end) {
        EXPECT_FALSE(evaluates_as_good()) << damage.what << ", seed " << seed;
      }
    }
  }
  std::string dir_;
};

TEST_F(DamagedLog, InLockstepNoDamageIsSilent) {
  const Bytes other = solo_log(dir_ + "/b", {"simulator.duration=0.1", "controller.kp=40"});
  none_is_silent(log_of(solo_log(dir_ + "/a", {"simulator.duration=0.5"}), other), true, SIZE_MAX);
}

// no digest proves such steps: the logger writes CHECK
TEST_F(DamagedLog, NorWhereOnlySomeStepsAreLogged) {
  const Bytes other = solo_log(dir_ + "/b", {"simulator.duration=0.1", "logger.every=2"});
  none_is_silent(log_of(solo_log(dir_ + "/a", {"simulator.duration=10", "logger.every=3"}), other), true,
                 SIZE_MAX);
}

TEST_F(DamagedLog, NorInRealTime) {
  none_is_silent(log_of(realtime_log(dir_ + "/a", 800, true), realtime_log(dir_ + "/b", 20, true)), true,
                 SIZE_MAX);
}

// beyond the last CHECK nothing proves anything
TEST_F(DamagedLog, NorInRealTimeBeforeTheLastCheckOfALogWithoutEnd) {
  static_assert(kCheckEvery == 1000);
  const Log log = log_of(realtime_log(dir_ + "/a", 800, false), realtime_log(dir_ + "/b", 20, true));
  const auto check = std::find_if(log.places.rbegin(), log.places.rend(),
                                  [](const Place& p) { return p.channel == "CHECK"; });
  ASSERT_NE(check, log.places.rend());
  EXPECT_LE(check - log.places.rbegin(), kCheckEvery);
  none_is_silent(log, false, check->offset);
}

TEST_F(DamagedLog, TheStepsThatAreWholeAreUsedAndOnlyThey) {
  const Bytes bytes = solo_log(dir_ + "/a", {"simulator.duration=0.5"});
  const Log log = log_of(bytes, {});
  Bytes damaged = bytes;
  size_t state_20 = 0;
  for (int seen = -1; seen < 20; ++state_20) seen += log.places[state_20].channel == "ROBOT_STATE";
  const Place& place = log.places[state_20 - 1];
  damaged[place.offset + place.size - 50] ^= 1;
  store(file(), damaged);
  const LoggedRun run = read_run(file());
  ASSERT_EQ(run.run.steps.size(), 50u) << "51 but one";
  EXPECT_EQ(run.run.steps[19].state.step, 19);
  EXPECT_EQ(run.run.steps[20].state.step, 21);
  ASSERT_EQ(run.log.damages.size(), 1u);
  EXPECT_EQ(text_of(run.log.damages[0]),
            "offset " + std::to_string(place.offset) +
                ", step 20: its bytes do not have the digest that the simulator published");
  EXPECT_FALSE(evaluate_logged(run)["passed"].get<bool>());
}

// END had no check then, and so another fingerprint
TEST_F(DamagedLog, ALogOfAnEarlierVersionHasNoChecksumsAndStaysReadable) {
  const std::string old = source_path("tests/golden/log_without_checksums.lcm");
  const LoggedRun run = read_run(old);
  EXPECT_TRUE(run.log.complete()) << text_of(run.log.damages[0]);
  EXPECT_FALSE(run.log.checksums);
  EXPECT_FALSE(run.run.aborted);
  EXPECT_EQ(run.run.steps.size(), 21u);
  const Bytes today = solo_log(dir_ + "/a", {"simulator.duration=0.2"});
  store(file(), today);
  const LoggedRun again = read_run(file());
  EXPECT_TRUE(again.log.checksums);
  EXPECT_EQ(again.run.steps.size(), run.run.steps.size());
  // its steps have digests all the same
  const Log log = log_of(load(old), {});
  Bytes damaged = log.bytes;
  const auto command = std::find_if(log.places.begin(), log.places.end(),
                                    [](const Place& p) { return p.channel == "COMMAND"; });
  damaged[command->offset + command->size - 20] ^= 1;
  EXPECT_EQ(read(damaged).damage_count, 1);
}

// As earlier versions wrote it: no CHECK, no check in END.
TEST_F(DamagedLog, WithoutChecksumsItLooksAtFramingNumbersRunAndSteps) {
  store(dir_ + "/new.lcm", realtime_log(dir_ + "/a", 300, true));
  LogReader reader(dir_ + "/new.lcm");
  LogWriter writer(dir_ + "/old.lcm");
  for (LogEvent event; reader.next(event);) {
    Bytes message(event.data.begin(), event.data.end());
    if (event.channel == "END") std::fill(message.end() - 8, message.end(), 0);
    if (event.channel != "CHECK" && event.channel != "TYPE") writer.add(event.utime, event.channel, message);
  }
  writer.finish();
  const Log log = log_of(load(dir_ + "/old.lcm"), {});
  const Place& state = *std::find_if(log.places.begin() + 450, log.places.end(),
                                     [](const Place& p) { return p.channel == "ROBOT_STATE"; });
  const auto complete = [&](size_t offset, uint8_t bit) {
    Bytes bytes = log.bytes;
    bytes[state.offset + offset] ^= bit;
    return read(bytes).complete();
  };
  EXPECT_FALSE(read(log.bytes).checksums);
  EXPECT_TRUE(complete(0, 0));
  EXPECT_TRUE(complete(state.size - 36, 1)) << "an effort: nothing knows better";
  EXPECT_FALSE(complete(3, 1)) << "sync word";
  EXPECT_FALSE(complete(11, 1)) << "number";
  const size_t message = 28 + state.channel.size();
  EXPECT_FALSE(complete(message + 16, 1)) << "run";
  EXPECT_FALSE(complete(message + 24, 1)) << "step";
}

TEST_F(DamagedLog, TwoRunsInOneFileAreNeverMixed) {
  const Bytes first = solo_log(dir_ + "/a", {"simulator.duration=0.5"});
  const Bytes other = solo_log(dir_ + "/b", {"simulator.duration=0.5", "controller.kp=40"});
  Bytes both(first.begin(), first.begin() + static_cast<ptrdiff_t>(first.size() / 2));
  both.insert(both.end(), other.begin(), other.end());
  store(file(), both);
  const LoggedRun run = read_run(file());
  store(file(), first);
  EXPECT_EQ(run.id, read_run(file()).id);
  EXPECT_LT(run.run.steps.size(), 30u);
  EXPECT_FALSE(run.log.sound());
  EXPECT_TRUE(run.run.aborted) << "END is the other run's";
}

TEST_F(DamagedLog, APieceOfASplitLogIsSoundByItself) {
  realtime_log(dir_ + "/a", 3000, true, 2'000'000);
  for (const char* name : {"/a/log.earlier.lcm", "/a/log.lcm"}) {
    const LogFindings found = read_checked(dir_ + name, [](Channel, std::span<const uint8_t>) {});
    EXPECT_TRUE(found.sound()) << name << ": " << text_of(found.damages[0]);
    EXPECT_EQ(places_of(dir_ + name)[0].channel, "RUN");
  }
}

}  // namespace
}  // namespace lab
