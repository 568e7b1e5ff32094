#include "procs/simulator/ledger.h"

#include <rbd/algorithm/kinematics.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "core/util/number.h"
#include "lab/experiment/actions.h"
#include "lab/experiment/joints.h"

namespace lab::simulator {
namespace {

/// Where two vectors differ in a bit; -1 = nowhere.
Eigen::Index difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (a.size() != b.size()) return 0;
  for (Eigen::Index i = 0; i < a.size(); ++i)
    if (std::memcmp(&a[i], &b[i], sizeof(double)) != 0) return i;
  return -1;
}

void require_same(const RobotState& logged, const RobotState& folded) {
  const std::pair<const char*, Eigen::VectorXd RobotState::*> parts[] = {
      {"q", &RobotState::q}, {"v", &RobotState::v}, {"tau", &RobotState::tau}};
  for (const auto& [name, part] : parts)
    if (const Eigen::Index i = difference(logged.*part, folded.*part); i >= 0)
      throw std::runtime_error("the log does not follow from its own commands: at step " +
                               std::to_string(logged.step) + " " + name + "[" + std::to_string(i) + "] is " +
                               number((logged.*part)[i]) + ", folded " + number((folded.*part)[i]) +
                               "; was it made by another version, or on another kind of CPU?");
}

template <class Map>
auto at_step(const Map& map, int64_t step) {
  const auto found = map.find(step);
  return found == map.end() ? nullptr : &found->second;
}

/// Poses and velocities of one state, for the frames that are asked for.
struct View {
  const rbd::Model& model;
  rbd::Data data;
  explicit View(const rbd::Model& m) : model(m), data(m) {}
  void look(const RobotState& s) { rbd::forwardKinematics(model, data, s.q, s.v); }
  const rbd::SE3& pose(rbd::FrameIndex frame) { return rbd::updateFramePlacement(model, data, frame); }
  rbd::Motion velocity(rbd::FrameIndex frame) {
    return rbd::getFrameVelocity(model, data, frame, rbd::LOCAL_WORLD_ALIGNED);
  }
};

double energy_carried(View& now, const Load& load) {
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

double energy_in_stops(const std::vector<SoftStop>& stops, const RobotState& s) {
  double sum = 0;
  for (const SoftStop& stop : stops) {
    const double x = stop.depth(s.q[stop.q]);
    sum += 0.5 * stop.stiffness * x * x;
  }
  return sum;
}

double lost_in_stops(const std::vector<SoftStop>& stops, const RobotState& s) {
  double power = 0;
  for (const SoftStop& stop : stops)
    power += stop.damping * std::abs(stop.depth(s.q[stop.q])) / stop.margin * s.v[stop.v] * s.v[stop.v];
  return power;
}

bool disturbed(const Config& config, const Told& told) {
  const Disturbances& planned = config.disturbances;
  if (!planned.pushes.empty() || !planned.payloads.empty() || !planned.stops.empty()) return true;
  for (const auto& [step, actions] : told.actions)
    for (const Action& action : actions)
      if (action.verb == "push" || action.verb == "payload") return true;
  return false;
}

}  // namespace

std::vector<RobotState> true_states(const Config& config, std::span<const RobotState> logged,
                                    const Told& told) {
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
      const std::vector<Action>* actions = at_step(told.actions, step_number);
      const Output out =
          step(config, state,
               {.command = at_step(told.commands, step_number),
                .actions = actions ? std::span<const Action>(*actions) : std::span<const Action>()});
      if (out.abort)
        throw std::runtime_error(
            "the log does not follow from its own commands: folded, the run ends before step " +
            std::to_string(step_number));
      require_same(seen, out.state);
    }
    truth.push_back(state.robot);
    truth.back().time = seen.time;
  }
  return truth;
}

Ledger ledger(const Config& config, std::span<const RobotState> states, const Told& told) {
  Ledger out;
  if (!disturbed(config, told)) return out;
  for (size_t k = 0; k < states.size(); ++k)
    if (states[k].step != static_cast<int64_t>(k)) return out;
  out.stored.assign(states.size(), 0), out.work.assign(states.size(), 0);
  const std::vector<SoftStop>& stops = config.disturbances.stops;
  Load load(config.model);
  View before(config.model), after(config.model);
  std::vector<Event> unsaid;
  for (size_t k = 0; k < states.size(); ++k) {
    before.look(states[k]);
    const double carried = energy_carried(before, load);
    out.stored[k] = carried + energy_in_stops(stops, states[k]);
    if (k + 1 == states.size()) break;
    begin_step(config.disturbances, config.model, states[k].step, load, unsaid);
    if (const auto* actions = at_step(told.actions, states[k + 1].step))
      for (const Action& action : *actions)
        if (is_for(action, "simulator") && (action.verb == "push" || action.verb == "payload"))
          take(action, config.model, config.dt, load);
    double& work = out.work[k + 1];
    work = energy_carried(before, load) - carried;
    work -= 0.5 * config.dt * (lost_in_stops(stops, states[k]) + lost_in_stops(stops, states[k + 1]));
    if (!load.pushes.empty()) after.look(states[k + 1]);
    for (const Push& push : load.pushes) {
      const Eigen::Vector3d way =
          after.pose(push.frame).translation() - before.pose(push.frame).translation();
      const Eigen::Vector3d turn =
          0.5 * config.dt * (before.velocity(push.frame).angular() + after.velocity(push.frame).angular());
      work += push.wrench.tail<3>().dot(way) + push.wrench.head<3>().dot(turn);
    }
    end_step(load);
    unsaid.clear();
  }
  return out;
}

}  // namespace lab::simulator
