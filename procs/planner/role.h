#pragma once
#include <memory>

#include "wire/protocol/follower.h"

namespace lab::planner {

/// The planner's step as a participant of a lockstep run.
std::unique_ptr<Role> make_role(FollowerConfig config, Publish publish);

}  // namespace lab::planner
