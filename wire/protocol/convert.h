// Converts between the plain values of steps and the messages on the wire. Header fields (utime, run, step, extras) are the
// caller's, except where they are arguments.
#pragma once
#include <cmath>
#include <lab/action_t.hpp>
#include <lab/command_t.hpp>
#include <lab/event_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <string>

#include "lab/signals/signals.h"

namespace lab {

/// Simulation time of a step, us.
inline int64_t step_utime(int64_t step, double dt) {
  return std::llround(static_cast<double>(step) * dt * 1e6);
}

Action to_signal(const action_t& message);
action_t to_message(const Action& action);
RobotState to_signal(const robot_state_t& message);
void to_message(const RobotState& state, robot_state_t& message);
Reference to_signal(const reference_t& message);
void to_message(const Reference& reference, reference_t& message);
Command to_signal(const command_t& message);
void to_message(const Command& command, command_t& message);
event_t to_message(const Event& event, const std::string& process, int64_t step, int64_t utime, int64_t run,
                   int64_t index);

}  // namespace lab
