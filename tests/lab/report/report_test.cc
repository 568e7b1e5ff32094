// Pages of runs: what stands on them, and how much better a run is than another.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

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
  EXPECT_EQ(in_words(Better::More, 1, 2), "100 %, 2 times better");
  EXPECT_EQ(in_words(Better::More, -0.5, 0.5), "200 % better");
  EXPECT_EQ(in_words(Better::Neither, 1, 2), "–");
  EXPECT_EQ(in_words(Better::Less, NAN, 1), "–");
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

// 0.03 rad are 30 mrad, 2.5e-5 rad are 25 µrad.
TEST(Page, KeyFiguresHaveTheNumberOfTheirUnit) {
  for (const auto& [error, text] : {std::pair(0.5, "0.5 <small>rad</small>"),
                                    {0.03, "30 <small>mrad</small>"},
                                    {2.5e-5, "25 <small>µrad</small>"}}) {
    const std::string page = run_page(folder_of("a", test::by_hand({0, -error}, {error / 2, 0})));
    EXPECT_NE(page.find(std::string("<dt>largest error</dt><dd>") + text), std::string::npos) << text;
  }
}

// The value farthest from 0 chooses the unit, also if it is negative.
TEST(Charts, PanelsHaveTheNumbersOfTheirUnit) {
  const auto panel = [](double y) {
    return scaled("c", "m", {.title = "t", .curves = {{.label = "", .x = {0, 1}, .y = {y, 0.004}}}});
  };
  EXPECT_EQ(panel(-0.5).unit, "m");
  EXPECT_EQ(panel(-0.5).chart.curves[0].y, (std::vector<double>{-0.5, 0.004}));
  EXPECT_EQ(panel(-0.02).unit, "mm");
  EXPECT_NEAR(panel(-0.02).chart.curves[0].y[0], -20, 1e-13);
  EXPECT_NEAR(panel(-0.02).chart.curves[0].y[1], 4, 1e-13);
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
