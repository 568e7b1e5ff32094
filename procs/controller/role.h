// The controller as a participant of a run.
#pragma once
#include <memory>
#include <span>

#include "procs/controller/controller.h"
#include "wire/protocol/follower.h"

namespace lab::controller {

/// The protocol role around step() of controller.h. `more`: kinds of the caller's own (docs/extend.md).
std::unique_ptr<Role> make_role(FollowerConfig config, Publish publish, std::span<const Kind> more = {});

}  // namespace lab::controller
