#include "procs/solo/direct.h"

#include <fmt/format.h>

#include <cmath>
#include <deque>

#include "procs/controller/controller.h"
#include "procs/planner/planner.h"
#include "procs/simulator/replay.h"
#include "wire/protocol/convert.h"

namespace lab::solo {
namespace {

constexpr int64_t kCheckEvery = 1024;  // steps between two calls of keep_going

/// As planner and controller see it: a message's time is in whole microseconds.
RobotState received(RobotState state, double dt) {
  state.time = static_cast<double>(step_utime(state.step, dt)) * 1e-6;
  return state;
}

/// Why the guard would refuse to send this effort, in the words of lab-solo; empty if it may be sent.
std::string fault_of(const Command& command) {
  for (Eigen::Index i = 0; i < command.tau.size(); ++i)
    if (!std::isfinite(command.tau[i]))
      return fmt::format("the effort for step {} is not finite: tau[{}] is {}; nothing was sent",
                         command.state_step, i, command.tau[i]);
  return "";
}

/// Keeps the steps that the logger would have written.
class StepsAsLogged {
 public:
  StepsAsLogged(const simulator::Config& plant, int64_t every, StepTable& out)
      : energy_(plant), every_(every), out_(out) {}

  void take(const RobotState& state, const Reference& reference) {
    if (every_ == 1) return keep({.state = state, .reference = reference});
    if (last_ && last_->state.step % every_ == 0) keep(std::move(*last_));
    last_ = {.state = state, .reference = reference};
  }
  /// The last step is always logged.
  void end() {
    if (last_) keep(std::move(*last_));
  }

 private:
  void keep(RunStep step) {
    const auto energy = energy_.next(step.state, {});
    step.stored_energy = energy.stored;
    step.external_work = energy.work;
    out_.push_back(step);
  }

  simulator::ExternalEnergy energy_;
  int64_t every_;
  StepTable& out_;
  std::optional<RunStep> last_;
};

}  // namespace

std::optional<Run> run_direct(const Experiment& e, const rbd::Model& model,
                              const std::function<bool()>& keep_going) {
  const simulator::Config plant = simulator::make_config(e, model);
  const planner::Config plan = planner::make_config(e, model);
  const controller::Config control = controller::make_config(e, model);
  simulator::State plant_state = simulator::initial(plant);
  planner::State plan_state = planner::initial(plan);
  controller::State control_state = controller::initial(control);

  Run run = begin_run(e, model);
  const int64_t lead = e.planner.lead, every = e.controller.every;
  StepsAsLogged steps(plant, e.logger.every, run.steps);
  std::deque<Reference> ahead;  // from this step on
  const auto refer = [&](int64_t step, const RobotState* state) {
    if (step <= run.last_step)
      ahead.push_back(planner::step(plan, plan_state, {.step = step, .state = state}).reference);
  };
  const auto give_up = [&](std::string reason) {
    run.aborted = true;
    run.reason = std::move(reason);
  };

  // the first references go out before there is a state
  for (int64_t step = 0; step < lead; ++step) refer(step, nullptr);
  RobotState seen = received(simulator::sensed(plant, plant_state), run.dt);
  Command command;
  for (int64_t k = 0; !run.aborted; ++k) {
    if (k % kCheckEvery == 0 && keep_going && !keep_going()) return std::nullopt;
    refer(k + lead, &seen);
    const Reference reference = std::move(ahead.front());
    ahead.pop_front();
    steps.take(plant_state.robot, reference);
    const bool due = k % every == 0;
    if (due) {
      command = controller::step(control, control_state, {.state = seen, .reference = reference}).command;
      command.state_step = k;
      if (std::string fault = fault_of(command); !fault.empty()) give_up(std::move(fault));
    }
    if (k == run.last_step || run.aborted) break;
    simulator::Output next = simulator::step(plant, plant_state, {.command = due ? &command : nullptr});
    if (!next.abort) {
      seen = received(std::move(next.state), run.dt);
    } else {
      const Event& event = next.events.back();
      give_up(fmt::format("step {}: {}: {}: {}", k + 1, event.what, event.who, event.why));
    }
  }
  steps.end();
  return run;
}

}  // namespace lab::solo
