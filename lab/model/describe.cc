#include "lab/model/describe.h"

#include <fmt/format.h>
#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

#include "core/util/printable.h"

namespace lab::model {
namespace {

using nlohmann::ordered_json;

ordered_json numbers(const Eigen::VectorXd& all, int from, int n) {
  ordered_json out = ordered_json::array();
  for (int k = from; k < from + n; ++k) {
    if (std::isfinite(all[k]))
      out.push_back(all[k]);
    else
      out.push_back(nullptr);
  }
  return out;
}

ordered_json vector(const Eigen::Vector3d& x) { return {x[0], x[1], x[2]}; }

ordered_json joint_json(const rbd::Model& model, rbd::JointIndex j) {
  const rbd::JointModel& joint = model.joints[j];
  const int q = joint.idx_q(), nq = joint.nq(), v = joint.idx_v(), nv = joint.nv();
  ordered_json out{{"name", model.names[j]},
                   {"kind", joint.shortname()},
                   {"parent", model.names[model.parents[j]]},
                   {"nq", nq},
                   {"nv", nv},
                   {"idx_q", q},
                   {"idx_v", v},
                   {"mass", model.inertias[j].mass()}};
  if (!joint.axis().isZero()) out["axis"] = vector(joint.axis());
  if (joint.mimics()) {
    const rbd::Mimic& mimic = model.mimic(j);
    out["mimic"] = {
        {"joint", model.names[mimic.leader]}, {"multiplier", mimic.multiplier}, {"offset", mimic.offset}};
    return out;
  }
  out["position"] = {{"lower", numbers(model.lowerPositionLimit, q, nq)},
                     {"upper", numbers(model.upperPositionLimit, q, nq)}};
  out["velocity"] = {{"lower", numbers(model.lowerVelocityLimit, v, nv)},
                     {"upper", numbers(model.upperVelocityLimit, v, nv)}};
  out["effort"] = {{"lower", numbers(model.lowerEffortLimit, v, nv)},
                   {"upper", numbers(model.upperEffortLimit, v, nv)}};
  out["armature"] = numbers(model.armature, v, nv);
  out["damping"] = numbers(model.damping, v, nv);
  out["friction"] = numbers(model.friction, v, nv);
  return out;
}

/// Rows of words, each column as wide as its widest word; a column is left- or right-aligned.
class Table {
 public:
  /// Heads that start with '>' stand on the right, with their numbers.
  explicit Table(std::vector<std::string> heads) {
    for (std::string& head : heads) {
      right_.push_back(head.starts_with('>'));
      if (right_.back()) head.erase(0, 1);
    }
    add(std::move(heads));
  }
  void add(std::vector<std::string> row) {
    widths_.resize(row.size());
    for (size_t k = 0; k < row.size(); ++k) widths_[k] = std::max(widths_[k], row[k].size());
    rows_.push_back(std::move(row));
  }
  std::string text() const {
    std::string out;
    for (const auto& row : rows_) {
      std::string line;
      for (size_t k = 0; k < row.size(); ++k)
        line += right_[k] ? fmt::format("{:>{}}  ", row[k], widths_[k])
                          : fmt::format("{:<{}}  ", row[k], widths_[k]);
      line.erase(line.find_last_not_of(' ') + 1);
      out += line + "\n";
    }
    return out;
  }

 private:
  std::vector<bool> right_;
  std::vector<size_t> widths_;
  std::vector<std::vector<std::string>> rows_;
};

/// A limit; joints with several dofs show one number where all are alike.
std::string limit(const Eigen::VectorXd& all, int from, int n) {
  if (n == 0) return "";
  for (int k = from + 1; k < from + n; ++k)
    if (all[k] != all[from]) return "..";
  return std::isfinite(all[from]) ? fmt::format("{:.4g}", all[from]) : "-";
}

/// Where the numbers of a joint stand: "3", or "0-6".
std::string places(int from, int n) {
  return n == 0 ? "" : n == 1 ? fmt::format("{}", from) : fmt::format("{}-{}", from, from + n - 1);
}

}  // namespace

double mass_of(const rbd::Model& model) {
  double mass = 0;
  for (int j = 1; j < model.njoints; ++j) mass += model.inertias[j].mass();
  return mass;
}

std::string kind_of(const rbd::Model& model, rbd::JointIndex j) {
  std::string text = model.joints[j].shortname();
  if (!model.joints[j].mimics()) return text;
  const rbd::Mimic& mimic = model.mimic(j);
  text += fmt::format(" = {:.4g} {}", mimic.multiplier, printable_name(model.names[mimic.leader]));
  if (mimic.offset != 0)
    text += fmt::format(" {} {:.4g}", mimic.offset < 0 ? '-' : '+', std::abs(mimic.offset));
  return text;
}

ordered_json to_json(const rbd::urdf::Diagnostic& d) {
  static constexpr const char* kSeverities[] = {"note", "warning", "error"};
  return {{"severity", kSeverities[static_cast<int>(d.severity)]},
          {"file", d.file},
          {"line", d.line},
          {"element", d.element},
          {"message", d.message},
          {"text", d.text()}};
}

ordered_json info_json(const Robot& robot) {
  const rbd::Model& model = robot.model;
  ordered_json joints = ordered_json::array(), frames = ordered_json::array(), said = ordered_json::array();
  for (int j = 1; j < model.njoints; ++j) joints.push_back(joint_json(model, j));
  for (const rbd::Frame& f : model.frames) {
    frames.push_back({{"name", f.name},
                      {"type", rbd::frameTypeName(f.type)},
                      {"joint", model.names[f.parentJoint]},
                      {"parent", model.frames[f.parentFrame].name},
                      {"mass", f.inertia.mass()}});
  }
  for (const rbd::urdf::Diagnostic& d : robot.diagnostics) said.push_back(to_json(d));
  return {{"name", model.name}, {"file", robot.file},     {"nq", model.nq},
          {"nv", model.nv},     {"mass", mass_of(model)}, {"gravity", vector(model.gravity.linear())},
          {"joints", joints},   {"frames", frames},       {"diagnostics", said}};
}

std::string info_text(const Robot& robot) {
  const rbd::Model& model = robot.model;
  const Eigen::Vector3d& g = model.gravity.linear();
  std::string out = fmt::format(
      "{}  ({})\nnq {}, nv {}, {} joints, {} frames, {:.6g} kg that move, gravity {:g} {:g} {:g}\n\n",
      printable_name(model.name), robot.file, model.nq, model.nv, model.njoints - 1, model.nframes,
      mass_of(model), g[0], g[1], g[2]);
  Table joints({"joint", "kind", ">q", ">v", ">lower", ">upper", ">speed", ">effort", ">kg"});
  for (int j = 1; j < model.njoints; ++j) {
    const rbd::JointModel& joint = model.joints[j];
    const int q = joint.idx_q(), nq = joint.nq(), v = joint.idx_v(), nv = joint.nv();
    joints.add({printable_name(model.names[j]), kind_of(model, j), places(q, nq), places(v, nv),
                limit(model.lowerPositionLimit, q, nq), limit(model.upperPositionLimit, q, nq),
                limit(model.upperVelocityLimit, v, nv), limit(model.upperEffortLimit, v, nv),
                fmt::format("{:.4g}", model.inertias[j].mass())});
  }
  Table frames({"frame", "type", "moves with", ">kg"});
  for (const rbd::Frame& f : model.frames) {
    frames.add({printable_name(f.name), rbd::frameTypeName(f.type),
                printable_name(model.names[f.parentJoint]),
                f.inertia.mass() > 0 ? fmt::format("{:.4g}", f.inertia.mass()) : ""});
  }
  return out + joints.text() +
         "(rad, m, rad/s, m/s, Nm, N; kg: all that moves with the joint alone; -: no limit)\n\n" +
         frames.text();
}

}  // namespace lab::model
