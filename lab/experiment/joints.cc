#include "lab/experiment/joints.h"

#include <algorithm>
#include <cmath>

#include "core/util/number.h"

namespace lab {
namespace {

/// Calls put(joint, value) for what is given; a list of out.size() numbers is taken as the whole vector.
template <class Put>
void spread(const Experiment& e, const std::string& key, const JointValues& values, const rbd::Model& model,
            Eigen::VectorXd& out, Put put) {
  std::vector<int> joints;  // those with one degree of freedom, in model order
  std::vector<std::string> names;
  for (int j = 1; j < model.njoints; ++j)
    if (model.joints[j].nv() == 1) {
      joints.push_back(j);
      names.push_back(model.names[j]);
    }

  if (const auto* one = std::get_if<double>(&values.value)) {
    for (int j : joints) put(j, *one);
  } else if (const auto* list = std::get_if<std::vector<double>>(&values.value)) {
    if (list->size() == joints.size()) {
      for (size_t i = 0; i < joints.size(); ++i) put(joints[i], (*list)[i]);
    } else if (static_cast<Eigen::Index>(list->size()) == out.size()) {
      for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = (*list)[i];
    } else {
      fail(e, key,
           "has " + std::to_string(list->size()) + " numbers, but '" + model.name + "' has " +
               std::to_string(joints.size()) + " joints (" + list_of(names) + ")");
    }
  } else if (const auto* named = std::get_if<JointValues::Named>(&values.value)) {
    for (const auto& [name, value] : *named) {
      if (const std::string fault = joint_fault(model, name); !fault.empty())
        fail(e, key + "." + name, fault);
      put(model.getJointId(name), value);
    }
  }
}

}  // namespace

Eigen::VectorXd joint_vector(const Experiment& e, const std::string& key, const JointValues& values,
                             const rbd::Model& model, const Eigen::VectorXd& fallback) {
  Eigen::VectorXd out = fallback;
  spread(e, key, values, model, out, [&](int j, double value) { out[model.joints[j].idx_v()] = value; });
  return out;
}

Eigen::VectorXd joint_vector(const Experiment& e, const std::string& key, const JointValues& values,
                             const rbd::Model& model, double fallback) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(model.nv);
  for (int j = 1; j < model.njoints; ++j)
    if (model.joints[j].nv() == 1) all[model.joints[j].idx_v()] = fallback;
  return joint_vector(e, key, values, model, all);
}

Eigen::VectorXd configuration(const Experiment& e, const std::string& key, const JointValues& values,
                              const rbd::Model& model, const Eigen::VectorXd& fallback) {
  Eigen::VectorXd q = fallback;
  spread(e, key, values, model, q, [&](int j, double value) { q[model.joints[j].idx_q()] = value; });
  for (int j = 1; j < model.njoints; ++j) {
    const int at = model.joints[j].idx_q();
    if (const rbd::UnitPart unit = model.joints[j].unit_part(); unit.size > 0) {
      double length = 0;
      for (int i = unit.at; i < unit.at + unit.size; ++i) length += q[i] * q[i];
      length = std::sqrt(length);
      if (!(std::abs(length - 1) < 1e-6))
        fail(e, key,
             std::string("the ") + unit.name + " of joint '" + model.names[j] + "' has length " +
                 number(length) + "; it must be 1");
      for (int i = unit.at; i < unit.at + unit.size; ++i) q[i] /= length;
    }
    if (model.joints[j].nq() != 1) continue;
    const double low = model.lowerPositionLimit[at], high = model.upperPositionLimit[at];
    if (q[at] < low || q[at] > high)
      fail(e, key,
           "joint '" + model.names[j] + "' cannot be at " + number(q[at]) + "; its limits are " +
               number(low) + " .. " + number(high));
  }
  return q;
}

std::string joint_fault(const rbd::Model& model, const std::string& name) {
  const rbd::JointIndex joint = model.getJointId(name);
  if (joint > 0 && joint < model.njoints) {
    if (model.joints[joint].nv() == 1) return "";
    rbd::JointIndex leader = joint;
    while (model.mimic(leader).leader >= 0) leader = model.mimic(leader).leader;
    if (leader != joint)
      return "'" + name + "' follows '" + model.names[leader] + "' and has no number of its own; name '" +
             model.names[leader] + "'";
    return "'" + name + "' is a " + model.joints[joint].shortname() +
           "; only joints of one degree of freedom can be named";
  }
  std::vector<std::string> names;
  for (int j = 1; j < model.njoints; ++j)
    if (model.joints[j].nv() == 1) names.push_back(model.names[j]);
  const std::string near = did_you_mean(name, names);
  return "'" + model.name + "' has no such joint" + (near.empty() ? "; it has " + list_of(names) : near);
}

namespace {
std::string no_frame(const rbd::Model& model, const std::string& name) {
  std::vector<std::string> names;
  for (const rbd::Frame& frame : model.frames) names.push_back(frame.name);
  return "no frame '" + name + "'" + did_you_mean(name, names);
}
}  // namespace

rbd::FrameIndex named_frame(const Experiment& experiment, const std::string& key, const std::string& name,
                            const rbd::Model& model) {
  if (!model.existFrame(name)) fail(experiment, key, no_frame(model, name));
  return model.frameId(name);
}

std::string frame_fault(const rbd::Model& model, const std::string& name) {
  if (!model.existFrame(name)) return no_frame(model, name);
  return model.frames[model.frameId(name)].parentJoint > 0
             ? ""
             : "frame '" + name + "' stands on the ground; name one that moves";
}

const std::string& joint_at(const rbd::Model& model, int i) {
  for (int j = 1; j < model.njoints; ++j)
    if (model.joints[j].idx_v() <= i && i < model.joints[j].idx_v() + model.joints[j].nv())
      return model.names[j];
  return model.names[0];
}

void clamp_effort(const rbd::Model& model, const char* what, Eigen::VectorXd& tau, std::vector<bool>& cut,
                  std::vector<Event>& events) {
  for (int j = 1; j < model.njoints; ++j) {
    const rbd::JointModel& joint = model.joints[j];
    const bool driven = joint.nv() == 1;
    for (int i = joint.idx_v(); i < joint.idx_v() + joint.nv(); ++i) {
      const double lower = driven ? model.lowerEffortLimit[i] : 0,
                   upper = driven ? model.upperEffortLimit[i] : 0, wanted = tau[i];
      const bool outside = wanted < lower || wanted > upper;
      tau[i] = std::clamp(wanted, lower, upper);
      if (outside && !cut[i])
        events.push_back({driven ? what : "base_effort_ignored", model.names[j],
                          "value " + number(wanted) + ", bound " + number(tau[i])});
      cut[i] = outside;
    }
  }
}

bool floats(const rbd::Model& model) {
  for (const rbd::JointModel& joint : model.joints)
    if (joint.nv() > 1) return true;
  return false;
}

}  // namespace lab
