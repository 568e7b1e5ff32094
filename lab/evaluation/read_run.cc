#include "lab/evaluation/read_run.h"

#include <algorithm>
#include <lab/command_t.hpp>
#include <lab/end_t.hpp>
#include <lab/input_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "lab/experiment/experiment_yaml.h"
#include "procs/simulator/replay.h"
#include "wire/log/checked_log.h"
#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

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
    out_.log = read_checked(log_, [this](Channel channel, std::span<const uint8_t> data) {
      if (channel == Channel::Run && !begun_)
        begin(decode<run_t>(data));
      else
        take(channel, data);
    });
    out_.path = log_;
    out_.growing = !out_.log.has_end && is_being_written(log_);
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
    if (message.nq != out_.robot.model.nq || message.nv != out_.robot.model.nv)
      throw std::runtime_error(log_ + ": RUN: nq and nv are " + std::to_string(message.nq) + " and " +
                               std::to_string(message.nv) + ", its robot has " +
                               std::to_string(out_.robot.model.nq) + " and " +
                               std::to_string(out_.robot.model.nv));
    begun_ = true;
  }

  void take(Channel channel, std::span<const uint8_t> data) {
    if (channel == Channel::RobotState) {
      const auto message = decode<robot_state_t>(data);
      if (!plant_.sensors.perfect()) command_steps_[message.step] = message.command_step;
      RobotState& state = out_.run.states.emplace_back(to_signal(message));
      state.time = static_cast<double>(state.step) * out_.experiment.simulator.dt;
    } else if (channel == Channel::Reference) {
      out_.run.references.push_back(to_signal(decode<reference_t>(data)));
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

  /// A step counts if both its state and its reference are there. In place: of a long run there is no memory for both.
  void pair_with_references() {
    std::vector<RobotState>& states = out_.run.states;
    std::vector<Reference>& references = out_.run.references;
    const auto by_step = [](const Reference& a, const Reference& b) { return a.step < b.step; };
    if (!std::is_sorted(references.begin(), references.end(), by_step))
      std::stable_sort(references.begin(), references.end(), by_step);
    size_t pairs = 0, next = 0;
    for (RobotState& state : states) {
      while (next < references.size() && references[next].step < state.step) ++next;
      if (next == references.size() || references[next].step != state.step) continue;
      if (&state != &states[pairs]) states[pairs] = std::move(state);
      if (next != pairs) references[pairs] = std::move(references[next]);
      ++pairs;
      ++next;
    }
    states.resize(pairs);
    references.resize(pairs);
  }

  const std::string log_;
  LoggedRun out_;
  bool begun_ = false;
  simulator::Config plant_;
  simulator::SimulatorInputs inputs_;
  std::map<int64_t, Command> commands_;
  std::map<int64_t, int64_t> command_steps_;  ///< by the state that it led to
};

}  // namespace

LoggedRun read_run(const std::string& source) { return RunReader(find_log(source)).read(); }

nlohmann::json evaluate_logged(const LoggedRun& logged) {
  nlohmann::json all = evaluate(logged.run, logged.experiment.expect);
  nlohmann::json damages = nlohmann::json::array();
  for (const LogDamage& damage : logged.log.damages) damages.push_back(text_of(damage));
  all["log"] = {{"sound", logged.log.sound()},
                {"end", logged.log.has_end},
                {"checksums", logged.log.checksums},
                {"damage_count", logged.log.damage_count},
                {"damages", std::move(damages)}};
  if (!logged.log.sound()) all["passed"] = false;
  return all;
}

}  // namespace lab
