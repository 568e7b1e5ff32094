// The planner as a participant of a run.
#pragma once
#include <memory>

#include "wire/protocol/follower.h"

namespace lab::planner {

/// The planner in the protocol, with the step of this room.
std::unique_ptr<Role> make_role(FollowerConfig config, Publish publish);

}  // namespace lab::planner
