#pragma once
#include "lab/evaluation/evaluate.h"
#include "lab/experiment/robot.h"
#include "procs/controller/controller.h"
#include "procs/planner/planner.h"
#include "procs/simulator/ledger.h"
#include "procs/simulator/simulator.h"

/// The three steps in one loop, as lockstep orders them: for tests that want a run without processes.
namespace lab::test {

struct LoopResult {
  Run run;
  std::vector<Event> events;
};

inline LoopResult run_loop(const Experiment& e, const rbd::Model& model) {
  const simulator::Config plant = simulator::make_config(e, model);
  const planner::Config plan = planner::make_config(e, model);
  const controller::Config control = controller::make_config(e, model);
  simulator::State plant_state = simulator::initial(plant);
  planner::State plan_state = planner::initial(plan);
  controller::State control_state = controller::initial(control);

  LoopResult out;
  Run& run = out.run = begin_run(e, model);
  run.states.push_back(plant_state.robot);
  RobotState seen = simulator::sensed(plant, plant_state);
  for (int64_t k = 0;; ++k) {
    run.references.push_back(planner::step(plan, plan_state, {.step = k}).reference);
    if (k == run.last_step) break;
    Command command;
    const bool due = k % e.controller.every == 0;
    if (due)
      command = controller::step(control, control_state, {.state = seen, .reference = run.references.back()})
                    .command;
    simulator::Output next = simulator::step(plant, plant_state, {.command = due ? &command : nullptr});
    out.events.insert(out.events.end(), next.events.begin(), next.events.end());
    if (next.abort) {
      run.aborted = true;
      run.reason = next.events.back().who + ": " + next.events.back().why;
      return out;
    }
    run.states.push_back(plant_state.robot);
    seen = std::move(next.state);
  }
  simulator::Ledger ledger = simulator::ledger(plant, run.states, {});
  run.stored = std::move(ledger.stored), run.given = std::move(ledger.work);
  return out;
}

}  // namespace lab::test
