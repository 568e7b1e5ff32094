#include "procs/controller/own_model.h"

#include <algorithm>
#include <string>
#include <vector>

namespace lab::controller {
namespace {

struct Body {
  rbd::JointIndex joint = 0;  // the joint that moves it
  rbd::SE3 placement;         // of its frame in the joint's
  rbd::Inertia inertia;       // in its frame
};

bool has_mass(const rbd::Inertia& inertia) { return inertia.mass() > 0; }

/// The names that are allowed: links with a mass that move, and joints that carry a mass.
std::vector<std::string> bodies(const rbd::Model& model) {
  std::vector<std::string> names;
  for (const rbd::Frame& frame : model.frames)
    if (frame.type == rbd::BODY && frame.parentJoint > 0 && has_mass(frame.inertia))
      names.push_back(frame.name);
  for (int j = 1; j < model.njoints; ++j)
    if (has_mass(model.inertias[j])) names.push_back(model.names[j]);
  return names;
}

Body find_body(const Experiment& e, const std::string& key, const std::string& name,
               const rbd::Model& model) {
  const rbd::FrameIndex link = model.getFrameId(name, rbd::BODY);
  const bool is_link = link < model.nframes;
  if (is_link && has_mass(model.frames[link].inertia)) {
    if (model.frames[link].parentJoint == 0)
      fail(e, key, "'" + name + "' is fixed to the ground; its mass moves nothing");
    return {model.frames[link].parentJoint, model.frames[link].placement, model.frames[link].inertia};
  }
  const rbd::JointIndex joint = model.getJointId(name);
  const bool is_joint = joint > 0 && joint < model.njoints;
  if (is_joint && has_mass(model.inertias[joint]))
    return {joint, rbd::SE3::Identity(), model.inertias[joint]};
  if (is_link || is_joint)
    fail(e, key, "'" + name + "' has no mass of its own; bodies are " + list_of(bodies(model)));
  const std::string near = did_you_mean(name, bodies(model));
  fail(e, key,
       "'" + model.name + "' has no link or joint '" + name + "'" +
           (near.empty() ? "; bodies are " + list_of(bodies(model)) : near));
}

/// `whole` minus a body that is part of it (both in the same axes); zero where only rounding is left.
rbd::Inertia subtract(const rbd::Inertia& whole, const rbd::Inertia& part) {
  if (whole.mass() - part.mass() <= 1e-9 * whole.mass()) return rbd::Inertia::Zero();
  return whole + part * -1;
}

}  // namespace

rbd::Model own_model(const Experiment& e, const rbd::Model& nominal) {
  const Experiment::Controller::OwnModel& errors = e.controller.model;
  rbd::Model model = nominal;
  for (size_t i = 0; i < errors.without.size(); ++i) {
    const std::string key = "controller.model.without[" + std::to_string(i) + "]";
    for (size_t before = 0; before < i; ++before)
      if (errors.without[before] == errors.without[i])
        fail(e, key, "'" + errors.without[i] + "' is given twice");
    const Body body = find_body(e, key, errors.without[i], nominal);
    model.setInertia(body.joint, subtract(model.inertias[body.joint], body.placement.act(body.inertia)));
  }
  for (const auto& [name, shift] : errors.com_shift) {
    const std::string key = "controller.model.com_shift." + name;
    const Body body = find_body(e, key, name, model);
    const bool named = std::find(errors.without.begin(), errors.without.end(), name) != errors.without.end();
    if (named ||
        model.inertias[body.joint].mass() < (1 - 1e-9) * body.inertia.mass())  // itself, or its joint
      fail(e, key, "is taken away by controller.model.without; keep one of them");
    const Eigen::Vector3d by(shift[0], shift[1], shift[2]);
    const rbd::Inertia moved(body.inertia.mass(), body.inertia.lever() + by, body.inertia.inertia());
    model.setInertia(body.joint, subtract(model.inertias[body.joint], body.placement.act(body.inertia)) +
                                     body.placement.act(moved));
  }
  if (errors.mass_scale != 1)
    for (int j = 0; j < model.njoints; ++j) model.setInertia(j, model.inertias[j] * errors.mass_scale);
  return model;
}

}  // namespace lab::controller
