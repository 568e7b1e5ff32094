#include "procs/simulator/replay.h"

#include <rbd/algorithm/kinematics.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "core/util/number.h"
#include "lab/experiment/actions.h"
#include "lab/experiment/joints.h"

namespace lab::simulator {
namespace {

/// Index of the first entry that differs in any bit; -1 = none.
Eigen::Index difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (a.size() != b.size()) return 0;
  for (Eigen::Index i = 0; i < a.size(); ++i)
    if (std::bit_cast<uint64_t>(a[i]) != std::bit_cast<uint64_t>(b[i])) return i;
  return -1;
}

void require_same(const RobotState& logged, const RobotState& replayed) {
  const std::pair<const char*, Eigen::VectorXd RobotState::*> parts[] = {
      {"q", &RobotState::q}, {"v", &RobotState::v}, {"tau", &RobotState::tau}};
  for (const auto& [name, part] : parts)
    if (const Eigen::Index i = difference(logged.*part, replayed.*part); i >= 0)
      throw std::runtime_error("the log does not follow from its own commands: at step " +
                               std::to_string(logged.step) + " " + name + "[" + std::to_string(i) + "] is " +
                               number((logged.*part)[i]) + ", replayed " + number((replayed.*part)[i]) +
                               "; was it made by another version, or on another kind of CPU?");
}

template <class Map>
auto at_step(const Map& map, int64_t step) {
  const auto found = map.find(step);
  return found == map.end() ? nullptr : &found->second;
}

/// Poses and velocities of frames at one state.
struct FrameView {
  const rbd::Model& model;
  rbd::Data data;
  explicit FrameView(const rbd::Model& m) : model(m), data(m) {}
  void set(const RobotState& s) { rbd::forwardKinematics(model, data, s.q, s.v); }
  const rbd::SE3& pose(rbd::FrameIndex frame) { return rbd::updateFramePlacement(model, data, frame); }
  rbd::Motion velocity(rbd::FrameIndex frame) {
    return rbd::getFrameVelocity(model, data, frame, rbd::LOCAL_WORLD_ALIGNED);
  }
};

double payload_energy(FrameView& now, const Load& load) {
  double sum = 0;
  for (const Payload& payload : load.payloads) {
    const rbd::SE3 pose = now.pose(payload.frame);
    const rbd::Motion frame = now.velocity(payload.frame);
    const Eigen::Vector3d arm = pose.rotation() * payload.com,
                          v = frame.linear() + frame.angular().cross(arm);
    sum += payload.mass * (0.5 * v.dot(v) - now.model.gravity.linear().dot(pose.translation() + arm));
  }
  return sum;
}

double stop_energy(const std::vector<SoftStop>& stops, const RobotState& s) {
  double sum = 0;
  for (const SoftStop& stop : stops) {
    const double x = stop.depth(s.q[stop.q]);
    sum += 0.5 * stop.stiffness * x * x;
  }
  return sum;
}

double stop_losses(const std::vector<SoftStop>& stops, const RobotState& s) {
  double power = 0;
  for (const SoftStop& stop : stops)
    power += stop.damping * std::abs(stop.depth(s.q[stop.q])) / stop.margin * s.v[stop.v] * s.v[stop.v];
  return power;
}

bool disturbed(const Config& config, const SimulatorInputs& inputs) {
  const Disturbances& planned = config.disturbances;
  if (!planned.pushes.empty() || !planned.payloads.empty() || !planned.stops.empty()) return true;
  for (const auto& [step, actions] : inputs.actions)
    for (const Action& action : actions)
      if (action.verb == "push" || action.verb == "payload") return true;
  return false;
}

}  // namespace

std::vector<RobotState> true_states(const Config& config, std::span<const RobotState> logged,
                                    const SimulatorInputs& inputs) {
  std::vector<RobotState> truth;
  truth.reserve(logged.size());
  State state = initial(config);
  for (const RobotState& seen : logged) {
    const int64_t step_number = static_cast<int64_t>(truth.size());
    if (seen.step != step_number)
      throw std::runtime_error("step " + std::to_string(step_number) +
                               " is not in the log; the true states need every step");
    if (step_number == 0) {
      require_same(seen, sensed(config, state));
    } else {
      const std::vector<Action>* actions = at_step(inputs.actions, step_number);
      const Output out =
          step(config, state,
               {.command = at_step(inputs.commands, step_number),
                .actions = actions ? std::span<const Action>(*actions) : std::span<const Action>()});
      if (out.abort)
        throw std::runtime_error(
            "the log does not follow from its own commands: replayed, the run ends before step " +
            std::to_string(step_number));
      require_same(seen, out.state);
    }
    truth.push_back(state.robot);
    truth.back().time = seen.time;
  }
  return truth;
}

ExternalEnergy external_energy(const Config& config, std::span<const RobotState> states,
                               const SimulatorInputs& inputs) {
  ExternalEnergy out;
  if (!disturbed(config, inputs)) return out;
  for (size_t k = 0; k < states.size(); ++k)
    if (states[k].step != static_cast<int64_t>(k)) return out;
  out.stored.assign(states.size(), 0);
  out.work.assign(states.size(), 0);
  const std::vector<SoftStop>& stops = config.disturbances.stops;
  Load load(config.model);
  FrameView before(config.model), after(config.model);
  std::vector<Event> ignored_events;
  for (size_t k = 0; k < states.size(); ++k) {
    before.set(states[k]);
    const double carried = payload_energy(before, load);
    out.stored[k] = carried + stop_energy(stops, states[k]);
    if (k + 1 == states.size()) break;
    begin_step(config.disturbances, config.model, states[k].step, load, ignored_events);
    if (const auto* actions = at_step(inputs.actions, states[k + 1].step))
      for (const Action& action : *actions)
        if (is_for(action, "simulator") && (action.verb == "push" || action.verb == "payload"))
          take(action, config.model, config.dt, load);
    double& work = out.work[k + 1];
    work = payload_energy(before, load) - carried;
    work -= 0.5 * config.dt * (stop_losses(stops, states[k]) + stop_losses(stops, states[k + 1]));
    if (!load.pushes.empty()) after.set(states[k + 1]);
    for (const Push& push : load.pushes) {
      const Eigen::Vector3d displacement =
          after.pose(push.wrench.frame).translation() - before.pose(push.wrench.frame).translation();
      const Eigen::Vector3d rotation =
          0.5 * config.dt *
          (before.velocity(push.wrench.frame).angular() + after.velocity(push.wrench.frame).angular());
      work += push.wrench.wrench.linear().dot(displacement) + push.wrench.wrench.angular().dot(rotation);
    }
    end_step(load);
    ignored_events.clear();
  }
  return out;
}

}  // namespace lab::simulator
