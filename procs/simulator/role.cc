#include "procs/simulator/role.h"

#include "lab/experiment/actions.h"
#include "lab/run/run.h"
#include "procs/controller/controller.h"
#include "procs/planner/planner.h"
#include "procs/simulator/in_force.h"
#include "procs/simulator/simulator.h"
#include "wire/process/participant.h"
#include "wire/protocol/lockstep_simulator.h"
#include "wire/protocol/realtime_simulator.h"
#include "wire/schema/codec.h"

namespace lab::simulator {
namespace {

/// Why a request is refused. The steps that carry it out are asked by their own functions, if they are the lab's own: what is
/// accepted must happen.
decltype(SimulatorConfig::why_not) asked_before(const Experiment& experiment, const rbd::Model& model) {
  const auto plan = experiment.processes.contains(kPlanner)
                        ? nullptr
                        : std::make_shared<const planner::Config>(planner::make_config(experiment, model));
  return [experiment, model, plan](const Action& action, const Reference* newest) {
    std::string why = why_not(experiment, model, action);
    if (!why.empty()) return why;
    if (action.verb == "goal" && plan && newest) return planner::goal_fault(*plan, action, *newest);
    if (action.verb == "set" && action.target == kController && !experiment.processes.contains(kController))
      return controller::unused_gain(experiment.controller.kind, action.key);
    return why;
  };
}

}  // namespace

std::unique_ptr<SimulatorRole> make_role(const Experiment& experiment, const Robot& robot, int64_t nonce,
                                         Publish publish) {
  struct Part {
    Config config;
    State state;
  };
  const Config plant = make_config(experiment, robot.model);
  auto part = std::make_shared<Part>(Part{plant, initial(plant)});
  const auto gains = experiment.processes.contains(kController)
                         ? std::vector<std::string>()
                         : controller::gains_of(experiment.controller.kind);
  const auto in_force = std::make_shared<InForce>(experiment, robot.model, gains);
  const SimulateStep advance = [part, in_force](int64_t step_number, const Command* command,
                                                std::span<const Action> actions) {
    if (step_number == 0)
      return StepResult{sensed(part->config, part->state), {}, "", safety::name(part->state.safety.mode)};
    Output output = step(part->config, part->state, {command, actions});
    for (const Action& action : actions) in_force->take(action);
    std::string abort;
    if (output.abort)
      abort = output.events.back().what + ": " + output.events.back().who + ": " + output.events.back().why;
    return StepResult{std::move(output.state), std::move(output.events), std::move(abort),
                      safety::name(output.mode)};
  };

  const run_t run = make_run(experiment, robot);
  SimulatorConfig config;
  config.run = encode(run);
  config.types = all_type_messages(run.run);
  config.run_id = run.run;
  config.model_hash = run.model_hash;
  config.wall_offset = wall_now() - monotonic_now();
  config.nq = run.nq;
  config.nv = run.nv;
  config.dt = experiment.simulator.dt;
  config.last_step = experiment.last_step();
  config.every = experiment.controller.every;
  config.lead = experiment.planner.lead;
  config.deadline = std::llround(experiment.deadline * 1e6);
  config.ready_deadline = std::llround(experiment.ready * 1e6);
  config.in_force = [in_force] { return in_force->text(); };
  config.why_not = asked_before(experiment, robot.model);
  if (experiment.simulator.clock == "realtime") {
    if (nonce == 0)
      config.no_reset = "this simulator has no supervisor (scripts/lab up) that would start the next run";
    return std::make_unique<RealtimeSimulatorRole>(std::move(config), advance, std::move(publish));
  }
  config.no_reset =
      "in lockstep a run is not reset, it would only be the same again: end it and start another";
  return std::make_unique<LockstepSimulatorRole>(std::move(config), advance, std::move(publish));
}

}  // namespace lab::simulator
