#include "procs/simulator/replay.h"

#include <rbd/algorithm/kinematics.h>

#include <algorithm>
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

bool is_push_or_payload(const Action& action) {
  return is_for(action, "simulator") && (action.verb == "push" || action.verb == "payload");
}

}  // namespace

RobotState TrueStates::next(const RobotState& logged, const Command* command,
                            std::span<const Action> actions) {
  const int64_t step_number = next_step_++;
  if (logged.step != step_number)
    throw std::runtime_error("step " + std::to_string(step_number) +
                             " is not in the log; the true states need every step");
  if (step_number == 0) {
    require_same(logged, sensed(config_, state_));
  } else {
    const Output out = step(config_, state_, {.command = command, .actions = actions});
    if (out.abort)
      throw std::runtime_error(
          "the log does not follow from its own commands: replayed, the run ends before step " +
          std::to_string(step_number));
    require_same(logged, out.state);
  }
  RobotState truth = state_.robot;
  truth.time = logged.time;
  return truth;
}

void ExternalEnergy::FrameView::set(const RobotState& s) { rbd::forwardKinematics(model, data, s.q, s.v); }

const rbd::SE3& ExternalEnergy::FrameView::pose(rbd::FrameIndex frame) {
  return rbd::updateFramePlacement(model, data, frame);
}

rbd::Motion ExternalEnergy::FrameView::velocity(rbd::FrameIndex frame) {
  return rbd::getFrameVelocity(model, data, frame, rbd::LOCAL_WORLD_ALIGNED);
}

double ExternalEnergy::payload_energy(FrameView& now, const Load& load) {
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

ExternalEnergy::ExternalEnergy(const Config& config)
    : config_(config), load_(config.model), before_(config.model), after_(config.model) {
  const Disturbances& planned = config.disturbances;
  disturbed_ = !planned.pushes.empty() || !planned.payloads.empty() || !planned.stops.empty();
}

ExternalEnergy::Step ExternalEnergy::next(const RobotState& state, std::span<const Action> actions) {
  if (state.step != next_step_) return {};
  ++next_step_;
  if (!disturbed_ && std::any_of(actions.begin(), actions.end(), is_push_or_payload)) {
    disturbed_ = true;
    if (state.step > 0) before_.set(last_);
  }
  Step out;
  if (disturbed_) {
    if (state.step > 0) out.work = work_to(state, actions);
    before_.set(state);
    out.stored = payload_energy(before_, load_) + stop_energy(config_.disturbances.stops, state);
  }
  last_ = state;
  return out;
}

double ExternalEnergy::work_to(const RobotState& state, std::span<const Action> actions) {
  const std::vector<SoftStop>& stops = config_.disturbances.stops;
  std::vector<Event> ignored_events;
  const double carried = payload_energy(before_, load_);
  begin_step(config_.disturbances, config_.model, last_.step, load_, ignored_events);
  for (const Action& action : actions)
    if (is_push_or_payload(action)) take(action, config_.model, config_.dt, load_);
  double work = payload_energy(before_, load_) - carried;
  work -= 0.5 * config_.dt * (stop_losses(stops, last_) + stop_losses(stops, state));
  if (!load_.pushes.empty()) after_.set(state);
  for (const Push& push : load_.pushes) {
    const Eigen::Vector3d displacement =
        after_.pose(push.wrench.frame).translation() - before_.pose(push.wrench.frame).translation();
    const Eigen::Vector3d rotation =
        0.5 * config_.dt *
        (before_.velocity(push.wrench.frame).angular() + after_.velocity(push.wrench.frame).angular());
    work += push.wrench.wrench.linear().dot(displacement) + push.wrench.wrench.angular().dot(rotation);
  }
  end_step(load_);
  return work;
}

}  // namespace lab::simulator
