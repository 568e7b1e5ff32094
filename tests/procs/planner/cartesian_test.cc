// Goals for a frame: what the door lets in the planner reaches, by forward kinematics; both refuse the same rest.
#include "lab/experiment/cartesian.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include "lab/experiment/actions.h"
#include "procs/planner/planner.h"

namespace lab::planner {
namespace {

const char* const kFrame = "effector_body";

Experiment resting() {
  Experiment e;
  e.simulator.duration = 100;
  e.simulator.q0.value = std::vector<double>{0.3, 0.4, -0.5, 0.2, 0.6, 0.1};
  return e;
}
rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

/// The frame's pose there, as the values of a goal.
std::vector<double> place(const rbd::Model& model, const Eigen::VectorXd& q, bool pose) {
  rbd::Data data(model);
  rbd::forwardKinematics(model, data, q);
  const rbd::SE3& at = data.oMf[model.frameId(kFrame)];
  std::vector<double> out(at.translation().begin(), at.translation().end());
  const Eigen::Quaterniond turn(at.rotation());
  if (pose) out.insert(out.end(), turn.coeffs().begin(), turn.coeffs().end());
  return out;
}

Action goal(const std::vector<double>& values, const std::string& frame = kFrame) {
  return {"goal", frame, "", "", values};
}

/// The reference `steps` steps after the goal.
Reference follow(const Config& config, const Action& action, int steps, std::vector<Event>& events) {
  State state = initial(config);
  const std::vector<Action> actions{action};
  Output out = step(config, state, {.step = 1, .actions = actions});
  events = out.events;
  for (int k = 2; k <= steps; ++k) out = step(config, state, {.step = k});
  return out.reference;
}

TEST(Cartesian, WhatTheDoorLetsInIsReached) {
  const rbd::Model model = arm();
  const Config config = make_config(resting(), model);
  for (unsigned seed = 0; seed < 40; ++seed) {
    for (const bool pose : {false, true}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + (pose ? ", pose" : ", position"));
      const Action action = goal(place(model, rbd::randomConfiguration(model, seed), pose));
      ASSERT_EQ(why_not(resting(), model, action), "");
      std::vector<Event> events;
      const Reference end = follow(config, action, 20000, events);  // the longest way, at half speed, is 4 s
      ASSERT_TRUE(events.empty()) << events[0].why;
      EXPECT_EQ(end.v.norm(), 0);
      const std::vector<double> at = place(model, end.q, true);
      const auto part = [](const std::vector<double>& x, long from, long n) {
        return Eigen::Map<const Eigen::VectorXd>(x.data() + from, n);
      };
      EXPECT_LE((part(at, 0, 3) - part(action.values, 0, 3)).norm(), 1.1e-6);
      // quaternions of rotations that are 1e-6 rad apart, up to their sign
      if (!pose) continue;
      EXPECT_GE(std::abs(part(at, 3, 4).dot(part(action.values, 3, 4))), 1 - 1e-12);
    }
  }
}

TEST(Cartesian, TheSameGoalGivesTheSameBytesAndANearWay) {
  const rbd::Model model = arm();
  const Config config = make_config(resting(), model);
  const Eigen::VectorXd beside = config.q0 + Eigen::VectorXd::Constant(6, 0.1);
  const Action action = goal(place(model, beside, true));
  std::vector<Event> events;
  const Reference a = follow(config, action, 5000, events), b = follow(config, action, 5000, events);
  EXPECT_EQ(a.q, b.q);
  EXPECT_LE((a.q - beside).norm(), 1e-4) << "of the arm's eight ways to stand, the one it is next to";
}

TEST(Cartesian, WhatCannotBeIsRefusedWithReasonAndDistance) {
  const rbd::Model model = arm();
  const Experiment e = resting();
  const Config config = make_config(e, model);
  const struct {
    Action action;
    const char* why;
  } rows[] = {
      // shoulder at z = 0.3, arm 0.95 to the effector's frame, which is joint 6's: 10 - 0.95 = 9.05
      {goal({10, 0, 0.3}),
       "'effector_body' cannot be there: out of reach: 9.05 m from the target, after 31 starts"},
      {goal({1, 2}),
       "goal of frame 'effector_body' has 2 values, expected 3 (position) or 7 (and a quaternion)"},
      {goal({0.5, 0, 0.5}, "efector_body"), "no frame 'efector_body'; did you mean 'effector_body'?"},
      {goal({0.5, 0, 0.5, 0, 0, 0, 0.5}), "has a quaternion of length 0.5"},
      {goal({1e9, 0, 0}), "goal of frame 'effector_body' is 1e+09 m away"},
  };
  for (const auto& row : rows) {
    const std::string door = why_not(e, model, row.action);
    EXPECT_NE(door.find(row.why), std::string::npos) << door;
    // a planner that gets it all the same says the same, and stays
    std::vector<Event> events;
    EXPECT_EQ(follow(config, row.action, 1000, events).q, config.q0);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].why, "'goal': " + door);
  }
}

}  // namespace
}  // namespace lab::planner
