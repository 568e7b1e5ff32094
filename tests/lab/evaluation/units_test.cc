// Which unit a figure has, and whose it is.
#include "lab/evaluation/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/evaluation/metrics.h"
#include "tests/lab/evaluation/by_hand.h"

namespace lab {
namespace {

rbd::Model robot(bool turns, bool slides) {
  rbd::Model model;
  const rbd::Inertia ball = rbd::Inertia::FromSphere(1, 0.1);
  rbd::JointIndex parent = 0;
  const auto add = [&](const auto& joint, const char* name) {
    parent = model.addJoint(parent, joint, rbd::SE3(), name);
    model.appendBodyToJoint(parent, ball);
  };
  if (turns) add(rbd::JointModelRZ(), "turn"), add(rbd::JointModelRY(), "turn2");
  if (slides) add(rbd::JointModelPX(), "slide"), add(rbd::JointModelPY(), "slide2");
  return model;
}

TEST(Units, AreThoseOfTheJoints) {
  const rbd::Model turning = robot(true, false), linear = robot(false, true), both = robot(true, true);
  EXPECT_EQ(unit_of("max_error", turning), "rad");
  EXPECT_EQ(unit_of("max_error", linear), "m");
  EXPECT_EQ(unit_of("max_error", both), "rad or m");
  EXPECT_EQ(unit_of("max_effort.turn2", both), "Nm");
  EXPECT_EQ(unit_of("max_effort.slide", both), "N");
  EXPECT_EQ(unit_of("max_speed.slide2", both), "m/s");
  EXPECT_EQ(unit_of("settling_time", both), "s");
  EXPECT_EQ(unit_of("overshoot_share_max", both), "");
  EXPECT_EQ(unit_of("no_metric", both), "");
  EXPECT_EQ(chosen_unit("s, N, Nm", both), "s, N, Nm");  // a list of three has nothing to choose
}

// Largest and least of the joints of a kind; means and roots of their means, which the joints have in equal numbers.
TEST(Units, FiguresOfEachKindOfJoint) {
  const rbd::Model both = robot(true, true);
  nlohmann::json m{{"max_error", 0.5},         {"rms_error", 9},
                   {"mean_error", 9},          {"min_position_margin", -1},
                   {"settling_time", nullptr}, {"handbook_error", 0.2},
                   {"max_effort_share", 0.8},  {"joints", nlohmann::json::array()}};
  const struct {
    const char* name;
    double max, rms, mean, margin, share;
  } rows[] = {{"turn", 0.1, 3, 1, 2, 0.8},
              {"turn2", 0.3, 4, 2, 1, 0.1},
              {"slide", 0.5, 1, 4, -1, 0.2},
              {"slide2", 0.2, 1, 6, 3, 0}};
  for (const auto& row : rows)
    m["joints"].push_back(
        {{"name", row.name},
         {"max_error", row.max},
         {"rms_error", row.rms},
         {"mean_error", row.mean},
         {"min_position_margin", row.margin},
         {"max_effort_share", row.share},
         {"settling_time", std::string(row.name) == "slide" ? nlohmann::json() : nlohmann::json(1.5)}});
  const auto expect = [&](const char* metric, double turn, const char* turn_joint, double slide,
                          const char* slide_joint, const char* units) {
    const std::vector<Figure> found = figures_of(m, metric, both);
    ASSERT_EQ(found.size(), 2u) << metric;
    EXPECT_NEAR(found[0].value, turn, 1e-15) << metric;
    EXPECT_NEAR(found[1].value, slide, 1e-15) << metric;
    EXPECT_EQ(found[0].joint, turn_joint) << metric;
    EXPECT_EQ(found[1].joint, slide_joint) << metric;
    EXPECT_EQ(found[0].unit + " " + found[1].unit, units) << metric;
  };
  expect("max_error", 0.3, "turn2", 0.5, "slide", "rad m");
  expect("rms_error", std::sqrt(12.5), "", 1, "", "rad m");
  expect("mean_error", 1.5, "", 5, "", "rad m");
  expect("min_position_margin", 1, "turn2", -1, "slide", "rad m");
  const std::vector<Figure> share = figures_of(m, "max_effort_share", both),
                            never = figures_of(m, "settling_time", both);
  ASSERT_EQ(share.size() + never.size(), 2u);  // without a unit, or with one for all joints: one figure
  EXPECT_EQ(share[0].joint, "turn");
  EXPECT_TRUE(std::isnan(never[0].value));
  EXPECT_EQ(never[0].joint, "slide");
  EXPECT_EQ(figure_of(m, "max_error", both).unit, "m");  // 0.5 is that of slide
  EXPECT_EQ(figure_of(m, "max_error.turn", both).unit, "rad");
  EXPECT_EQ(figure_over(m, "max_effort_share", both, true).joint, "slide");
}

}  // namespace
}  // namespace lab
