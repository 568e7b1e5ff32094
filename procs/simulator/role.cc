#include "procs/simulator/role.h"

#include "procs/run/run.h"
#include "procs/simulator/simulator.h"
#include "procs/wire/codec.h"

namespace lab::simulator {

std::unique_ptr<Sequencer> make_role(const Experiment& experiment, const Robot& robot, int64_t nonce, Publish publish) {
  struct Part {
    Config config;
    State state;
  };
  const Config config = make_config(experiment, robot.model);
  auto part = std::make_shared<Part>(Part{config, initial(config)});
  const AdvanceStep advance = [part](int64_t step_number, const Command* command, std::span<const Action> actions) {
    if (step_number == 0) return Advance{part->state.robot, {}, ""};
    Output output = step(part->config, part->state, {command, actions});
    std::string abort;
    if (output.abort) abort = output.events.back().what + ": " + output.events.back().who + ": " + output.events.back().why;
    return Advance{std::move(output.state), std::move(output.events), std::move(abort)};
  };

  const run_t run = make_run(experiment, robot);
  SequencerConfig sequencer;
  sequencer.run = encode(run);
  sequencer.run_id = run.run, sequencer.model_hash = run.model_hash, sequencer.nonce = nonce;
  sequencer.nq = run.nq, sequencer.nv = run.nv;
  sequencer.dt = experiment.simulator.dt, sequencer.last_step = experiment.last_step();
  sequencer.every = experiment.controller.every, sequencer.lead = experiment.planner.lead;
  sequencer.deadline = std::llround(experiment.deadline * 1e6), sequencer.ready_deadline = std::llround(experiment.ready * 1e6);
  return std::make_unique<Sequencer>(std::move(sequencer), advance, std::move(publish));
}

}  // namespace lab::simulator
