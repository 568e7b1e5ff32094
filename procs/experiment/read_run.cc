#include "procs/experiment/read_run.h"

#include <lab/end_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <stdexcept>

#include "procs/experiment/experiment_yaml.h"
#include "procs/simulator/simulator.h"
#include "procs/wire/codec.h"
#include "procs/wire/convert.h"
#include "procs/wire/guard.h"
#include "procs/wire/log_reader.h"

namespace lab {

LoggedRun read_run(const std::string& log) {
  LoggedRun out;
  out.run.aborted = true;
  out.run.reason = "the log has no END";
  std::map<int64_t, Reference> references;
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
      guard.set_run(message.run);
      guard.set_sizes(out.robot.model.nq, out.robot.model.nv);
      begun = true;
    } else if (!begun) {
      continue;
    } else if (*channel == Channel::RobotState) {
      out.run.states.push_back(to_signal(decode<robot_state_t>(event.data)));
      RobotState& state = out.run.states.back();
      state.time = static_cast<double>(state.step) * out.experiment.simulator.dt;
    } else if (*channel == Channel::Reference) {
      Reference reference = to_signal(decode<reference_t>(event.data));
      references[reference.step] = std::move(reference);
    } else if (*channel == Channel::End) {
      const auto end = decode<end_t>(event.data);
      out.run.aborted = end.aborted;
      out.run.reason = end.reason;
    }
  }
  if (!begun) throw std::runtime_error(log + ": has no RUN message; it is not the log of a run");

  // a step counts when both its state and its reference are there
  std::vector<RobotState> whole;
  for (RobotState& state : out.run.states) {
    const auto reference = references.find(state.step);
    if (reference == references.end()) continue;
    out.run.references.push_back(reference->second);
    whole.push_back(std::move(state));
  }
  out.run.states = std::move(whole);
  const simulator::Config plant = simulator::make_config(out.experiment, out.robot.model);
  out.run.model = out.robot.model;
  out.run.dt = plant.dt;
  out.run.damping = plant.damping;
  out.run.friction = plant.friction;
  out.run.last_step = out.experiment.last_step();
  return out;
}

}  // namespace lab
