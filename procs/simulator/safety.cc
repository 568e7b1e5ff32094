#include "procs/simulator/safety.h"

namespace lab::safety {
namespace {

void enter_holding(const Config& config, State& state) {
  state.mode = Mode::Holding;
  state.armed = !config.manual;
  state.fresh_in_a_row = 0;
}

void run(State& state, const std::string& why, std::vector<Event>& events) {
  state.mode = Mode::Running;
  events.push_back({"running", "controller", why});
}

}  // namespace

bool fresh(const Config& config, const State& state, int64_t step, int64_t command_from) {
  if (config.timeout == 0) return true;
  return command_from > state.newest && command_from < step && step - command_from < config.timeout;
}

Mode step(const Config& config, State& state, const Input& input, std::vector<Event>& events) {
  if (input.command_from && fresh(config, state, input.step, *input.command_from)) {
    state.newest = *input.command_from;
    ++state.fresh_in_a_row;
  }
  const bool stale = config.timeout > 0 && (state.newest < 0 || input.step - state.newest >= config.timeout);
  if (stale) state.fresh_in_a_row = 0;

  if (input.estop && state.mode != Mode::Stopped) {
    state.mode = Mode::Stopped;
    events.push_back({"estop", "person", "held until rearm"});
  } else if (input.rearm && !input.estop && state.mode == Mode::Stopped) {
    events.push_back({"rearm", "person", "after an emergency stop"});
    if (config.timeout == 0) {
      run(state, "every command is waited for", events);
    } else {
      state.mode = Mode::Holding;
      state.armed = true;
      state.fresh_in_a_row = 0;
    }
  } else if (input.rearm && state.mode == Mode::Holding && !state.armed) {
    events.push_back({"rearm", "person", "after holding"});
    state.armed = true;
  }

  if (state.mode == Mode::Waiting && !stale) {
    run(state, "first command", events);
  } else if (state.mode == Mode::Running && stale) {
    enter_holding(config, state);
    events.push_back({"holding", "controller",
                      "no fresh command for " + std::to_string(config.timeout) +
                          " steps; the last was made from step " + std::to_string(state.newest)});
  } else if (state.mode == Mode::Holding && state.armed && state.fresh_in_a_row >= config.fresh_to_resume) {
    run(state, std::to_string(config.fresh_to_resume) + " fresh commands in a row", events);
  }
  return state.mode;
}

void trip(const Config& config, State& state, const std::string& who, const std::string& why,
          std::vector<Event>& events) {
  enter_holding(config, state);
  events.push_back({"holding", who, why});
}

const char* name(Mode mode) {
  switch (mode) {
    case Mode::Running:
      return "RUNNING";
    case Mode::Stopped:
      return "FAULT";
    default:
      return "HOLDING";
  }
}

}  // namespace lab::safety
