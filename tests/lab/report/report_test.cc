// Pages of runs: what stands on them, and how much better a run is than another.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "lab/report/charts.h"
#include "lab/report/compare.h"
#include "tests/lab/evaluation/by_hand.h"

namespace lab::report {
namespace {

TEST(Compare, HowMuchBetter) {
  EXPECT_EQ(in_words(Better::Less, 0.2, 0.01), "95 %, 20 times better");
  EXPECT_EQ(in_words(Better::Less, 0.2, 0.2 / 34567), "> 99.99 %, 34600 times better");
  EXPECT_EQ(in_words(Better::Less, 0.2, 1e-9), "> 99.99 %, over a million times better");
  EXPECT_EQ(in_words(Better::Less, 0.2, 0.19), "5 % better");
  EXPECT_EQ(in_words(Better::Less, 0.2, 0.6), "3 times worse");
  EXPECT_EQ(in_words(Better::Less, 0.2, 0.22), "10 % worse");
  EXPECT_EQ(in_words(Better::Less, 0.2, 0.2), "same");
  EXPECT_EQ(in_words(Better::Less, 0, 0.2), "–");  // a share of nothing
  EXPECT_EQ(in_words(Better::Less, 3, 0), "100 % better");
  EXPECT_EQ(in_words(Better::Neither, 1, 2), "2 times more");
  EXPECT_EQ(in_words(Better::Neither, 100, 88), "12 % less");
  EXPECT_EQ(in_words(Better::Neither, -68, -44), "–");
  EXPECT_EQ(in_words(Better::Neither, 2, 2), "same");
  EXPECT_EQ(in_words(Better::Less, NAN, 1), "–");
}

// Less effort, less speed and more margin are other runs, not better ones.
TEST(Compare, BetterIsSaidOnlyOfErrorsAndTimes) {
  for (const Metric& metric : metrics()) {
    const std::string name = metric.name;
    const bool less_is_better = name.find("error") != std::string::npos ||
                                name.find("settling") != std::string::npos ||
                                name.find("overshoot") != std::string::npos ||
                                name.find("turn") != std::string::npos || name.starts_with("energy_drift");
    for (const auto& [first, other] : {std::pair(1.0, 3.0), {3.0, 1.0}}) {
      const std::string words = in_words(metric.better, first, other);
      EXPECT_EQ(words.ends_with("better") || words.ends_with("worse"), less_is_better)
          << name << ": " << words;
    }
  }
}

Folder folder_of(const std::string& name, lab::Run run) {
  Folder folder;
  folder.name = name;
  folder.logged.emplace();
  folder.logged->run = std::move(run);
  folder.logged->robot.model.name = name + "'s robot";
  folder.metrics = evaluate(folder.logged->run, {});
  folder.experiment.emplace();
  return folder;
}

TEST(Compare, OtherRobotsInWhatIsCommon) {
  lab::Run first = test::by_hand({0.2, 0.4}, {0, 0}), second = test::by_hand({0.1, 0.1}, {3, 3});
  Comparison same = compare({folder_of("a", first), folder_of("a", second)});
  EXPECT_EQ(same.names, (std::vector<std::string>{"a", "a (2)"}));
  EXPECT_TRUE(same.same_joints);
  EXPECT_EQ(same.rows[0].name, "max_error");
  EXPECT_EQ(same.rows[0].values, (std::vector<double>{0.4, 3}));

  Folder other = folder_of("b", test::by_hand({0.1, 0.1}, {3, 3}, "three"));
  other.experiment->controller.kind = "pd_gravity";
  const Comparison all = compare({folder_of("a", first), other});
  EXPECT_FALSE(all.same_joints);
  EXPECT_EQ(all.joints, std::vector<std::string>{"one"});
  ASSERT_EQ(all.notes.size(), 1u);
  EXPECT_NE(all.notes[0].find("a: a's robot, b: b's robot"), std::string::npos) << all.notes[0];
  ASSERT_EQ(all.keys.size(), 1u);
  EXPECT_EQ(all.keys[0].name, "controller.kind");
  for (const Comparison::Row& row : all.rows) {
    EXPECT_TRUE(row.name.ends_with(".one") || row.name.find("tool") != std::string::npos) << row.name;
    if (row.name == "max_error.one") {
      EXPECT_EQ(row.values, (std::vector<double>{0.4, 0.1}));
    }
  }
  const nlohmann::json json = compare_json(all);
  for (const auto& row : json["metrics"])
    if (row["metric"] == "max_error.one") {
      EXPECT_NEAR(row["improvement_percent"][1], 75, 1e-9);
    }
}

TEST(Compare, NeedsSomethingToCompare) {
  Folder empty;
  empty.name = "nothing", empty.no_log = "log.lcm is empty";
  try {
    compare({folder_of("a", test::by_hand({0}, {0})), empty});
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "nothing: has nothing to compare (log.lcm is empty)");
  }
}

TEST(Page, StandsWithoutALog) {
  Folder empty;
  empty.name = "a&b", empty.no_log = "log.lcm is empty";
  const std::string page = run_page(empty);
  EXPECT_NE(page.find("<h1>a&amp;b</h1>"), std::string::npos);
  EXPECT_NE(page.find("There is no motion to show: log.lcm is empty."), std::string::npos);
  EXPECT_NE(page.find("No manifest.json"), std::string::npos);
}

/// Joint "turn" and joint "slide", which never move and have these errors.
lab::Run mixed(const std::vector<double>& turn, const std::vector<double>& slide) {
  lab::Run run = test::by_hand(turn, slide);
  const rbd::Inertia ball = rbd::Inertia::FromSphere(1, 0.1);
  const rbd::SE3 out(Eigen::Matrix3d::Identity(), Eigen::Vector3d(1, 0, 0));
  run.model = rbd::Model();
  run.model.addJoint(0, rbd::JointModelRZ(), rbd::SE3(), "turn");
  run.model.appendBodyToJoint(1, ball);
  run.model.addJoint(1, rbd::JointModelPX(), out, "slide");
  run.model.appendBodyToJoint(2, ball);
  run.model.addFrame(rbd::Frame("tip", 2, out, rbd::BODY));
  return run;
}

/// Without tags, and one space where there are several.
std::string text_of(const std::string& html) {
  return std::regex_replace(std::regex_replace(html, std::regex("<wbr/>|<[^>]*>"), " "), std::regex("\\s+"),
                            " ");
}

// A number is in the unit of metrics.json wherever it stands: in the tile, in the tables and on the axis.
TEST(Page, OneScaleForTilesTablesAndPlots) {
  for (const auto& [error, shown] : {std::pair(0.5, "0.5"), {0.03, "0.03"}, {2.5e-5, "2.5e-05"}}) {
    Folder folder = folder_of("a", test::by_hand({0, -error}, {error / 2, 0}));
    folder.metrics["verdicts"] = verdicts(folder.metrics, {{"max_error", {.min = {}, .max = 1}}});
    const std::string page = run_page(folder), text = text_of(page);
    EXPECT_NE(page.find("<dt>largest error</dt><dd>" + std::string(shown) +
                        " <small>rad</small></dd><dd class=\"joint\">one<"),
              std::string::npos);
    for (const std::string& row : {"✓ met max_error " + std::string(shown) + " rad 1 one",
                                   "max_error " + std::string(shown) + " rad one"})
      EXPECT_NE(text.find(row), std::string::npos) << row;
    for (const char* const prefix : {"mrad", "µrad", "mm<", "µm<", "mJ", "µJ"})
      EXPECT_EQ(page.find(prefix), std::string::npos) << prefix;
    const ChartGroup charts = error_charts(folder.log().run);
    EXPECT_EQ(charts.panels[0].unit, "rad");
    EXPECT_EQ(charts.panels[0].chart.curves[0].y[1], -error);
  }
}

TEST(Page, NoFigureHasTwoUnits) {
  Folder folder = folder_of("a", mixed({0.2, 0.4}, {0, -0.03}));
  folder.metrics["verdicts"] = verdicts(folder.metrics, {{"max_error.slide", {.min = {}, .max = 1}}});
  const std::string page = run_page(folder), text = text_of(page);
  for (const char* const both : {"rad, m", "Nm, N", "rad or m<", "rad/s, m/s"})
    EXPECT_EQ(page.find(both), std::string::npos) << both;
  for (const char* const words :
       {"largest error, in rad 0.4 rad turn", "largest error, in m 0.03 m slide", "max_error.slide 0.03 m",
        "joint max error (rad)", "joint max error (m)", "max effort (Nm)", "max effort (N)",
        "max speed (m/s)", "within 0.01 rad or 0.01 m of", "max_error 0.4 rad turn",
        "max_error 0.03 m slide"})
    EXPECT_NE(text.find(words), std::string::npos) << words;
  const Comparison all = compare({folder, folder_of("b", mixed({0.1, 0.1}, {0, 0.06}))});
  EXPECT_EQ(all.rows[0].unit, "rad");
  EXPECT_EQ(all.rows[0].values, (std::vector<double>{0.4, 0.1}));
  EXPECT_EQ(all.rows[1].unit, "m");
  EXPECT_EQ(all.rows[1].values, (std::vector<double>{0.03, 0.06}));
  for (const Comparison::Row& row : all.rows) EXPECT_EQ(row.unit.find(','), std::string::npos) << row.name;
}

// Joint two goes farther beyond its target; joint one settles last. Each is named where it is meant.
TEST(Page, TheJointThatOvershootsIsNamed) {
  std::vector<double> wanted(13, 1);
  wanted[0] = wanted[1] = 0, wanted[2] = 0.5;
  lab::Run run = test::by_hand(wanted, wanted);
  test::edit(run, [&](size_t k, RunStep& step) {
    if (k == 2) step.reference.v[0] = 5;
    step.state.q[0] = k < 3 ? wanted[k] : k < 9 ? 1.02 : 1;
    step.state.q[1] = k < 3 ? wanted[k] : k < 5 ? 1.3 : 1;
  });
  const std::string text = text_of(run_page(folder_of("a", std::move(run))));
  for (const char* const words : {"largest overshoot 0.3 rad two", "overshoot / way 0.3 two",
                                  "settling, slowest reach 0.6 s one", "0.6 one 0.3 rad two 0.3 two"})
    EXPECT_NE(text.find(words), std::string::npos) << words;
}

TEST(Page, PicturesOfAnotherRunAreNotShown) {
  Folder folder = folder_of("a", test::by_hand({0, 0.1}, {0, 0}));
  folder.other_pictures = true;
  EXPECT_NE(run_page(folder).find("show another run"), std::string::npos);
}

TEST(Charts, EveryJointWithANameHasAColourOfItsOwn) {
  lab::Run run = test::by_hand({0, 0}, {0, 0});
  run.model = rbd::Model();
  constexpr int kJoints = 12;
  for (int j = 0; j < kJoints; ++j) {
    run.model.addJoint(static_cast<rbd::JointIndex>(j), rbd::JointModelRZ(), rbd::SE3(),
                       "joint" + std::to_string(j));
    run.model.appendBodyToJoint(static_cast<rbd::JointIndex>(j + 1), rbd::Inertia::FromSphere(1, 0.1));
  }
  run.steps = {};
  for (int64_t k = 0; k < 2; ++k) {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(kJoints);
    run.steps.push_back(
        {.state = {.step = k, .q = zero, .v = zero, .tau = zero},
         .reference = {.step = k, .q = Eigen::VectorXd::LinSpaced(kJoints, 0, 1), .v = zero, .a = zero}});
  }
  const ChartGroup group = error_charts(run);
  std::set<plot::Ink> inks;
  for (const plot::Curve& one : group.legend) EXPECT_TRUE(inks.insert(one.ink).second) << one.label;
  EXPECT_EQ(inks.size(), plot::kSeriesInks + 1);
}

TEST(LoopTimes, QuantilesOfAHistogram) {
  Loops loops{.process = "x", .counts = std::vector<int64_t>(84)};
  loops.counts[3] = 90, loops.counts[8] = 10;  // 3 us, and 8 to 9 us
  EXPECT_EQ(loop_quantile(loops, 0.5), 3);
  EXPECT_EQ(loop_quantile(loops, 0.89), 3);
  EXPECT_EQ(loop_quantile(loops, 0.95), 9);
}

}  // namespace
}  // namespace lab::report
