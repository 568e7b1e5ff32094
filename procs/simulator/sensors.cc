#include "procs/simulator/sensors.h"

#include <algorithm>
#include <cmath>

#include "core/util/number.h"
#include "lab/experiment/joints.h"
#include "procs/simulator/noise.h"

namespace lab::simulator {
namespace {

constexpr int64_t kLongestDelay = 10'000;  // steps that are kept in memory

}  // namespace

Sensors make_sensors(const Experiment& e, const rbd::Model& model) {
  Sensors out;
  out.seed = e.seed;
  out.delay = std::llround(e.simulator.delay / e.simulator.dt);
  if (out.delay > kLongestDelay)
    fail(e, "simulator.delay",
         number(e.simulator.delay) + " s are " + std::to_string(out.delay) + " steps; give at most " +
             std::to_string(kLongestDelay));
  const Eigen::VectorXd q = joint_vector(e, "simulator.noise.q", e.simulator.noise.q, model, 0),
                        v = joint_vector(e, "simulator.noise.v", e.simulator.noise.v, model, 0);
  for (int j = 1; j < model.njoints; ++j) {
    const rbd::JointModel& joint = model.joints[j];
    for (int i = joint.idx_v(); i < joint.idx_v() + joint.nv(); ++i) {
      if (q[i] == 0 && v[i] == 0) continue;
      if (joint.nv() > 1)
        fail(e, q[i] != 0 ? "simulator.noise.q" : "simulator.noise.v",
             "joint '" + model.names[j] +
                 "' has several degrees of freedom and is seen without noise; leave it out or give 0");
      out.noisy.push_back({j, joint.idx_q(), i, q[i], v[i]});
    }
  }
  if (!out.perfect() && e.logger.every != 1)
    fail(e, "logger.every",
         "is " + std::to_string(e.logger.every) +
             ", but with noise or delay the true states can only be found from every step; give 1");
  return out;
}

DelayBuffer::DelayBuffer(const Sensors& sensors, const RobotState& first)
    : ring(static_cast<size_t>(sensors.delay + 1), {first.q, first.v}) {}

void DelayBuffer::keep(const RobotState& truth) {
  Sample& place = ring[static_cast<size_t>(truth.step) % ring.size()];
  place.q = truth.q;
  place.v = truth.v;
}

RobotState sense(const Sensors& sensors, const DelayBuffer& memory, const RobotState& truth) {
  if (sensors.perfect()) return truth;
  const DelayBuffer::Sample& seen =
      memory.ring[static_cast<size_t>(std::max<int64_t>(truth.step - sensors.delay, 0)) % memory.ring.size()];
  RobotState out = truth;
  out.q = seen.q;
  out.v = seen.v;
  for (const Sensors::Noisy& joint : sensors.noisy) {
    out.q[joint.q] +=
        joint.q_deviation * gaussian(sensors.seed, truth.step, joint.joint, NoiseKind::Position);
    out.v[joint.v] +=
        joint.v_deviation * gaussian(sensors.seed, truth.step, joint.joint, NoiseKind::Velocity);
  }
  return out;
}

}  // namespace lab::simulator
