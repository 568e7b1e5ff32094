#include <gtest/gtest.h>

#include <lab/ack_t.hpp>
#include <lab/command_t.hpp>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>

#include "tests/wire/protocol/lockstep_world.h"

namespace lab::test {
namespace {

constexpr Weather kCalm;
#ifdef __SANITIZE_ADDRESS__
constexpr uint64_t kRuns = 20;  // of each weather: a sanitizer is slow, and looks for something else
#else
constexpr uint64_t kRuns = 150;
#endif

std::vector<Logged> calm_log(uint64_t seed) {
  World world(seed, kCalm);
  EXPECT_TRUE(world.run());
  return world.log().kept;
}

// The second road: one loop that knows no messages but makes them, step by step, from the rules alone.
std::vector<Logged> log_by_hand(const run_t& run) {
  const RunSetup setup = toy_setup(run);
  ToySimulator simulator;
  ToyPlanner planner;
  ToyController controller;
  std::vector<Logged> log{{Channel::Run, encode(run)}};
  Command command;
  int64_t digest = 0;
  std::vector<RobotState> states;
  for (int64_t step = 0; step <= setup.last_step; ++step) {
    StepRecord record;
    record.step = step;
    const bool fresh = step > 0 && (step - 1) % setup.every == 0;
    const StepResult advance = simulator(step, fresh ? &command : nullptr, {});
    const auto add_events = [&](const std::vector<Event>& events, const char* process) {
      for (size_t i = 0; i < events.size(); ++i)
        record.store(Channel::Event,
                     encode(to_message(events[i], process, step, step_utime(step, setup.dt), run.run,
                                       static_cast<int64_t>(i))),
                     true);
    };
    const auto head = [&](auto& message, const std::vector<Event>& events) {
      message.utime = step_utime(step, setup.dt);
      message.run = run.run;
      message.step = step;
      message.extras = static_cast<int32_t>(events.size());
    };
    robot_state_t state{};
    to_message(advance.state, state);
    head(state, advance.events);
    state.digest = digest;
    state.command_step = step ? (step - 1) / setup.every * setup.every : -1;
    record.state = encode(state);
    add_events(advance.events, kSimulator);

    std::vector<Event> events;
    const Reference reference = planner(step, {}, events);
    reference_t wanted{};
    to_message(reference, wanted);
    head(wanted, events);
    record.reference = encode(wanted);
    add_events(events, kPlanner);

    if (step % setup.every == 0) {
      events.clear();
      command = controller(advance.state, reference, {}, events);
      command_t effort{};
      to_message(command, effort);
      head(effort, events);
      effort.state_step = effort.reference_step = step;
      record.command = encode(effort);
      add_events(events, kController);
    }
    digest = record.digest();
    record.in_order([&](Channel channel, const Bytes& bytes) { log.push_back({channel, bytes}); });
  }
  end_t end{};
  end.run = run.run;
  end.step = setup.last_step;
  end.utime = step_utime(end.step, setup.dt);
  end.digest = digest;
  LogHash ends;  // proves RUN and END themselves; these runs have no TYPE
  ends.add(Channel::Run, encode(run));
  ends.add(Channel::End, encode(end));
  end.check = ends.value();
  log.push_back({Channel::End, encode(end)});
  return log;
}

TEST(Lockstep, ACalmRunEqualsThePlainLoop) {
  for (uint64_t seed = 0; seed < 42; ++seed) {  // every combination of lead 0..6 and every 1..3
    World world(seed, kCalm);
    ASSERT_TRUE(world.run()) << "seed " << seed;
    EXPECT_EQ(world.outcome(kSimulator).exit_code, kOk) << world.outcome(kSimulator).reason;
    EXPECT_TRUE(world.log().closed);
    EXPECT_EQ(world.log().kept, log_by_hand(world.run_message())) << "seed " << seed;
  }
}

class LockstepInBadWeather : public testing::TestWithParam<std::pair<const char*, Weather>> {};

TEST_P(LockstepInBadWeather, WritesTheSameLog) {
  uint64_t crashes = 0;
  for (uint64_t seed = 1000; seed < 1000 + kRuns; ++seed) {
    World world(seed, GetParam().second);
    ASSERT_TRUE(world.run()) << "seed " << seed << ": stuck at step " << world.role(kSimulator).step();
    ASSERT_EQ(world.outcome(kSimulator).exit_code, kOk)
        << "seed " << seed << ": " << world.outcome(kSimulator).reason;
    ASSERT_TRUE(world.log().closed);
    ASSERT_EQ(world.log().kept, calm_log(seed)) << "seed " << seed;
    crashes += static_cast<uint64_t>(world.crashes());
  }
  if (GetParam().second.crash > 0) {
    EXPECT_GT(crashes, kRuns / 5) << "the weather was too mild to show anything";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Weathers, LockstepInBadWeather,
    testing::Values(
        std::pair{"loss", Weather{.loss = 0.05}}, std::pair{"heavy_loss", Weather{.loss = 0.4}},
        std::pair{"doubles", Weather{.twice = 0.5, .longest_delay = 3000}},
        std::pair{"delay", Weather{.longest_delay = 20'000}},
        std::pair{"freezes", Weather{.loss = 0.02, .freeze = 0.2}},
        std::pair{"crashes", Weather{.longest_delay = 2'000, .crash = 0.15}},
        std::pair{"all",
                  Weather{.loss = 0.2, .twice = 0.2, .longest_delay = 5'000, .crash = 0.04, .freeze = 0.05}}),
    [](const auto& info) { return std::string(info.param.first); });

// With REQUESTs the log depends on when they came, but it must explain itself: folding the pure steps over
// its own INPUTs gives every other byte of it again.
TEST(Lockstep, ALogWithInputsExplainsItself) {
  uint64_t inputs = 0;
  for (uint64_t seed = 0; seed < kRuns; ++seed) {
    World world(
        seed,
        {.loss = 0.1, .twice = 0.1, .longest_delay = 2'000, .crash = 0.02, .freeze = 0.02, .requests = 3});
    ASSERT_TRUE(world.run()) << "seed " << seed;
    ASSERT_EQ(world.outcome(kSimulator).exit_code, kOk) << world.outcome(kSimulator).reason;
    const RunSetup setup = toy_setup(world.run_message());
    std::map<int64_t, std::vector<Action>> actions;
    std::map<int64_t, StepRecord> records;
    for (const Logged& entry : world.log().kept) {
      if (entry.channel == Channel::Run || entry.channel == Channel::End) continue;
      const int64_t step = peek_step(entry.bytes);
      records[step].store(entry.channel, entry.bytes, true);
      if (entry.channel == Channel::Input) {
        actions[step].push_back(to_signal(decode<input_t>(entry.bytes).action));
        ++inputs;
      }
    }
    ToySimulator simulator;
    ToyPlanner planner;
    ToyController controller;
    Command command;
    std::map<int64_t, Reference> references;
    std::vector<Event> events;
    for (int64_t step = 0; step < setup.lead; ++step) references[step] = planner(step, {}, events);
    std::vector<Action> pending;
    for (auto& [step, record] : records) {
      const bool fresh = step > 0 && (step - 1) % setup.every == 0;
      const StepResult advance = simulator(step, fresh ? &command : nullptr, actions[step]);
      const auto state = to_signal(decode<robot_state_t>(record.state));
      ASSERT_EQ(state.q, advance.state.q) << "seed " << seed << " step " << step;
      if (step + setup.lead <= setup.last_step)
        references[step + setup.lead] = planner(step + setup.lead, {nullptr, actions[step]}, events);
      ASSERT_EQ(to_signal(decode<reference_t>(record.reference)).q, references[step].q)
          << "seed " << seed << " step " << step;
      pending.insert(pending.end(), actions[step].begin(), actions[step].end());
      if (step % setup.every != 0) continue;
      command = controller(state, references[step], pending, events);
      pending.clear();
      ASSERT_EQ(to_signal(decode<command_t>(record.command)).tau, command.tau)
          << "seed " << seed << " step " << step;
    }
  }
  EXPECT_GT(inputs, kRuns / 2);
}

TEST(Lockstep, AGracefulStopClosesTheLogAtAWholeStep) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    World world(seed, {.loss = 0.1});
    world.at_step(8 + static_cast<int64_t>(seed % 20), [&] { world.role(kSimulator).stop(0); });
    ASSERT_TRUE(world.run());
    EXPECT_EQ(world.outcome(kSimulator).exit_code, kOk);
    ASSERT_TRUE(world.log().closed);
    const auto whole = calm_log(seed);
    const auto& cut = world.log().kept;
    ASSERT_LT(cut.size(), whole.size() + 1);
    EXPECT_TRUE(std::equal(cut.begin(), cut.end() - 1, whole.begin()));
    EXPECT_EQ(cut.back().channel, Channel::End);
  }
}

TEST(Lockstep, ASilentProcessEndsTheRunAndIsNamed) {
  for (const char* name : {kPlanner, kController, kLogger}) {
    World world(5, kCalm);
    world.at_step(3, [&] { world.freeze_for_good(name); });
    ASSERT_TRUE(world.run());
    EXPECT_EQ(world.outcome(kSimulator).exit_code, kTransport);
    // The logger's silence shows at the latest when its ACK of the closed log is awaited.
    const std::string& reason = world.outcome(kSimulator).reason;
    EXPECT_TRUE(reason.starts_with(name) && reason.ends_with(" in 10 s")) << reason;
    if (name == std::string(kLogger)) continue;
    const auto whole = calm_log(5);
    const auto& cut = world.log().kept;
    ASSERT_TRUE(world.log().closed);
    EXPECT_TRUE(std::equal(cut.begin(), cut.end() - 1, whole.begin())) << "whole steps, and nothing else";
    EXPECT_TRUE(decode<end_t>(cut.back().bytes).aborted);
  }
}

TEST(Lockstep, AProcessThatNeverComesIsNamed) {
  World world(5, kCalm);
  world.freeze_for_good(kController);
  ASSERT_TRUE(world.run());
  EXPECT_EQ(world.outcome(kSimulator).exit_code, kNotReady);
  EXPECT_EQ(world.outcome(kSimulator).reason, "not ready in 10 s: controller (never heard)");
}

/// A simulator alone, with answers made by hand.
struct Bench {
  std::vector<std::pair<Channel, Bytes>> sent;
  SimulatorConfig config;
  std::unique_ptr<LockstepSimulatorRole> simulator;
  explicit Bench(int64_t last_step = 5) {
    run_t run{};
    run.run = 1;
    config.run = encode(run);
    config.run_id = 1;
    config.model_hash = 7;
    config.nq = config.nv = 2;
    config.dt = 0.01;
    config.last_step = last_step;
    simulator = std::make_unique<LockstepSimulatorRole>(
        config, ToySimulator(), [this](Channel channel, std::span<const uint8_t> bytes) {
          sent.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
        });
  }
  void process(const char* name, int32_t pid, int64_t utime, int64_t hash = 7) {
    process_t p{};
    p.utime = utime;
    p.run = 1;
    p.step = -1;
    p.name = name;
    p.pid = pid;
    p.state = "READY";
    p.model_hash = hash;
    simulator->receive(Channel::Process, encode(p), 0);
  }
  void all_ready() {
    process(kPlanner, 1, 0);
    process(kController, 2, 0);
    process(kLogger, 3, 0);
  }
  void answer(int64_t step) {
    reference_t reference{};
    reference.run = 1;
    reference.step = step;
    reference.nq = reference.nv = 2;
    reference.q = reference.v = reference.a = {0, 0};
    command_t command{};
    command.run = 1;
    command.step = step;
    command.nv = 2;
    command.tau = {0, 0};
    simulator->receive(Channel::Reference, encode(reference), 0);
    simulator->receive(Channel::Command, encode(command), 0);
  }
  void ack(int64_t complete_to) {
    ack_t ack{};
    ack.run = 1;
    ack.process = kLogger;
    ack.complete_to = complete_to;
    simulator->receive(Channel::Ack, encode(ack), 0);
  }
  int64_t count(Channel channel) const {
    return std::count_if(sent.begin(), sent.end(), [&](const auto& entry) { return entry.first == channel; });
  }
};

TEST(LockstepSimulatorRole, WaitsForEveryRequiredProcess) {
  Bench bench;
  bench.process(kPlanner, 1, 0);
  bench.process(kController, 2, 0);
  EXPECT_EQ(bench.count(Channel::RobotState), 0);
  bench.process(kLogger, 3, 0);
  EXPECT_EQ(bench.count(Channel::RobotState), 1);
}

TEST(LockstepSimulatorRole, AnotherModelEndsTheRunWithBothHashes) {
  Bench bench;
  bench.process(kController, 2, 0, 0xabc);
  EXPECT_EQ(bench.simulator->state(), "FAULT");
  ASSERT_EQ(bench.sent.back().first, Channel::End);
  const auto end = decode<end_t>(bench.sent.back().second);
  EXPECT_TRUE(end.aborted);
  EXPECT_EQ(end.reason,
            "controller has another model: hash 0000000000000abc, the simulator's is 0000000000000007");
}

TEST(LockstepSimulatorRole, OfTwoLiveProcessesOfOneNameTheNewerCounts) {
  Bench bench;
  bench.process(kPlanner, 1, 0);
  bench.process(kController, 2, 100);
  bench.process(kController, 20, 110);        // restarted
  bench.process(kController, 2, 120, 0xabc);  // the first lives, with another model
  EXPECT_EQ(bench.simulator->state(), "READY") << "it ends nothing";
  bench.process(kLogger, 3, 0);
  EXPECT_EQ(bench.simulator->state(), "RUNNING");
}

TEST(LockstepSimulatorRole, NeedAndAckOfImpossibleStepsDoNothing) {
  Bench bench;
  bench.all_ready();
  const size_t before = bench.sent.size();
  for (int64_t step : {int64_t{1} << 62, int64_t{-7}, int64_t{300}}) {
    need_t need{};
    need.run = 1;
    need.step = step;
    need.process = kSimulator;
    bench.simulator->receive(Channel::Need, encode(need), 0);
  }
  EXPECT_EQ(bench.sent.size(), before);
  bench.ack(int64_t{1} << 62);  // would be credit for ever
  EXPECT_EQ(bench.simulator->step(), 0);
}

// What the logger may still ask for must not be overwritten: without its ACK the run stands still after a window.
TEST(LockstepSimulatorRole, RunsAtMostAWindowAheadOfTheLoggersAck) {
  Bench bench(1000);
  bench.all_ready();
  const auto answer_all = [&] {
    for (int64_t answered = -1; answered < bench.simulator->step();)
      bench.answer(answered = bench.simulator->step());
    return bench.simulator->step();
  };
  EXPECT_EQ(answer_all(), kBeforeStart + kWindow);
  bench.ack(int64_t{1} << 62);  // of a step that has not been: no credit
  EXPECT_EQ(answer_all(), kBeforeStart + kWindow);
  bench.ack(100);
  EXPECT_EQ(answer_all(), 100 + kWindow);
  bench.ack(50);  // late: takes nothing back, and gives nothing
  EXPECT_EQ(answer_all(), 100 + kWindow);
}

TEST(LockstepSimulatorRole, ARefusedCommandIsASafetyStopWhenItIsNotFinite) {
  Bench bench;
  bench.all_ready();
  bench.simulator->refused({Channel::Command, 0, true, "COMMAND: tau[1] is nan"}, 0);
  EXPECT_EQ(decode<end_t>(bench.sent.back().second).reason,
            "controller's message for step 0 was refused: COMMAND: tau[1] is nan");
}

TEST(LockstepSimulatorRole, PauseStepAndResumeChangeNoBytes) {
  Bench bench;
  bench.all_ready();
  int64_t id = 0;
  const auto request = [&](const char* verb) {
    request_t r{};
    r.sender = "test";
    r.id = ++id;
    r.step = -1;
    r.action.verb = verb;
    bench.simulator->receive(Channel::Request, encode(r), 0);
  };
  request("pause");
  bench.answer(0);
  EXPECT_EQ(bench.simulator->step(), 0);
  request("step");
  EXPECT_EQ(bench.simulator->step(), 1);
  bench.answer(1);
  EXPECT_EQ(bench.simulator->step(), 1);
  request("resume");
  EXPECT_EQ(bench.simulator->step(), 2);
  EXPECT_EQ(bench.count(Channel::Input), 0);
  EXPECT_EQ(bench.count(Channel::Reply), 3);
}

}  // namespace
}  // namespace lab::test
