// The controller in the protocol. Lockstep: COMMAND k from ROBOT_STATE k and REFERENCE k, at every step that `every`
// divides. Real time: COMMAND from the newest of both.
#pragma once
#include "wire/protocol/follower.h"

namespace lab {

/// Makes the effort for one state.
using ControlStep = std::function<Command(const RobotState& state, const Reference& reference,
                                          std::span<const Action> actions, std::vector<Event>& events)>;

class ControllerRole : public FollowerRole {
 public:
  ControllerRole(FollowerConfig config, BeginRun begin, ControlStep control, Publish publish);
};

}  // namespace lab
