#include "procs/controller/role.h"

#include <optional>

#include "lab/run/run.h"
#include "procs/controller/controller.h"
#include "wire/protocol/controller_role.h"

namespace lab::controller {

std::unique_ptr<Role> make_role(FollowerConfig follower, Publish publish, std::span<const Kind> more) {
  struct Part {
    Config config;
    std::optional<State> state;
  };
  auto part = std::make_shared<Part>();
  const BeginRun begin = [part, more](const run_t& message) {
    const RunView run = open_run(message);
    part->config = make_config(run.experiment, run.robot.model, more);
    part->state.emplace(initial(part->config));
    return setup_of(run);
  };
  const ControlStep control = [part](const RobotState& state, const Reference& reference,
                                     std::span<const Action> actions, std::vector<Event>& events) {
    Output output = step(part->config, *part->state, {state, reference, actions});
    events = std::move(output.events);
    return std::move(output.command);
  };
  return std::make_unique<ControllerRole>(std::move(follower), begin, control, std::move(publish));
}

}  // namespace lab::controller
