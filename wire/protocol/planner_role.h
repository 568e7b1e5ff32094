// The planner in the protocol. Lockstep: REFERENCE 0..lead-1 on RUN, then REFERENCE k + lead on ROBOT_STATE k.
// Real time: the reference for the step after the newest state.
#pragma once
#include "wire/protocol/follower.h"

namespace lab {

/// The inputs of one reference.
struct PlanInput {
  const RobotState* state = nullptr;  ///< newest; null before the first
  std::span<const Action> actions{};
  bool held = false;  ///< real time: the simulator holds the robot
};
/// Makes the reference for one step. Adds what the log should report to `events`.
using PlanStep = std::function<Reference(int64_t step, const PlanInput& input, std::vector<Event>& events)>;

class PlannerRole : public FollowerRole {
 public:
  PlannerRole(FollowerConfig config, BeginRun begin, PlanStep plan, Publish publish);
};

}  // namespace lab
