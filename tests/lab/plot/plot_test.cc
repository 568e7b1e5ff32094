// Charts: what is thinned, where values come to lie, and which ticks the axes have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <regex>
#include <set>

#include "lab/plot/axis.h"
#include "lab/plot/chart.h"
#include "lab/plot/draw.h"

namespace lab::plot {
namespace {

TEST(Thin, KeepsPeaksAndEndsAndOrder) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> noise(-1, 1);
  for (size_t n : {1u, 5u, 200u, 201u, 999u, 5000u}) {
    std::vector<double> all;
    for (size_t i = 0; i < n; ++i) all.push_back(noise(random));
    if (n > 500) {  // peaks of one step each
      all[n / 3] = 40;
      all[n / 2] = -50;
    }
    Thinned thinned(n, 100);
    for (size_t i = 0; i < n; ++i) thinned.add(static_cast<double>(i), all[i]);
    const Curve curve = thinned.curve("", Ink::Blue);
    ASSERT_EQ(curve.x.size(), curve.y.size());
    EXPECT_LE(curve.y.size(), 202u);
    EXPECT_EQ(*std::max_element(curve.y.begin(), curve.y.end()), *std::max_element(all.begin(), all.end()));
    EXPECT_EQ(*std::min_element(curve.y.begin(), curve.y.end()), *std::min_element(all.begin(), all.end()));
    EXPECT_TRUE(std::is_sorted(curve.x.begin(), curve.x.end()));
    EXPECT_EQ(curve.x.front(), 0);
    EXPECT_EQ(curve.x.back(), static_cast<double>(n - 1));
    for (size_t i = 0; i < curve.x.size(); ++i)
      ASSERT_EQ(curve.y[i], all[static_cast<size_t>(curve.x[i])]);  // nothing is made up
  }
}

// Of any number of series next to each other no two are alike, and none is as the unnamed ones.
TEST(Series, EachHasAColourOfItsOwn) {
  std::set<Ink> inks{Ink::Grey};
  for (size_t i = 0; i < kSeriesInks; ++i) EXPECT_TRUE(inks.insert(series_ink(i)).second) << i;
}

/// The points of the path with that class.
std::vector<std::pair<double, double>> points_of(const std::string& svg, const std::string& name) {
  std::smatch path;
  std::vector<std::pair<double, double>> points;
  if (!std::regex_search(svg, path, std::regex("class=\"" + name + "\"[^>]* d=\"([^\"]*)\""))) return points;
  const std::string text = path[1];
  const std::regex point("(-?[0-9.]+),(-?[0-9.]+)");
  for (std::sregex_iterator at(text.begin(), text.end(), point), end; at != end; ++at)
    points.emplace_back(std::stod((*at)[1]), std::stod((*at)[2]));
  return points;
}

/// The number at each of the horizontal grid lines: its label, and its y in pixels.
std::vector<std::pair<double, double>> y_ticks_of(const std::string& svg) {
  std::vector<std::pair<double, double>> ticks;
  const std::regex tick("class=\"grid\" d=\"M[0-9.]+,([0-9.]+) [^>]*>\\s*<text[^>]*>([^<]*)<");
  for (std::sregex_iterator at(svg.begin(), svg.end(), tick), end; at != end; ++at)
    ticks.emplace_back(std::stod(std::regex_replace((*at)[2].str(), std::regex("−"), "-")),
                       std::stod((*at)[1]));
  return ticks;
}

// Numbers of 11 px in cells that hold them, up to 24 columns and rows.
TEST(HeatMap, EveryCellHasItsNumber) {
  for (size_t columns : {2u, 9u, 16u, 24u})
    for (size_t rows : {1u, 24u}) {
      HeatMap map;
      map.value_name = "max_error (rad)";
      for (size_t c = 0; c < columns; ++c) map.columns.push_back(std::to_string(c));
      for (size_t r = 0; r < rows; ++r) map.rows.push_back(std::to_string(r));
      for (size_t i = 0; i < rows * columns; ++i)
        map.cells.push_back({-0.00123 * static_cast<double>(i + 1), false, ""});
      const std::string svg = draw(map);
      const std::regex number("pointer-events=\"none\">");
      EXPECT_EQ(std::distance(std::sregex_iterator(svg.begin(), svg.end(), number), std::sregex_iterator()),
                static_cast<std::ptrdiff_t>(rows * columns));
      EXPECT_GE((map_width(columns) - 98) / static_cast<double>(columns), 48);
      EXPECT_TRUE(svg.starts_with("<svg viewBox=\"0 0 " + std::to_string(map_width(columns)) + " "));
      EXPECT_NE(svg.find("max_error (rad)"), std::string::npos);
    }
}

TEST(Draw, MarksOfSeveralSeriesHaveTheirInksAndAKey) {
  Chart chart{.title = "t"};
  chart.marks = {{1, 1, 1, 1, "", Ink::Blue}, {2, 2, 2, 2, "", Ink::Red}};
  chart.key = {{Ink::Blue, "kp 25"}, {Ink::Red, "kp 100"}};
  const std::string svg = draw(chart);
  for (const char* const ink : {"f-blue", "f-red"}) {
    const std::regex dot("class=\"dot " + std::string(ink) + "\"");
    EXPECT_EQ(std::distance(std::sregex_iterator(svg.begin(), svg.end(), dot), std::sregex_iterator()), 2)
        << ink;
  }
  EXPECT_NE(svg.find("kp 100"), std::string::npos);
}

TEST(Draw, CurvesAndTicksAreOnOneScale) {
  Chart chart{.title = "a <test>"};
  chart.curves = {{.label = "one & only", .x = {0, 1, 2, 4}, .y = {0, 3, -1, 1}, .ink = Ink::Red}};
  const std::string svg = draw(chart);
  EXPECT_TRUE(svg.starts_with("<svg viewBox=\"0 0 350 170\" role=\"img\" aria-label=\"a &lt;test&gt;\">"))
      << svg;
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  // pixels are an affine map of the data, upside down, to a tenth of a pixel
  const auto p = points_of(svg, "s-red");
  ASSERT_EQ(p.size(), 4u);
  const double right = (p[3].first - p[0].first) / 4, up = (p[1].second - p[0].second) / 3;
  EXPECT_GT(right, 0);
  EXPECT_LT(up, 0);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(p[i].first, p[0].first + right * chart.curves[0].x[i], 0.15);
    EXPECT_NEAR(p[i].second, p[0].second + up * chart.curves[0].y[i], 0.15);
  }
  // and the labels say where the values are: y = 3 is at p[1]
  const auto ticks = y_ticks_of(svg);
  ASSERT_GE(ticks.size(), 3u);
  for (const auto& [value, y] : ticks) EXPECT_NEAR(y, p[0].second + up * value, 0.2) << value;
  EXPECT_NE(svg.find("<title>one &amp; only</title>"), std::string::npos);
  for (const char* word : {"http", "id=", "nan", "inf"}) EXPECT_EQ(svg.find(word), std::string::npos) << word;
  EXPECT_EQ(draw(chart), svg);
}

TEST(Draw, ALengthIsTheSameOnBothAxes) {
  Chart square{.title = "square", .width = 530, .height = 330};
  square.equal = true;
  square.curves = {{.label = "", .x = {0, 1, 1, 0}, .y = {0, 0, 1, 1}}};
  const auto p = points_of(draw(square), "s-blue");
  ASSERT_EQ(p.size(), 4u);
  EXPECT_NEAR(p[1].first - p[0].first, p[1].second - p[2].second, 0.25);
}

TEST(Draw, ALogarithmicAxisEndsSixDecadesBelowItsTop) {
  Chart chart{.title = "log"};
  chart.logarithmic_y = true;
  chart.curves = {{.label = "", .x = {0, 1, 2, 3, 4}, .y = {0, 1e-12, 1, 0.01, 1e-9}}};
  const std::string svg = draw(chart);
  const auto p = points_of(svg, "s-blue");
  // comes in over the bottom edge, 1, 0.01, leaves over the bottom edge; 0 is nowhere
  ASSERT_EQ(p.size(), 4u) << svg;
  EXPECT_NEAR(p[0].second, 134, 0.1);
  EXPECT_NEAR(p[3].second, 134, 0.1);
  const auto ticks = Axis({1e-6, 1}, true, 100, 0).ticks(6);
  ASSERT_GE(ticks.size(), 4u);
  EXPECT_NEAR(Axis({1e-6, 1}, true, 100, 0).at(1e-3), 50, 1e-9);
  EXPECT_EQ(ticks.front().label, "10⁻⁶");
}

TEST(Draw, BarsStandOnTheirAxis) {
  Chart chart{.title = "bars"};
  chart.bars = chart.logarithmic_x = true;
  chart.curves = {{.label = "", .x = {1, 10, 100, 1000}, .y = {10, 0, 90}}};
  const std::string svg = draw(chart);
  std::smatch path;
  ASSERT_TRUE(std::regex_search(svg, path, std::regex("class=\"f-blue\" d=\"([^\"]*)\"")));
  const std::string d = path[1];
  double x[2], top[2], right[2], foot[2];
  ASSERT_EQ(sscanf(d.c_str(), "M%lf,134.0V%lfH%lfV%lfZM%lf,134.0V%lfH%lfV%lfZ", &x[0], &top[0], &right[0],
                   &foot[0], &x[1], &top[1], &right[1], &foot[1]),
            8)
      << d;                                            // none for 0
  EXPECT_NEAR(right[0] - x[0], right[1] - x[1], 0.2);  // a decade each
  EXPECT_NEAR((134 - top[1]) / (134 - top[0]), 9, 0.15);
}

TEST(Draw, TakesUnusualData) {
  const std::vector<double> t = {0, 1, 2};
  Chart plain{.title = "plain"}, constant = plain, zero = plain, almost = plain, one = plain, huge = plain,
                                 log = plain, path = plain, gap = plain;
  constant.curves = {{.label = "", .x = t, .y = {5, 5, 5}}};
  constant.levels = {5.1, 1e9};
  constant.bands = {{4.9, 5.2}, {7e8, 8e8}};
  zero.curves = {{.label = "", .x = t, .y = {0, 0, 0}}};
  almost.curves = {{.label = "", .x = t, .y = {-0.2, -0.20000008, -0.2}}};
  one.curves = {{.label = "", .x = {3}, .y = {1}}};
  huge.curves = {{.label = "", .x = t, .y = {-1e300, 0, 1e300}}};
  log.logarithmic_y = true;
  log.curves = {{.label = "", .x = t, .y = {0, 0, 0}}};
  path.equal = true;
  path.curves = {{.label = "", .x = {1, 1, 1}, .y = {2, 2, 2}}};
  gap.curves = {{.label = "", .x = {0, 1, 2, 3, 4}, .y = {0, 1, NAN, 1, 0}}};
  for (const Chart& chart : {plain, constant, zero, almost, one, huge, log, path, gap}) {
    const std::string svg = draw(chart);
    for (const char* word : {"nan", "inf", ",-", "M-"}) EXPECT_EQ(svg.find(word), std::string::npos) << svg;
    EXPECT_GE(std::count(svg.begin(), svg.end(), '\n'), 8) << svg;  // ticks and axes
  }
  const std::string svg = draw(constant);
  EXPECT_NE(svg.find("class=\"level\""), std::string::npos);
  EXPECT_EQ(svg.find("class=\"band\""), svg.rfind("class=\"band\""));  // the other one is out of range
  const std::string broken = draw(gap);
  const size_t curve = broken.find("s-blue");
  EXPECT_EQ(std::count(broken.begin() + static_cast<std::ptrdiff_t>(curve), broken.end(), 'M'), 2);
}

TEST(Draw, MarksWithoutAValueAreCrosses) {
  Chart chart{.title = "marks", .width = 530, .height = 290};
  chart.marks = {{1, 5, 4, 6, "first"}, {2, NAN, INFINITY, -INFINITY, "second"}, {3, 7, 7, 7, "third"}};
  const std::string svg = draw(chart);
  EXPECT_NE(svg.find("class=\"cross\""), std::string::npos);
  EXPECT_NE(svg.find("<title>second</title></path>"), std::string::npos);
  EXPECT_NE(svg.find("<title>third</title></circle>"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Draw, NamesThatDoNotFitAreThinned) {
  Chart chart{.title = "names"};
  chart.categories = true;
  for (int i = 0; i < 60; ++i) {
    chart.marks.push_back({i + 0.5, 1, 1, 1, ""});
    chart.x_ticks.push_back({i + 0.5, "name" + std::to_string(i)});
  }
  const std::string svg = draw(chart);
  EXPECT_NE(svg.find(">name0<"), std::string::npos);
  EXPECT_EQ(svg.find(">name1<"), std::string::npos);
}

TEST(Axis, TicksAreRoundAndLineUp) {
  std::vector<std::string> labels;
  for (const Tick& tick : Axis({-0.11, 0.32}, false, 0, 100).ticks(5)) labels.push_back(tick.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"−0.1", "0", "0.1", "0.2", "0.3"}));
  labels.clear();
  for (const Tick& tick : Axis({0, 0.14}, false, 0, 100).ticks(3)) labels.push_back(tick.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"0", "0.05", "0.10"}));
  labels.clear();
  for (const Tick& tick : Axis({3, 700}, true, 0, 100).ticks(8)) labels.push_back(tick.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"3", "10", "30", "100", "300"}));
  for (const auto& [low, high] : {std::pair(1e-7, 3e-7), {0.0, 1e9}, {-1e300, 1e300}, {99.9, 100.1}}) {
    const auto ticks = Axis({low, high}, false, 0, 100).ticks(5);
    ASSERT_GE(ticks.size(), 2u) << low;
    EXPECT_LE(ticks.size(), 6u) << low;
    EXPECT_NE(ticks[0].label, ticks[1].label) << low;
  }
}

TEST(HeatMap, ColoursFollowTheValues) {
  const HeatMap map{
      .title = "map",
      .x_name = "x",
      .y_name = "y",
      .value_name = "v",
      .columns = {"1", "2"},
      .rows = {"a", "b"},
      .cells = {{1, false, "low"}, {NAN, false, "none"}, {2, true, "part"}, {3, false, "high"}}};
  const std::string svg = draw(map);
  EXPECT_NE(svg.find("fill=\"#440154\"><title>low</title>"), std::string::npos)
      << svg;  // the ends of viridis
  EXPECT_NE(svg.find("fill=\"#fde725\"><title>high</title>"), std::string::npos);
  EXPECT_NE(svg.find("class=\"empty\"><title>none</title>"), std::string::npos);
  EXPECT_NE(svg.find("<title>part</title></path>"), std::string::npos);
  // the first row is below the second
  const auto y = [&](const std::string& tooltip) {
    const std::string head = svg.substr(0, svg.find("<title>" + tooltip));
    return std::stod(head.substr(head.rfind(" y=\"") + 4));
  };
  EXPECT_GT(y("low"), y("high"));
}

}  // namespace
}  // namespace lab::plot
