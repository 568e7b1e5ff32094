#include "lab/evaluation/read_run.h"

#include <lab/command_t.hpp>
#include <lab/end_t.hpp>
#include <lab/input_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <stdexcept>

#include "lab/experiment/experiment_yaml.h"
#include "procs/simulator/replay.h"
#include "wire/log/log_reader.h"
#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"
#include "wire/schema/guard.h"

namespace lab {

namespace {

/// The commands by the step that they led to. One is new where command_step of the state that it led to is.
std::map<int64_t, Command> by_step_led_to(const std::map<int64_t, int64_t>& command_steps,
                                          const std::map<int64_t, Command>& commands) {
  std::map<int64_t, Command> out;
  int64_t last = -1;
  for (const auto& [step, command_step] : command_steps) {
    if (command_step == last) continue;
    const auto command = commands.find(command_step);
    if (command == commands.end())
      throw std::runtime_error("COMMAND " + std::to_string(command_step) + ", which led to step " +
                               std::to_string(step) + ", is not in the log");
    out[step] = command->second;
    last = command_step;
  }
  return out;
}

}  // namespace

LoggedRun read_run(const std::string& log) {
  LoggedRun out;
  std::map<int64_t, Reference> references;
  std::map<int64_t, Command> commands;
  std::map<int64_t, int64_t> command_steps;  // by the state that it led to
  simulator::SimulatorInputs inputs;
  simulator::Config plant;
  Guard guard;
  LogReader reader(log);
  bool begun = false;
  for (LogEvent event; reader.next(event);) {
    const auto channel = channel_of(event.channel);
    if (!channel) continue;
    if (const Verdict verdict = guard.check(*channel, event.data); !verdict)
      throw std::runtime_error(log + ": event " + std::to_string(event.number) + ": " + verdict.reason);
    if (*channel == Channel::Run && !begun) {
      const auto message = decode<run_t>(event.data);
      out.id = message.run;
      out.experiment = parse_experiment(message.experiment, log + ":RUN");
      out.robot = load_robot(out.experiment, message.urdf, log + ":RUN");
      plant = simulator::make_config(out.experiment, out.robot.model);
      out.run = begin_run(out.experiment, out.robot.model);
      out.run.aborted = true, out.run.reason = "the log has no END";
      guard.set_run(message.run);
      guard.set_sizes(out.robot.model.nq, out.robot.model.nv);
      begun = true;
    } else if (!begun) {
      continue;
    } else if (*channel == Channel::RobotState) {
      const auto message = decode<robot_state_t>(event.data);
      command_steps[message.step] = message.command_step;
      out.run.states.push_back(to_signal(message));
      RobotState& state = out.run.states.back();
      state.time = static_cast<double>(state.step) * out.experiment.simulator.dt;
    } else if (*channel == Channel::Reference) {
      Reference reference = to_signal(decode<reference_t>(event.data));
      references[reference.step] = std::move(reference);
    } else if (*channel == Channel::Command) {
      const auto message = decode<command_t>(event.data);
      if (!plant.sensors.perfect()) commands.try_emplace(message.step, to_signal(message));
    } else if (*channel == Channel::Input) {
      const auto message = decode<input_t>(event.data);
      inputs.actions[message.step].push_back(to_signal(message.action));
    } else if (*channel == Channel::End) {
      const auto end = decode<end_t>(event.data);
      out.run.aborted = end.aborted;
      out.run.reason = end.reason;
    }
  }
  if (!begun) throw std::runtime_error(log + ": has no RUN message; it is not the log of a run");

  if (!plant.sensors.perfect()) {
    try {
      inputs.commands = by_step_led_to(command_steps, commands);
      out.run.states = simulator::true_states(plant, out.run.states, inputs);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(log + ": " + error.what());
    }
  }
  simulator::ExternalEnergy external = simulator::external_energy(plant, out.run.states, inputs);
  out.run.stored_energy = std::move(external.stored);
  out.run.external_work = std::move(external.work);

  // a step counts when both its state and its reference are there
  std::vector<RobotState> whole;
  for (RobotState& state : out.run.states) {
    const auto reference = references.find(state.step);
    if (reference == references.end()) continue;
    out.run.references.push_back(reference->second);
    whole.push_back(std::move(state));
  }
  out.run.states = std::move(whole);
  return out;
}

}  // namespace lab
