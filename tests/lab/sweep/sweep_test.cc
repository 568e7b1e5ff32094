// A sweep's file, its runs, their results, and what is wrong with any of them.
#include "lab/sweep/sweep.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/util/number.h"
#include "lab/evaluation/evaluate.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/sweep/engine.h"
#include "lab/sweep/page.h"
#include "lab/sweep/table.h"
#include "lab/sweep/workbench.h"
#include "tests/support/paths.h"

namespace lab::sweep {
namespace {

namespace fs = std::filesystem;

class SweepFile : public testing::Test {
 protected:
  SweepFile() {
    char name[] = "/tmp/lab-sweep-test-XXXXXX";
    dir_ = mkdtemp(name);
    fs::copy(lab::source_path("experiments/cubic_pd.yaml"), dir_ + "/cubic_pd.yaml");
  }
  ~SweepFile() override { fs::remove_all(dir_); }

  Sweep read(const std::string& text) {
    std::ofstream(dir_ + "/s.yaml") << "experiment: cubic_pd.yaml\n" << text;
    return read_sweep(dir_ + "/s.yaml");
  }
  /// What is wrong with it, the folder left out.
  std::string fault(const std::string& text) {
    try {
      const Sweep sweep = read(text);
      Workbench(sweep).check();
      return "";
    } catch (const ExperimentError& error) {
      std::string what = error.what();
      for (size_t at; (at = what.find(dir_ + "/")) != std::string::npos;) what.erase(at, dir_.size() + 1);
      return what;
    }
  }
  std::vector<Row> run(const Sweep& sweep, int threads, const std::string& folder) {
    Workbench bench(sweep);
    Results results(dir_ + "/" + folder, sweep.metrics);
    results.load();
    std::vector<Row> rows(static_cast<size_t>(sweep.runs()));
    std::vector<int64_t> all(rows.size());
    std::iota(all.begin(), all.end(), 0);
    work_through(bench, results, rows, all, threads, true, true);
    return rows;
  }
  size_t lines(const std::string& folder) {
    size_t n = 0;
    for (const auto& file : fs::directory_iterator(dir_ + "/" + folder)) {
      std::ifstream in(file.path());
      for (std::string line; std::getline(in, line);) ++n;
    }
    return n;
  }

  std::string dir_;
};

TEST_F(SweepFile, RunsAreGridTimesDraws) {
  const Sweep sweep = read(
      "set: {simulator.duration: 0.1}\n"
      "grid:\n"
      "  controller.kp: [10, {joint1_base_yaw: 5}]\n"
      "  controller.kd: {from: 1, to: 100, count: 3, scale: log}\n"
      "  simulator.damping: {from: 0, to: 1, count: 5}\n"
      "draws: {count: 2, seed: 3, keys: {controller.model.mass_scale: {uniform: [0.5, 1.5]}}}\n");
  EXPECT_EQ(sweep.runs(), 2 * 3 * 5 * 2);
  EXPECT_EQ(sweep.grid[1].values, (std::vector<std::string>{"1", "10", "100"}));
  EXPECT_EQ(sweep.grid[2].values, (std::vector<std::string>{"0", "0.25", "0.5", "0.75", "1"}));
  EXPECT_EQ(sweep.metrics.size(), metrics().size());
  // the draw is the fastest, the first key the slowest; every point has the same draws
  EXPECT_EQ(sweep.point_of(3), (std::vector<size_t>{0, 0, 1}));
  EXPECT_EQ(sweep.point_of(59), (std::vector<size_t>{1, 2, 4}));
  EXPECT_EQ(sweep.values(58)[3], sweep.values(0)[3]);
  EXPECT_NE(sweep.values(58)[3], sweep.values(59)[3]);
  EXPECT_EQ(sweep.values(30)[0], "{joint1_base_yaw: 5}");
  const Experiment e = Workbench(sweep).prepare(30 + 9).experiment;
  EXPECT_EQ(std::get<JointValues::Named>(e.controller.kp.value),
            (JointValues::Named{{"joint1_base_yaw", 5}}));
  EXPECT_EQ(std::get<double>(e.simulator.damping.value), 1);
  EXPECT_EQ(number(e.controller.model.mass_scale), sweep.values(1)[3]);
  EXPECT_EQ(e.simulator.duration, 0.1);
}

TEST_F(SweepFile, FaultsHaveALineAndANearName) {
  const std::string ok = "grid: {controller.kp: [10]}\n";
  EXPECT_EQ(fault(ok), "");
  EXPECT_EQ(fault("gird: {controller.kp: [10]}\n"), "s.yaml:2: unknown key 'gird'; did you mean 'grid'?");
  EXPECT_EQ(fault("grid:\n  controler.kp: [10]\n"),
            "s.yaml:3: unknown section 'controler'; did you mean 'controller'?");
  EXPECT_EQ(fault("grid:\n  controller.kp: [10, -1]\n").substr(0, 57),
            "s.yaml:3: controller.kp: -1 is too small; give at least 0");
  EXPECT_EQ(fault("grid:\n  controller.kp: [10]\n  simulator.dt: [0.01, abc]\n"),
            "s.yaml:4: simulator.dt: must be a number, not 'abc'");
  EXPECT_EQ(fault("grid:\n  controller.kp: [10]\n\n  controller.kp.elbow: [1]\n"),
            "s.yaml:5: controller.kp.elbow: 'kp' is not a map in cubic_pd.yaml");
  EXPECT_EQ(fault("set:\n  planner.kind: cubicle\n" + ok).substr(0, 54),
            "s.yaml:3: planner.kind: 'cubicle' is not known; use on");
  EXPECT_EQ(
      fault("grid: {controller.kp: 10}\n"),
      "s.yaml:2: controller.kp: must be a list of values or {from: a, to: b, count: n, scale: linear|log}");
  EXPECT_EQ(fault("grid: {controller.kp: []}\n"),
            "s.yaml:2: controller.kp: is an empty list; give at least one value");
  EXPECT_EQ(fault("grid: {controller.kp: [1, 2, 1]}\n"), "s.yaml:2: controller.kp: has the value 1 twice");
  EXPECT_EQ(fault("grid: {controller.kp: {from: 1, to: 2}}\n"),
            "s.yaml:2: controller.kp: a range needs from, to and count; count is missing");
  EXPECT_EQ(fault("grid: {controller.kp: {from: 1, to: 2, cuont: 3}}\n").substr(0, 54),
            "s.yaml:2: unknown key 'cuont'; did you mean 'count'?\ns");
  EXPECT_EQ(fault("grid: {controller.kp: {from: 0, to: 2, count: 3, scale: log}}\n"),
            "s.yaml:2: controller.kp: a log scale needs from and to above 0");
  EXPECT_EQ(fault("grid: {controller.kp: {from: nan, to: 2, count: 3}}\n"),
            "s.yaml:2: from: must be a finite number, not 'nan'");
  EXPECT_EQ(fault("metrics: [rms_eror]\n" + ok),
            "s.yaml:2: metrics: rms_eror: there is no metric 'rms_eror'; did you mean 'rms_error'?");
  EXPECT_NE(fault("metrics: [rms_error.elbow]\n" + ok).find("s.yaml:2: metrics: rms_error.elbow: "),
            std::string::npos);
  EXPECT_EQ(fault("metrics: []\n" + ok), "s.yaml:2: metrics: must be a list of names");
  EXPECT_EQ(fault(""), "s.yaml: nothing varies; give keys under grid: or draws:");
  EXPECT_EQ(fault("draws: {count: 3}\n"), "s.yaml:2: draws: needs count: and keys:");
  EXPECT_EQ(fault("draws: {count: 0, keys: {seed: {integer: [1, 9]}}}\n"),
            "s.yaml:2: count: must be a whole number from 1 to 1000000, not '0'");
  EXPECT_EQ(fault("draws: {count: 2, keys: {seed: {intger: [1, 9]}}}\n"),
            "s.yaml:2: unknown key 'intger'; did you mean 'integer'?");
  EXPECT_EQ(fault("draws: {count: 2, keys: {controller.kp: {uniform: [1, 0]}}}\n"),
            "s.yaml:2: controller.kp: uniform: the second number is below the first");
  EXPECT_EQ(fault(ok + "draws: {count: 2, keys: {controller.kp: {uniform: [1, 2]}}}\n"),
            "s.yaml:3: 'controller.kp' is in the grid too; a key can vary in one way only");
  EXPECT_EQ(fault("grid: {controller.kp: {from: 1, to: 2, count: 2000}, controller.kd: {from: 1, to: 2, "
                  "count: 2000}}\n"),
            "s.yaml: 4e+06 runs; at most 1000000 at a time");
  EXPECT_EQ(fault("grid: {simulator.clock: [realtime]}\n"),
            "s.yaml:2: simulator.clock: is realtime; a sweep runs in one process: use lockstep");
  EXPECT_EQ(fault("grid: {robot.model: [gone.urdf]}\n").substr(0, 44),
            "s.yaml:2: robot.model: 'gone.urdf' cannot be");
  EXPECT_EQ(fault("- 1\n").substr(0, 22), "s.yaml:2: not YAML: en");
  std::ofstream(dir_ + "/t.yaml") << "experiment: gone.yaml\ngrid: {controller.kp: [1]}\n";
  EXPECT_THROW(read_sweep(dir_ + "/t.yaml"), ExperimentError);
  EXPECT_THROW(read_sweep(dir_ + "/gone.yaml"), ExperimentError);
}

TEST_F(SweepFile, TheTableIsTheSameForAnyNumberOfThreadsAndAfterAnyStop) {
  const Sweep sweep = read(
      "grid: {controller.kp: [10, 50, 100], planner.kind: [cubic, quintic]}\n"
      "draws: {count: 3, seed: 3, keys: {controller.model.mass_scale: {normal: [1, 0.1]}}}\n"
      "metrics: [rms_error, max_error.joint2_shoulder_pitch, settling_time]\n");
  const std::vector<Row> one = run(sweep, 1, "one"), four = run(sweep, 4, "four");
  const std::string table = csv(sweep, one);
  EXPECT_EQ(csv(sweep, four), table);
  EXPECT_EQ(page(sweep, four), page(sweep, one));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 19);
  EXPECT_EQ(table.substr(0, table.find('\n')),
            "run,draw,controller.kp,planner.kind,controller.model.mass_scale,rms_error,max_error.joint2_"
            "shoulder_pitch,settling_time,complete,passed,last_step,reason");
  EXPECT_EQ(lines("one"), 18u);

  // a stop that cut the file in the middle of a line: only what is missing is run again
  std::string kept;
  std::ifstream in(dir_ + "/one/0000.jsonl");
  std::string line;
  for (int whole = 0; whole < 7 && std::getline(in, line); ++whole) kept += line + "\n";
  fs::create_directories(dir_ + "/cut");
  std::ofstream(dir_ + "/cut/0000.jsonl") << kept << "{\"key\":\"0123\",\"last_st";
  EXPECT_EQ(csv(sweep, run(sweep, 2, "cut")), table);
  EXPECT_EQ(lines("cut"), 18 + 1u);
  EXPECT_TRUE(fs::exists(dir_ + "/cut/0001.jsonl"));

  // an edited sweep: old results are found by what was run, not by number
  const Sweep edited = read(
      "grid: {planner.kind: [quintic], controller.kp: [100, 20]}\n"
      "draws: {count: 3, seed: 3, keys: {controller.model.mass_scale: {normal: [1, 0.1]}}}\n"
      "metrics: [rms_error]\n");
  const std::vector<Row> rows = run(edited, 1, "one");
  EXPECT_EQ(lines("one"), 18u + 3);
  for (size_t draw = 0; draw < 3; ++draw) EXPECT_EQ(rows[draw].metrics[0], one[15 + draw].metrics[0]);
}

TEST_F(SweepFile, RunsThatFailSayWhy) {
  const Sweep sweep = read(
      "grid: {simulator.damping: [0, 1e6], controller.kp: [50]}\n"
      "draws: {count: 4, seed: 1, keys: {controller.kd: {normal: [0, 5]}}}\n"
      "metrics: [rms_error]\n");
  const std::vector<Row> rows = run(sweep, 2, "results");
  const Counts counts = count(rows);
  size_t negative = 0;
  for (int64_t i = 0; i < sweep.runs(); ++i) {
    const Row& row = rows[static_cast<size_t>(i)];
    const double kd = std::stod(sweep.values(i)[2]);
    negative += kd < 0;
    if (kd < 0) {
      EXPECT_EQ(row.state, Row::State::Unable);
      EXPECT_TRUE(
          row.reason.starts_with("s.yaml:3: controller.kd: " + number(kd) + " is too small; give at least 0"))
          << row.reason;
    } else if (sweep.point_of(i)[0] == 1) {
      EXPECT_FALSE(row.complete);
      EXPECT_TRUE(row.metrics.empty());
      EXPECT_NE(row.reason.find("diverged"), std::string::npos) << row.reason;
    } else {
      EXPECT_TRUE(row.complete);
      EXPECT_EQ(row.reason, "");
    }
  }
  ASSERT_TRUE(negative > 0 && negative < 8) << "the draws of this seed show nothing";
  EXPECT_EQ(counts.unable, static_cast<int64_t>(negative));
  EXPECT_GT(counts.ended_early, 0);
  EXPECT_GT(counts.complete, 0);
  const std::string words = page(sweep, rows);
  EXPECT_NE(words.find("diverged"), std::string::npos);
  EXPECT_NE(words.find("class=\"cross\""), std::string::npos);
}

TEST_F(SweepFile, SmallestAndLargestAreThoseOfTheTable) {
  const Sweep sweep = read(
      "grid: {controller.kp: [10, 50, 100, 200], controller.kd: [5, 10]}\nmetrics: [rms_error, "
      "settling_time]\n");
  const std::vector<Row> rows = run(sweep, 2, "results");
  const Extremes found = extremes(rows, 0);
  for (const Row& row : rows) {
    EXPECT_LE(rows[static_cast<size_t>(found.smallest)].metrics[0], row.metrics[0]);
    EXPECT_GE(rows[static_cast<size_t>(found.largest)].metrics[0], row.metrics[0]);
  }
  const std::string words = command(sweep, found.smallest);
  EXPECT_TRUE(words.starts_with("scripts/lab run cubic_pd.yaml --set controller.kp=")) << words;
  const nlohmann::json all = summary(sweep, rows);
  EXPECT_EQ(all["runs"], 8);
  EXPECT_EQ(all["metrics"]["rms_error"]["smallest"]["run"], found.smallest);
}

TEST(Part, EveryRunIsInOnePart) {
  std::vector<int> seen(103, 0);
  for (int64_t part = 0; part < 8; ++part)
    for (int64_t run : part_of(103, part, 8)) ++seen[static_cast<size_t>(run)];
  EXPECT_EQ(seen, std::vector<int>(103, 1));
}

}  // namespace
}  // namespace lab::sweep
