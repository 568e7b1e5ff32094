#include "procs/simulator/disturbances.h"

#include <algorithm>
#include <cmath>

#include "core/util/number.h"
#include "lab/experiment/actions.h"
#include "lab/experiment/joints.h"

namespace lab::simulator {
namespace {

template <class T>
void sort_by_time(std::vector<T>& planned) {
  std::stable_sort(planned.begin(), planned.end(), [](const T& a, const T& b) { return a.from < b.from; });
}

std::vector<SoftStop> make_stops(const Experiment& e, const rbd::Model& model) {
  const auto& wanted = e.simulator.limit_repulsion;
  const std::string key = "simulator.limit_repulsion";
  const Eigen::VectorXd stiffness = joint_vector(e, key + ".stiffness", wanted.stiffness, model, 0),
                        damping = joint_vector(e, key + ".damping", wanted.damping, model, 0),
                        margin = joint_vector(e, key + ".margin", wanted.margin, model, 0.1);
  std::vector<SoftStop> stops;
  for (int j = 1; j < model.njoints; ++j) {
    const rbd::JointModel& joint = model.joints[j];
    const int q = joint.idx_q(), v = joint.idx_v();
    if (joint.nv() != 1) continue;
    if (damping[v] > 0 && stiffness[v] == 0)
      fail(e, key + ".damping",
           "joint '" + model.names[j] + "' has a damper but no spring; give stiffness too");
    if (stiffness[v] == 0) continue;
    const double low = model.lowerPositionLimit[q], high = model.upperPositionLimit[q];
    if (!std::isfinite(low) && !std::isfinite(high)) continue;
    if (!(margin[v] > 0))
      fail(e, key + ".margin",
           "is 0 for joint '" + model.names[j] + "'; the spring needs some distance, for example 0.1");
    if (2 * margin[v] > high - low)
      fail(e, key + ".margin",
           number(margin[v]) + " is more than half of the way that joint '" + model.names[j] + "' has (" +
               number(low) + " .. " + number(high) + ")");
    stops.push_back({q, v, low + margin[v], high - margin[v], margin[v], stiffness[v], damping[v]});
  }
  return stops;
}

/// [x, y, z]
std::string text(const Eigen::Vector3d& x) {
  return "[" + number(x[0]) + ", " + number(x[1]) + ", " + number(x[2]) + "]";
}

/// Replaces the payload of its frame.
void set_payload(const rbd::Model& nominal, const Payload& payload, Load& load) {
  std::erase_if(load.payloads, [&](const Payload& other) { return other.frame == payload.frame; });
  if (payload.mass > 0) load.payloads.push_back(payload);
  const rbd::JointIndex joint = nominal.frames[payload.frame].parentJoint;
  rbd::Inertia inertia = nominal.inertias[joint];
  for (const Payload& other : load.payloads) {
    const rbd::Frame& frame = nominal.frames[other.frame];
    if (frame.parentJoint == joint)
      inertia += rbd::Inertia(other.mass, frame.placement.act(other.com), Eigen::Matrix3d::Zero());
  }
  load.model.setInertia(joint, inertia);
}

}  // namespace

Push make_push(rbd::FrameIndex frame, const Eigen::Vector3d& torque, const Eigen::Vector3d& force,
               int64_t steps) {
  return {{frame, rbd::Force(torque, force), rbd::LOCAL_WORLD_ALIGNED}, steps};
}

Disturbances make_disturbances(const Experiment& e, const rbd::Model& model) {
  Disturbances out;
  const double dt = e.simulator.dt;
  const auto frame_of = [&](const std::string& key, const std::string& name) {
    if (const std::string fault = frame_fault(model, name); !fault.empty()) fail(e, key + ".frame", fault);
    return model.frameId(name);
  };
  for (size_t i = 0; i < e.simulator.pushes.size(); ++i) {
    const PlannedPush& push = e.simulator.pushes[i];
    const std::string key = "simulator.pushes[" + std::to_string(i) + "]";
    const auto vector = [](const std::array<double, 3>& x) { return Eigen::Vector3d(x[0], x[1], x[2]); };
    const Push what = make_push(frame_of(key, push.frame), vector(push.torque), vector(push.force),
                                std::llround(push.duration / dt));
    if (what.steps < 1)
      fail(e, key + ".duration", number(push.duration) + " s is less than one step of " + number(dt) + " s");
    out.pushes.push_back({std::llround(push.time / dt), what});
  }
  for (size_t i = 0; i < e.simulator.payloads.size(); ++i) {
    const PlannedPayload& payload = e.simulator.payloads[i];
    const std::string key = "simulator.payloads[" + std::to_string(i) + "]";
    out.payloads.push_back(
        {std::llround(payload.time / dt),
         {frame_of(key, payload.frame), payload.mass, {payload.com[0], payload.com[1], payload.com[2]}}});
  }
  sort_by_time(out.pushes);
  sort_by_time(out.payloads);
  out.stops = make_stops(e, model);
  return out;
}

void begin_step(const Disturbances& planned, const rbd::Model& nominal, int64_t step, Load& load,
                std::vector<Event>& events) {
  for (; load.next_push < planned.pushes.size() && planned.pushes[load.next_push].from == step;
       ++load.next_push) {
    const Push& push = planned.pushes[load.next_push].what;
    load.pushes.push_back(push);
    const auto& [frame, wrench, reference] = push.wrench;
    events.push_back({"push", nominal.frames[frame].name,
                      "force " + text(wrench.linear()) + " N, torque " + text(wrench.angular()) + " Nm for " +
                          std::to_string(push.steps) + " steps"});
  }
  for (; load.next_payload < planned.payloads.size() && planned.payloads[load.next_payload].from == step;
       ++load.next_payload) {
    const Payload& payload = planned.payloads[load.next_payload].what;
    set_payload(nominal, payload, load);
    events.push_back({"payload", nominal.frames[payload.frame].name,
                      number(payload.mass) + " kg at " + text(payload.com) + " m"});
  }
}

std::string take(const Action& action, const rbd::Model& nominal, double dt, Load& load) {
  const auto& x = action.values;
  for (double value : x)
    if (!std::isfinite(value)) return "a value is not finite";
  if (action.verb == "payload") {
    if (std::string fault = payload_fault(nominal, action); !fault.empty()) return fault;
    set_payload(nominal, {nominal.frameId(action.target), x[0], {x[1], x[2], x[3]}}, load);
    return "";
  }
  if (std::string fault = push_fault(nominal, action); !fault.empty()) return fault;
  const Push push = make_push(nominal.frameId(action.target), {x[0], x[1], x[2]}, {x[3], x[4], x[5]},
                              std::llround(x[6] / dt));
  if (push.steps > 0) load.pushes.push_back(push);
  return "";
}

void end_step(Load& load) {
  std::erase_if(load.pushes, [](Push& push) { return --push.steps <= 0; });
}

void add_stops(const std::vector<SoftStop>& stops, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
               Eigen::VectorXd& effort) {
  for (const SoftStop& stop : stops)
    if (const double x = stop.depth(q[stop.q]); x != 0)
      effort[stop.v] -= stop.stiffness * x + stop.damping * std::abs(x) / stop.margin * v[stop.v];
}

}  // namespace lab::simulator
