#include "lab/model/tree.h"

#include <fmt/format.h>
#include <rbd/rbd.h>

#include <functional>
#include <vector>

#include "core/util/printable.h"
#include "lab/model/describe.h"

namespace lab::model {
namespace {

using Children = std::vector<std::vector<rbd::FrameIndex>>;

Children children_of(const rbd::Model& model) {
  Children out(static_cast<size_t>(model.nframes));
  for (rbd::FrameIndex f = 1; f < model.nframes; ++f)
    out[static_cast<size_t>(model.frames[f].parentFrame)].push_back(f);
  return out;
}

bool is_joint(const rbd::Frame& frame) { return frame.type == rbd::JOINT || frame.type == rbd::FIXED_JOINT; }

/// The link at the far end of a joint: the first one, if it stands where the joint does. 0: there is none.
rbd::FrameIndex link_of(const rbd::Model& model, const Children& children, rbd::FrameIndex joint) {
  for (rbd::FrameIndex f : children[static_cast<size_t>(joint)]) {
    const rbd::Frame& frame = model.frames[f];
    if (frame.type == rbd::BODY) return frame.placement.isApprox(model.frames[joint].placement) ? f : 0;
  }
  return 0;
}

std::string label(const rbd::Model& model, const rbd::Frame& frame) {
  std::string text = printable_name(frame.name);
  if (frame.type == rbd::JOINT) text += " " + kind_of(model, frame.parentJoint);
  if (frame.type == rbd::FIXED_JOINT && frame.name != "universe") text += " fixed";
  if (frame.type == rbd::OP_FRAME) text += " (frame)";
  if (frame.type == rbd::SENSOR) text += " (sensor)";
  if (frame.inertia.mass() > 0) text += fmt::format(" {:.4g} kg", frame.inertia.mass());
  return text;
}

/// What moves with a joint when no link owns it: bodies that a program welded to the joint itself.
std::string unowned(const rbd::Model& model, rbd::JointIndex joint) {
  double mass = model.inertias[joint].mass();
  for (const rbd::Frame& f : model.frames)
    if (f.parentJoint == joint) mass -= f.inertia.mass();
  return mass > 1e-9 * model.inertias[joint].mass() ? fmt::format(" {:.4g} kg", mass) : "";
}

}  // namespace

std::string tree_text(const rbd::Model& model) {
  const Children children = children_of(model);
  std::string out = fmt::format("{}  nq {}, nv {}, {:.6g} kg that move\n", printable_name(model.name),
                                model.nq, model.nv, mass_of(model));
  const std::function<void(rbd::FrameIndex, const std::string&)> show = [&](rbd::FrameIndex f,
                                                                            const std::string& indent) {
    const rbd::Frame& frame = model.frames[f];
    std::string line = label(model, frame);
    if (frame.type == rbd::JOINT || f == 0) line += unowned(model, frame.parentJoint);
    std::vector<rbd::FrameIndex> below = children[static_cast<size_t>(f)];
    if (const rbd::FrameIndex link = is_joint(frame) ? link_of(model, children, f) : 0; link > 0) {
      line += " > " + label(model, model.frames[link]);
      std::erase(below, link);
      const auto& own = children[static_cast<size_t>(link)];
      below.insert(below.begin(), own.begin(), own.end());
    }
    out += line + "\n";
    for (size_t k = 0; k < below.size(); ++k) {
      const bool last = k + 1 == below.size();
      out += indent + (last ? "└─ " : "├─ ");
      show(below[k], indent + (last ? "   " : "│  "));
    }
  };
  show(0, "");
  return out;
}

nlohmann::ordered_json tree_json(const rbd::Model& model) {
  const Children children = children_of(model);
  const std::function<nlohmann::ordered_json(rbd::FrameIndex)> node = [&](rbd::FrameIndex f) {
    const rbd::Frame& frame = model.frames[f];
    nlohmann::ordered_json out{{"name", frame.name}, {"type", rbd::frameTypeName(frame.type)}};
    if (frame.type == rbd::JOINT) out["kind"] = kind_of(model, frame.parentJoint);
    if (frame.type == rbd::BODY) out["mass"] = frame.inertia.mass();
    out["children"] = nlohmann::ordered_json::array();
    for (rbd::FrameIndex child : children[static_cast<size_t>(f)]) out["children"].push_back(node(child));
    return out;
  };
  return node(0);
}

}  // namespace lab::model
