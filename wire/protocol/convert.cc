#include "wire/protocol/convert.h"

namespace lab {
namespace {

Eigen::VectorXd vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}
void assign(std::vector<double>& values, const Eigen::VectorXd& x) {
  values.assign(x.data(), x.data() + x.size());
}

}  // namespace

Action to_signal(const action_t& m) { return {m.verb, m.target, m.key, m.text, m.values}; }

action_t to_message(const Action& action) {
  action_t m;
  m.verb = action.verb;
  m.target = action.target;
  m.key = action.key;
  m.text = action.text;
  m.n = static_cast<int32_t>(action.values.size());
  m.values = action.values;
  return m;
}

RobotState to_signal(const robot_state_t& m) {
  return {m.step, static_cast<double>(m.utime) * 1e-6, vector(m.q), vector(m.v), vector(m.tau)};
}
void to_message(const RobotState& state, robot_state_t& m) {
  m.nq = static_cast<int32_t>(state.q.size());
  m.nv = static_cast<int32_t>(state.v.size());
  assign(m.q, state.q);
  assign(m.v, state.v);
  assign(m.tau, state.tau);
}

Reference to_signal(const reference_t& m) { return {m.step, vector(m.q), vector(m.v), vector(m.a)}; }
void to_message(const Reference& reference, reference_t& m) {
  m.nq = static_cast<int32_t>(reference.q.size());
  m.nv = static_cast<int32_t>(reference.v.size());
  assign(m.q, reference.q);
  assign(m.v, reference.v);
  assign(m.a, reference.a);
}

Command to_signal(const command_t& m) { return {vector(m.tau), m.state_step}; }
void to_message(const Command& command, command_t& m) {
  m.nv = static_cast<int32_t>(command.tau.size());
  assign(m.tau, command.tau);
}

event_t to_message(const Event& event, const std::string& process, int64_t step, int64_t utime, int64_t run,
                   int64_t index) {
  event_t m;
  m.utime = utime;
  m.run = run;
  m.step = step;
  m.index = index;
  m.process = process;
  m.what = event.what;
  m.who = event.who;
  m.why = event.why;
  return m;
}

}  // namespace lab
