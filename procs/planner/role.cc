#include "procs/planner/role.h"

#include "lab/run/run.h"
#include "procs/planner/planner.h"
#include "wire/protocol/planner_role.h"

namespace lab::planner {

std::unique_ptr<Role> make_role(FollowerConfig follower, Publish publish) {
  struct Part {
    Config config;
    State state;
  };
  auto part = std::make_shared<Part>();
  const BeginRun begin = [part](const run_t& message) {
    const RunView run = open_run(message);
    part->config = make_config(run.experiment, run.robot.model);
    part->state = initial(part->config);
    return setup_of(run);
  };
  const PlanStep plan = [part](int64_t step_number, const PlanInput& input, std::vector<Event>& events) {
    Output output = step(part->config, part->state, {step_number, input.actions, input.state, input.held});
    events = std::move(output.events);
    return std::move(output.reference);
  };
  return std::make_unique<PlannerRole>(std::move(follower), begin, plan, std::move(publish));
}

}  // namespace lab::planner
