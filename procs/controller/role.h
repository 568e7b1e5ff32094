#pragma once
#include <memory>

#include "procs/wire/follower.h"

namespace lab::controller {

/// The controller's step as a participant of a lockstep run.
std::unique_ptr<Role> make_role(FollowerConfig config, Publish publish);

}  // namespace lab::controller
