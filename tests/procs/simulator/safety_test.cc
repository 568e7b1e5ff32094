// The safety state machine: every transition of docs/safety.md, and that nothing else moves it.
#include "procs/simulator/safety.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>

namespace lab::safety {
namespace {

constexpr Config kAuto{.timeout = 20, .manual = false, .fresh_to_resume = 20};
constexpr Config kManual{.timeout = 20, .manual = true, .fresh_to_resume = 20};

/// A machine and its own count of steps.
struct Machine {
  explicit Machine(Config c) : config(c), state(initial(c)) {}
  /// The next step; `age` = how many steps ago the command's state was, 0 = no command.
  Mode next(int64_t age = 0, bool estop = false, bool rearm = false) {
    Input input{.step = ++now, .command_from = {}, .estop = estop, .rearm = rearm};
    if (age > 0) input.command_from = now - age;
    return step(config, state, input, events);
  }
  Mode commanded(int steps) {
    for (int i = 0; i < steps; ++i) next(1);
    return state.mode;
  }
  std::string last() const { return events.empty() ? "" : events.back().what; }

  Config config;
  State state;
  int64_t now = 0;
  std::vector<Event> events;
};

TEST(Safety, WaitsForTheFirstCommandThenRuns) {
  Machine m(kAuto);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(m.next(), Mode::Waiting);
  EXPECT_TRUE(m.events.empty());
  EXPECT_EQ(m.next(1), Mode::Running);
  EXPECT_EQ(m.last(), "running");
}

TEST(Safety, HoldsAtTheTimeoutNotBefore) {
  Machine m(kAuto);
  m.commanded(5);
  const int64_t from = m.now - 1;  // the state of the last command
  while (m.next() == Mode::Running) EXPECT_LT(m.now - from, 20);
  EXPECT_EQ(m.now - from, 20);
  EXPECT_EQ(m.last(), "holding");
}

TEST(Safety, AFrozenReplayedOrFutureCommandIsStale) {
  Machine m(kAuto);
  m.commanded(3);
  const int64_t frozen = m.now - 1;
  Mode mode = Mode::Running;
  for (int i = 0; i < 30; ++i) {
    Input input{.step = ++m.now, .command_from = i % 3 == 0 ? frozen : i % 3 == 1 ? 0 : m.now + 5};
    mode = step(m.config, m.state, input, m.events);
  }
  EXPECT_EQ(mode, Mode::Holding);
  EXPECT_EQ(m.state.newest, frozen);
}

// Each bound of freshness by itself: newer than all before it, of a state that exists, younger than the timeout.
TEST(Safety, FreshBeginsAndEndsWhereThePageSays) {
  const State state{.mode = Mode::Running, .newest = 100};
  EXPECT_FALSE(fresh(kAuto, state, 110, 100)) << "the same state again";
  EXPECT_TRUE(fresh(kAuto, state, 110, 101));
  EXPECT_TRUE(fresh(kAuto, state, 110, 109));
  EXPECT_FALSE(fresh(kAuto, state, 110, 110)) << "not published yet";
  EXPECT_TRUE(fresh(kAuto, state, 200, 181));
  EXPECT_FALSE(fresh(kAuto, state, 200, 180)) << "exactly the timeout old";
}

TEST(Safety, ARepeatedCommandCountsOnceTowardsTheTwenty) {
  Machine m(kAuto);
  m.commanded(1);
  while (m.next() == Mode::Running) {
  }
  for (int i = 0; i < 19; ++i) {
    EXPECT_EQ(m.next(1), Mode::Holding);
    EXPECT_EQ(m.next(2), Mode::Holding) << "the one before, again";
  }
  EXPECT_EQ(m.state.fresh_in_a_row, 19);
  EXPECT_EQ(m.next(1), Mode::Running);
}

TEST(Safety, AutoEndsHoldingAfterTwentyFreshInARow) {
  Machine m(kAuto);
  m.commanded(1);
  while (m.next() == Mode::Running) {
  }
  EXPECT_EQ(m.commanded(19), Mode::Holding);
  for (int i = 0; i < 25; ++i) m.next();  // the row breaks
  EXPECT_EQ(m.commanded(19), Mode::Holding);
  EXPECT_EQ(m.next(1), Mode::Running);
}

TEST(Safety, ManualWaitsForAPerson) {
  Machine m(kManual);
  m.commanded(1);
  while (m.next() == Mode::Running) {
  }
  EXPECT_EQ(m.commanded(100), Mode::Holding);
  EXPECT_EQ(m.next(1, false, true), Mode::Running);  // enough fresh commands long ago
  while (m.next() == Mode::Running) {
  }
  EXPECT_EQ(m.next(0, false, true), Mode::Holding) << "a person alone is not enough";
  EXPECT_EQ(m.commanded(19), Mode::Holding);
  EXPECT_EQ(m.next(1), Mode::Running);
}

TEST(Safety, AnEmergencyStopIsLatched) {
  for (const Config& config : {kAuto, kManual}) {
    Machine m(config);
    m.commanded(5);
    EXPECT_EQ(m.next(1, true), Mode::Stopped);
    EXPECT_EQ(m.last(), "estop");
    EXPECT_EQ(m.commanded(100), Mode::Stopped);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(m.next(), Mode::Stopped);
    EXPECT_EQ(m.next(1, true, true), Mode::Stopped) << "who says both means stop";
    EXPECT_EQ(m.next(1, false, true), Mode::Holding);
    EXPECT_EQ(m.commanded(19), Mode::Holding);
    EXPECT_EQ(m.next(1), Mode::Running);
  }
}

TEST(Safety, EstopWorksWhileWaitingAndHolding) {
  Machine waiting(kAuto);
  EXPECT_EQ(waiting.next(0, true), Mode::Stopped);
  EXPECT_EQ(waiting.commanded(50), Mode::Stopped);
  Machine holding(kAuto);
  holding.commanded(1);
  while (holding.next() == Mode::Running) {
  }
  EXPECT_EQ(holding.next(0, true), Mode::Stopped);
}

TEST(Safety, ATripHoldsAsTheWatchdogDoes) {
  Machine m(kManual);
  m.commanded(5);
  trip(m.config, m.state, "elbow", "too fast", m.events);
  EXPECT_EQ(m.state.mode, Mode::Holding);
  EXPECT_EQ(m.events.back().who, "elbow");
  EXPECT_EQ(m.commanded(50), Mode::Holding);
}

TEST(Safety, LockstepHasNoWatchdogButAnEmergencyStop) {
  Machine m({.timeout = 0});
  EXPECT_EQ(m.next(), Mode::Running);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(m.next(), Mode::Running);
  EXPECT_EQ(m.next(0, true), Mode::Stopped);
  EXPECT_EQ(m.next(0, false, true), Mode::Running);
}

// PROCESS tells Waiting from Holding by nothing; every other change is an EVENT, with who and why.
TEST(Safety, EachChangeIsAnEventWithItsSourceAndReason) {
  EXPECT_STREQ(name(Mode::Waiting), "HOLDING");
  EXPECT_STREQ(name(Mode::Holding), "HOLDING");
  EXPECT_STREQ(name(Mode::Running), "RUNNING");
  EXPECT_STREQ(name(Mode::Stopped), "FAULT");
  std::mt19937 random(11);
  std::set<std::string> seen;
  for (int round = 0; round < 100; ++round) {
    Machine m(round % 2 ? kAuto : kManual);
    for (int i = 0; i < 1000; ++i) {
      const Mode before = m.state.mode;
      m.events.clear();
      const Mode after = m.next((i / 40) % 2 ? 0 : 1, random() % 300 == 0, random() % 100 == 0);
      EXPECT_TRUE(before == after || !m.events.empty()) << name(before) << " became " << name(after);
      for (const Event& event : m.events) {
        seen.insert(event.what);
        EXPECT_TRUE(!event.who.empty() && !event.why.empty()) << event.what;
      }
    }
  }
  EXPECT_EQ(seen, (std::set<std::string>{"estop", "holding", "rearm", "running"}));
}

// Whatever happens: RUNNING only with a command younger than the timeout, and never from STOPPED without rearm.
TEST(Safety, InvariantsUnderRandomInput) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Machine m(round % 2 ? kAuto : kManual);
    for (int i = 0; i < 2000; ++i) {
      const Mode before = m.state.mode;
      const bool estop = random() % 500 == 0, rearm = random() % 200 == 0;
      const bool burst = (i / 40) % 2 == 0;
      const Mode after =
          m.next(burst && random() % 10 ? 1 + static_cast<int64_t>(random() % 3) : 0, estop, rearm);
      if (after == Mode::Running) {
        ASSERT_LT(m.now - m.state.newest, 20);
        ASSERT_FALSE(estop);
      }
      if (before == Mode::Stopped && after != Mode::Stopped) {
        ASSERT_TRUE(rearm);
      }
      if (estop) {
        ASSERT_EQ(after, Mode::Stopped);
      }
    }
  }
}

}  // namespace
}  // namespace lab::safety
