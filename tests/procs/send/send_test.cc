// What people type, right and wrong.
#include "procs/send/send.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::send {
namespace {

using Words = std::vector<std::string>;
using Numbers = std::vector<double>;
const Words kJoints{"shoulder", "elbow"};

std::string refusal(const std::function<void()>& typed) {
  try {
    typed();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Send, GoalForAllJoints) {
  EXPECT_FALSE(names_joints(Words{"1", "-2e-1"}));
  const Action action = goal(Words{"1", "-2e-1"}, 2.5);
  EXPECT_EQ(action.values, (Numbers{1, -0.2}));
  EXPECT_EQ(action.key + action.text, "duration2.5");
  EXPECT_EQ(goal(Words{"1"}, 0).key, "");
}

TEST(Send, GoalForSomeJointsKeepsTheOthers) {
  EXPECT_TRUE(names_joints(Words{"elbow=0.5"}));
  EXPECT_EQ(goal(Words{"elbow=0.5"}, 0, kJoints, {0.1, 0.2}).values, (Numbers{0.1, 0.5}));
  EXPECT_EQ(refusal([] { goal(Words{"elbo=1"}, 0, kJoints, {0, 0}); }),
            "goal: the robot has no joint 'elbo'; did you mean 'elbow'?");
  EXPECT_EQ(refusal([] { goal(Words{"elbow=1", "2"}, 0, kJoints, {0, 0}); }),
            "goal: '2': either all numbers or JOINT=VALUE");
  EXPECT_EQ(refusal([] { goal(Words{"elbow=1"}, 0, kJoints, {0, 0, 0}); }),
            "goal: this robot's configuration has other parts than joints; give all of its numbers");
}

TEST(Send, FollowersTakeNoGoals) {
  EXPECT_EQ(refusal([] { goal(Words{"wrist=1"}, 0, kJoints, {0, 0}, {{"wrist", "elbow"}}); }),
            "goal: 'wrist' follows 'elbow'; give a goal for that one");
}

TEST(Send, GoalForAFrame) {
  const Action position = goal(Place{"tool", "0.5,-0.1,1e-1", "", ""}, 2);
  EXPECT_EQ(position.target + position.key + position.text, "toolduration2");
  EXPECT_EQ(position.values, (Numbers{0.5, -0.1, 0.1}));
  // a quarter turn about y: both spellings
  const double half = std::sqrt(0.5);
  const Numbers turned{0, 0, 0, 0, half, 0, half};
  for (const Place& place : {Place{"tool", "0,0,0", "0,1.5707963267948966,0", ""},
                             Place{"tool", "0,0,0", "", "0,0.7071,0,0.7071"}}) {
    const Action pose = goal(place, 0);
    ASSERT_EQ(pose.values.size(), 7u);
    for (size_t i = 0; i < 7; ++i) EXPECT_NEAR(pose.values[i], turned[i], 1e-15);
  }
  EXPECT_EQ(refusal([] { goal(Place{"tool", "", "", ""}, 0); }), "goal: --frame tool needs --position x,y,z");
  EXPECT_EQ(refusal([] { goal(Place{"tool", "1,2", "", ""}, 0); }),
            "--position: '1,2' has 2 numbers, expected 3");
  EXPECT_EQ(refusal([] { goal(Place{"tool", "1,,2", "", ""}, 0); }), "--position: '' is not a number");
  EXPECT_EQ(refusal([] { goal(Place{"tool", "1,2,3", "", "0,0,0,0"}, 0); }),
            "--quaternion: its length is 0, must be 1");
  EXPECT_EQ(refusal([] { goal(Place{"tool", "1,2,3", "nan,0,0", ""}, 0); }), "--rpy: nan is not finite");
}

TEST(Send, SetOneManyOrAWord) {
  EXPECT_EQ(set("controller", "kp=80").values, Numbers{80});
  EXPECT_EQ(set("controller", "kp=1,2,3").values, (Numbers{1, 2, 3}));
  EXPECT_EQ(set("controller", "kind=pd").text, "pd");
  EXPECT_EQ(set("controller", "kp=80").key + set("controller", "kp=80").target, "kpcontroller");
  EXPECT_EQ(refusal([] { set("controller", "kp"); }), "set: 'kp' must look like kp=80");
  EXPECT_EQ(refusal([] { set("controller", "kp="); }), "set: 'kp=' has no value");
  EXPECT_EQ(refusal([] { set("controller", "kp=1,x"); }), "set: kp: 'x' is not a number");
  EXPECT_EQ(refusal([] { set("controller", "kp=nan"); }), "set: kp: nan is not finite");
}

TEST(Send, PushIsAngularFirstOnTheWire) {
  EXPECT_EQ(push("tool", Words{"1", "2", "3"}, 0.5).values, (Numbers{0, 0, 0, 1, 2, 3, 0.5}));
  EXPECT_EQ(push("tool", Words{"1", "2", "3", "4", "5", "6"}, 0.5).values, (Numbers{4, 5, 6, 1, 2, 3, 0.5}));
  EXPECT_EQ(refusal([] { push("tool", Words{"1"}, 0.5); }),
            "push: has 1 numbers, expected 3 (force, N) or 6 (force and torque, Nm)");
  EXPECT_EQ(refusal([] { push("tool", Words{"1", "2", "inf"}, 0.5); }), "push: inf is not finite");
  EXPECT_EQ(refusal([] { push("tool", Words{"1", "2", "3"}, 0); }), "--for: 0 is no time in s");
}

TEST(Send, PayloadIsMassThenPlace) {
  EXPECT_EQ(payload("tool", "2.5", "").values, (Numbers{2.5, 0, 0, 0}));
  EXPECT_EQ(payload("tool", "0", "0,-0.1,1e-1").values, (Numbers{0, 0, -0.1, 0.1}));
  EXPECT_EQ(payload("tool", "1", "").verb + payload("tool", "1", "").target, "payloadtool");
  EXPECT_EQ(refusal([] { payload("tool", "heavy", ""); }), "payload: 'heavy' is not a number");
  EXPECT_EQ(refusal([] { payload("tool", "1", "1,2"); }), "--com: '1,2' has 2 numbers, expected 3");
}

TEST(Send, WhatCameOfIt) {
  reply_t reply{};
  reply.ok = true;
  reply.step = 12;
  EXPECT_EQ(told(plain("estop"), reply), "estop accepted, from step 12");
  EXPECT_EQ(told(plain("pause"), reply), "paused before step 12");
  EXPECT_EQ(told(steps(5), reply), "5 steps from step 12");
  EXPECT_EQ(refusal([] { steps(0); }), "step: 0 is not a count");
  reply.ok = false;
  reply.reason = "the run is ending";
  EXPECT_EQ(told(plain("estop"), reply), "estop refused: the run is ending");
}

}  // namespace
}  // namespace lab::send
