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
#include "wire/log/logged_messages.h"
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

/// Takes the messages of a log one by one, then makes the run of them.
class RunReader {
 public:
  explicit RunReader(const std::string& log) : log_(log) {}

  LoggedRun read() {
    for_each_message(
        log_, guard_,
        [this](Channel channel, std::span<const uint8_t> data) {
          if (channel == Channel::Run && !begun_)
            begin(decode<run_t>(data));
          else if (begun_)
            take(channel, data);
        },
        [this](const LogEvent& event, const Verdict& verdict) {
          throw std::runtime_error(log_ + ": event " + std::to_string(event.number) + ": " + verdict.reason);
        });
    if (!begun_) throw std::runtime_error(log_ + ": has no RUN message; it is not the log of a run");
    replay();
    pair_with_references();
    return std::move(out_);
  }

 private:
  void begin(const run_t& message) {
    out_.id = message.run;
    out_.experiment = parse_experiment(message.experiment, log_ + ":RUN");
    out_.robot = load_robot(out_.experiment, message.urdf, log_ + ":RUN");
    plant_ = simulator::make_config(out_.experiment, out_.robot.model);
    out_.run = begin_run(out_.experiment, out_.robot.model);
    out_.run.aborted = true;
    out_.run.reason = "the log has no END";
    guard_.set_run(message.run);
    guard_.set_sizes(out_.robot.model.nq, out_.robot.model.nv);
    begun_ = true;
  }

  void take(Channel channel, std::span<const uint8_t> data) {
    if (channel == Channel::RobotState) {
      const auto message = decode<robot_state_t>(data);
      command_steps_[message.step] = message.command_step;
      RobotState& state = out_.run.states.emplace_back(to_signal(message));
      state.time = static_cast<double>(state.step) * out_.experiment.simulator.dt;
    } else if (channel == Channel::Reference) {
      Reference reference = to_signal(decode<reference_t>(data));
      references_[reference.step] = std::move(reference);
    } else if (channel == Channel::Command) {
      const auto message = decode<command_t>(data);
      if (!plant_.sensors.perfect()) commands_.try_emplace(message.step, to_signal(message));
    } else if (channel == Channel::Input) {
      const auto message = decode<input_t>(data);
      inputs_.actions[message.step].push_back(to_signal(message.action));
    } else if (channel == Channel::End) {
      const auto end = decode<end_t>(data);
      out_.run.aborted = end.aborted;
      out_.run.reason = end.reason;
    }
  }

  /// True states behind noise and delay, and the energy that disturbances store and bring.
  void replay() {
    if (!plant_.sensors.perfect()) {
      try {
        inputs_.commands = by_step_led_to(command_steps_, commands_);
        out_.run.states = simulator::true_states(plant_, out_.run.states, inputs_);
      } catch (const std::runtime_error& error) {
        throw std::runtime_error(log_ + ": " + error.what());
      }
    }
    simulator::ExternalEnergy external = simulator::external_energy(plant_, out_.run.states, inputs_);
    out_.run.stored_energy = std::move(external.stored);
    out_.run.external_work = std::move(external.work);
  }

  /// A step counts if both its state and its reference are there.
  void pair_with_references() {
    std::vector<RobotState> whole;
    for (RobotState& state : out_.run.states) {
      const auto reference = references_.find(state.step);
      if (reference == references_.end()) continue;
      out_.run.references.push_back(reference->second);
      whole.push_back(std::move(state));
    }
    out_.run.states = std::move(whole);
  }

  const std::string log_;
  LoggedRun out_;
  bool begun_ = false;
  Guard guard_;
  simulator::Config plant_;
  simulator::SimulatorInputs inputs_;
  std::map<int64_t, Reference> references_;
  std::map<int64_t, Command> commands_;
  std::map<int64_t, int64_t> command_steps_;  ///< by the state that it led to
};

}  // namespace

LoggedRun read_run(const std::string& log) { return RunReader(log).read(); }

}  // namespace lab
