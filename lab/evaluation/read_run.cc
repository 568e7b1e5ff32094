#include "lab/evaluation/read_run.h"

#include <deque>
#include <lab/command_t.hpp>
#include <lab/end_t.hpp>
#include <lab/input_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "lab/experiment/experiment_yaml.h"
#include "procs/simulator/replay.h"
#include "wire/log/checked_log.h"
#include "wire/protocol/convert.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab {

namespace {

/// Takes the messages of a log one by one and makes steps of them, with bounded memory: processes log independently, so
/// that what belongs to a step may stand a little before or after its state.
class RunReader {
 public:
  explicit RunReader(const std::string& log) : log_(log) {}

  LoggedRun read() {
    out_.log = read_checked(log_, [this](Channel channel, std::span<const uint8_t> data) {
      if (channel == Channel::Run && !energy_)
        begin(decode<run_t>(data));
      else
        take(channel, data);
    });
    out_.path = log_;
    out_.growing = !out_.log.has_end && is_being_written(log_);
    if (!energy_) throw std::runtime_error(log_ + ": has no RUN message; it is not the log of a run");
    while (!states_.empty()) finish_oldest();
    return std::move(out_);
  }

 private:
  static constexpr size_t kStatesHeld = 2048;  ///< so much later may what belongs to a state be logged
  static constexpr size_t kMostWaiting = 4 * kStatesHeld;

  void begin(const run_t& message) {
    out_.id = message.run;
    out_.experiment = parse_experiment(message.experiment, log_ + ":RUN");
    out_.robot = load_robot(out_.experiment, message.urdf, log_ + ":RUN");
    if (message.nq != out_.robot.model.nq || message.nv != out_.robot.model.nv)
      throw std::runtime_error(log_ + ": RUN: nq and nv are " + std::to_string(message.nq) + " and " +
                               std::to_string(message.nv) + ", its robot has " +
                               std::to_string(out_.robot.model.nq) + " and " +
                               std::to_string(out_.robot.model.nv));
    plant_ = simulator::make_config(out_.experiment, out_.robot.model);
    out_.run = begin_run(out_.experiment, out_.robot.model);
    out_.run.aborted = true;
    out_.run.reason = "the log has no END";
    if (!plant_.sensors.perfect()) truth_ = std::make_unique<simulator::TrueStates>(plant_);
    energy_ = std::make_unique<simulator::ExternalEnergy>(plant_);
  }

  void take(Channel channel, std::span<const uint8_t> data) {
    if (channel == Channel::RobotState) {
      const auto message = decode<robot_state_t>(data);
      auto& [state, command_step] = states_.emplace_back(to_signal(message), message.command_step);
      state.time = static_cast<double>(state.step) * out_.experiment.simulator.dt;
      if (states_.size() > kStatesHeld) finish_oldest();
    } else if (channel == Channel::Reference) {
      references_.try_emplace(peek_step(data),
                              to_signal(decode<reference_t>(data)));  // the first of a step counts
      bound(references_);
    } else if (channel == Channel::Command && truth_) {
      commands_.try_emplace(peek_step(data), to_signal(decode<command_t>(data)));
      bound(commands_);
    } else if (channel == Channel::Input) {
      const auto message = decode<input_t>(data);
      actions_[message.step].push_back(to_signal(message.action));
    } else if (channel == Channel::End) {
      const auto end = decode<end_t>(data);
      out_.run.aborted = end.aborted;
      out_.run.reason = end.reason;
    }
  }

  template <class Signal>
  static void bound(std::map<int64_t, Signal>& waiting) {
    if (waiting.size() > kMostWaiting) waiting.erase(waiting.begin());
  }

  /// A step counts if both its state and its reference are there.
  void finish_oldest() {
    auto& [state, command_step] = states_.front();
    const int64_t number = state.step;
    const std::vector<Action> actions = std::move(actions_[number]);
    actions_.erase(actions_.begin(), actions_.upper_bound(number));
    if (truth_) state = true_state(state, command_step, actions);
    const auto energy = energy_->next(state, actions);
    if (const auto reference = references_.find(number); reference != references_.end())
      out_.run.steps.push_back({.state = std::move(state),
                                .reference = std::move(reference->second),
                                .stored_energy = energy.stored,
                                .external_work = energy.work});
    references_.erase(references_.begin(), references_.upper_bound(number));
    states_.pop_front();
  }

  /// A command is new where command_step of the state that it led to is.
  RobotState true_state(const RobotState& logged, int64_t command_step, std::span<const Action> actions) {
    const auto refuse = [&](const std::string& why) { throw std::runtime_error(log_ + ": " + why); };
    const Command* command = nullptr;
    if (command_step != last_command_step_) {
      const auto found = commands_.find(command_step);
      if (found == commands_.end())
        refuse("COMMAND " + std::to_string(command_step) + ", which led to step " +
               std::to_string(logged.step) + ", is not in the log");
      command = &found->second;
      last_command_step_ = command_step;
    }
    try {
      return truth_->next(logged, command, actions);
    } catch (const std::runtime_error& error) {
      refuse(error.what());
    }
    return logged;
  }

  const std::string log_;
  LoggedRun out_;
  simulator::Config plant_;
  std::unique_ptr<simulator::TrueStates> truth_;       ///< behind noise and delay
  std::unique_ptr<simulator::ExternalEnergy> energy_;  ///< null until RUN
  std::deque<std::pair<RobotState, int64_t>> states_;  ///< with their command_step
  std::map<int64_t, Reference> references_;
  std::map<int64_t, Command> commands_;
  std::map<int64_t, std::vector<Action>> actions_;  ///< by the step that they led to
  int64_t last_command_step_ = -1;
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
