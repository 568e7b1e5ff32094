// The planner as a participant of a run.
#pragma once
#include <memory>

#include "wire/protocol/follower.h"

namespace lab::planner {

/// The protocol role around step() of planner.h.
std::unique_ptr<Role> make_role(FollowerConfig config, Publish publish);

}  // namespace lab::planner
