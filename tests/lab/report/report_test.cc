// Pieces of pages: thinning, pictures by gnuplot, text, and how much better a run is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <regex>

#include "lab/report/compare.h"
#include "lab/report/figures.h"
#include "lab/report/gnuplot.h"
#include "lab/report/html.h"
#include "tests/lab/evaluation/by_hand.h"

namespace lab::report {
namespace {

TEST(Thin, KeepsPeaksAndEndsAndOrder) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> noise(-1, 1);
  for (size_t n : {1u, 5u, 200u, 201u, 999u, 5000u}) {
    Curve curve;
    for (size_t i = 0; i < n; ++i)
      curve.x.push_back(static_cast<double>(i)), curve.y.push_back(noise(random));
    if (n > 500) curve.y[n / 3] = 40, curve.y[n / 2] = -50;  // one step each
    const Curve before = curve;
    thin(curve, 100);
    ASSERT_EQ(curve.x.size(), curve.y.size());
    EXPECT_LE(curve.y.size(), 202u);
    EXPECT_EQ(*std::max_element(curve.y.begin(), curve.y.end()),
              *std::max_element(before.y.begin(), before.y.end()));
    EXPECT_EQ(*std::min_element(curve.y.begin(), curve.y.end()),
              *std::min_element(before.y.begin(), before.y.end()));
    EXPECT_TRUE(std::is_sorted(curve.x.begin(), curve.x.end()));
    EXPECT_EQ(curve.x.front(), 0);
    EXPECT_EQ(curve.x.back(), static_cast<double>(n - 1));
    for (size_t i = 0; i < curve.x.size(); ++i)
      ASSERT_EQ(curve.y[i], before.y[static_cast<size_t>(curve.x[i])]);  // nothing is made up
  }
}

/// The points of the path with that class.
std::vector<std::pair<double, double>> points_of(const std::string& svg, const std::string& name) {
  std::smatch path;
  std::vector<std::pair<double, double>> points;
  if (!std::regex_search(svg, path, std::regex("class=\"" + name + "\"[^>]*d='([^']*)'"))) return points;
  const std::string text = path[1];
  const std::regex point("(-?[0-9.]+),(-?[0-9.]+)");
  for (std::sregex_iterator at(text.begin(), text.end(), point), end; at != end; ++at)
    points.emplace_back(std::stod((*at)[1]), std::stod((*at)[2]));
  return points;
}

TEST(Gnuplot, DrawsWhatItIsGiven) {
  Chart chart{.title = "a <test>"};
  chart.curves = {{.label = "one", .x = {0, 1, 2, 4}, .y = {0, 3, -1, 1}, .ink = Ink::Red}};
  Chart other = chart;
  other.curves[0].ink = Ink::Green;
  const auto drawn = draw({chart, other});
  if (!drawn) GTEST_SKIP() << "gnuplot is not installed";
  ASSERT_EQ(drawn->size(), 2u);
  const std::string& svg = (*drawn)[0];
  EXPECT_TRUE(svg.starts_with("<svg viewBox=\"0 0 350 170\" role=\"img\" aria-label=\"a &lt;test&gt;\">"))
      << svg.substr(0, 200);
  EXPECT_TRUE(svg.ends_with("</svg>"));
  EXPECT_TRUE(points_of(svg, "s-green").empty());
  EXPECT_EQ(points_of((*drawn)[1], "s-green").size(), 4u);
  // pixels are an affine map of the data, upside down; gnuplot writes hundredths of a pixel
  const auto p = points_of(svg, "s-red");
  ASSERT_EQ(p.size(), 4u);
  const double right = (p[3].first - p[0].first) / 4, up = (p[1].second - p[0].second) / 3;
  EXPECT_GT(right, 0);
  EXPECT_LT(up, 0);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(p[i].first, p[0].first + right * chart.curves[0].x[i], 0.02);
    EXPECT_NEAR(p[i].second, p[0].second + up * chart.curves[0].y[i], 0.02);
  }
  // nothing of where, when and by what it was made, and nothing from elsewhere
  for (const char* word : {"http", "GNUPLOT", "gnuplot", "<?xml", "DOCTYPE", "rgb(", "id="})
    EXPECT_EQ(svg.find(word), std::string::npos) << word << "\n" << svg.substr(0, 400);
  EXPECT_NE(svg.find("<title>one</title>"), std::string::npos);
  EXPECT_EQ(*draw({chart, other}), *drawn);
}

TEST(Gnuplot, TakesWhatIsOdd) {
  const std::vector<double> t = {0, 1, 2};
  Chart constant{.title = "constant"}, zero = constant, almost = constant, empty = constant, one = constant,
                                       huge = constant, bars = constant, log = constant, path = constant;
  constant.curves = {{.label = "", .x = t, .y = {5, 5, 5}}};
  constant.levels = {5.1, 1e9}, constant.bands = {{4.9, 5.2}};
  zero.curves = {{.label = "", .x = t, .y = {0, 0, 0}}};
  almost.curves = {{.label = "", .x = t, .y = {-0.2, -0.20000008, -0.2}}};
  one.curves = {{.label = "", .x = {3}, .y = {1}}};
  huge.curves = {{.label = "", .x = t, .y = {-1e300, 0, 1e300}}};
  bars.bars = true, bars.curves = {{.label = "", .x = {0.5, 1, 2, 3}, .y = {10, 0, 90}}};
  log.logarithmic = true, log.curves = {{.label = "", .x = t, .y = {0, 1e-9, 1}}};
  path.equal = true, path.curves = {{.label = "", .x = {1, 1, 1}, .y = {2, 2, 2}}};
  const auto drawn = draw({constant, zero, almost, empty, one, huge, bars, log, path});
  if (!drawn) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_EQ(drawn->size(), 9u);
  EXPECT_NE((*drawn)[0].find("class=\"band\""), std::string::npos);
  EXPECT_NE((*drawn)[6].find("class=\"f-blue\""), std::string::npos);
}

TEST(Gnuplot, ALengthIsTheSameOnBothAxes) {
  Chart square{.title = "square", .width = 530, .height = 330};
  square.equal = true;
  square.curves = {{.label = "", .x = {0, 1, 1, 0}, .y = {0, 0, 1, 1}}};
  const auto drawn = draw({square});
  if (!drawn) GTEST_SKIP() << "gnuplot is not installed";
  const auto p = points_of((*drawn)[0], "s-blue");
  ASSERT_EQ(p.size(), 4u);
  const double width = p[1].first - p[0].first, height = p[1].second - p[2].second;
  EXPECT_NEAR(width / height, 1, 0.03);  // margins are in letters, whose size gnuplot rounds
}

TEST(Html, TextAndBytes) {
  EXPECT_EQ(escape("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
  const std::pair<const char*, const char*> rfc4648[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : rfc4648) EXPECT_EQ(base64(plain), coded);
  EXPECT_EQ(base64(std::string("\xff\xfe\x00", 3)), "//4A");
  EXPECT_EQ(figure(-0.0), "0");
  EXPECT_EQ(figure(NAN), "–");
  EXPECT_EQ(figure(-0.123456), "−0.1235");
}

TEST(Scale, SuitsTheNumber) {
  EXPECT_EQ(scale_for(0.5, "rad").unit, "rad");
  EXPECT_EQ(scale_for(0.02, "rad").unit, "mrad");
  EXPECT_EQ(scale_for(2e-5, "m").unit, "µm");
  EXPECT_EQ(scale_for(0, "m").unit, "m");
  EXPECT_EQ(scale_for(4e-12, "J").unit, "J");
}

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
  const Page page = run_page(empty);
  EXPECT_NE(page.html.find("<h1>a&amp;b</h1>"), std::string::npos);
  EXPECT_NE(page.html.find("There is nothing to show of the motion: log.lcm is empty."), std::string::npos);
  EXPECT_NE(page.html.find("No manifest.json"), std::string::npos);
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
