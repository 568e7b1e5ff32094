#include "rbd/urdf/write.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <vector>

#include "rbd/spatial/so3.h"
#include "rbd/urdf/urdf.h"
#include "rbd/urdf/xml.h"

namespace rbd::urdf {
namespace {

[[noreturn]] void refuse(const std::string& who, const std::string& why) {
  throw std::invalid_argument("writeModel: " + who + ": " + why);
}

// The shortest text that reads back as the same number; "no limit" as the largest one.
std::string number(double value) {
  if (std::isinf(value)) value = std::copysign(std::numeric_limits<double>::max(), value);
  return exactly(value);
}

// NAME="text", with a blank before it.
std::string attribute(const char* name, const std::string& text) {
  std::string out = std::string(" ") + name + "=\"";
  for (const char c : text) {
    if (c == '&' || c == '<' || c == '>' || c == '"') {
      out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : "&quot;";
    } else if (static_cast<unsigned char>(c) < ' ') {
      out += "&#" + std::to_string(c) + ";";
    } else {
      out += c;
    }
  }
  return out + "\"";
}
std::string attribute(const char* name, double value) { return attribute(name, number(value)); }
std::string attribute(const char* name, const Eigen::Vector3d& v) {
  return attribute(name, number(v[0]) + " " + number(v[1]) + " " + number(v[2]));
}

std::string origin(const SE3& pose) {
  const bool turned = !pose.rotation().isIdentity(0);
  if (!turned && pose.translation().isZero(0)) return "";
  return "    <origin" + attribute("xyz", pose.translation()) +
         (turned ? attribute("rpy", matrixToRpy(pose.rotation())) : "") + "/>\n";
}

bool is_zero(const Inertia& body) { return body.mass() == 0 && body.inertia().isZero(0); }

const char* type_of(JointKind kind) {
  switch (kind) {
    case JointKind::Revolute:
      return "revolute";
    case JointKind::Continuous:
      return "continuous";
    case JointKind::Prismatic:
      return "prismatic";
    case JointKind::Planar:
      return "planar";
    case JointKind::FreeFlyer:
      return "floating";
    default:
      return nullptr;
  }
}

// The one value of all axes of a joint; `none` if it has no axes of its own.
double one_of(const Eigen::VectorXd& values, double none, const std::string& who, const char* what) {
  if (values.size() == 0) return none;
  if ((values.array() != values[0]).any())
    refuse(who, std::string("URDF has one ") + what + " for all its axes");
  return values[0];
}

class Writer {
 public:
  explicit Writer(const Model& model) : model_(model), link_(static_cast<size_t>(model.nframes)) {
    if (model.gravity.linear() != Model().gravity.linear())
      refuse("gravity", "URDF has none, set it to (0, 0, -9.81) first");
    name_links();
  }

  std::string text() {
    text_ = "<?xml version=\"1.0\"?>\n<robot" +
            attribute("name", model_.name.empty() ? "robot" : model_.name) + ">\n";
    for (JointIndex j = 0; j < model_.njoints; ++j) {
      const bool lumped = !adds_up(j);
      if (j > 0) write_moving(j);
      write_link(home_[at(j)], lumped ? model_.inertias[j] : own_inertia(j));
      for (FrameIndex f = 1; f < model_.nframes; ++f) {
        if (model_.frames[f].parentJoint == j && is_fixed(f)) write_fixed(f, lumped);
      }
    }
    return text_ + "</robot>\n";
  }

 private:
  static size_t at(int index) { return static_cast<size_t>(index); }

  // A frame that has a fixed joint of its own in the URDF: not at home on a joint, nor the child of a fixed
  // joint.
  bool is_fixed(FrameIndex f) const {
    return model_.frames[f].type != JOINT && !is_home(f) && children_.count(f) == 0;
  }
  bool is_home(FrameIndex f) const { return home_frame_.at(at(model_.frames[f].parentJoint)) == f; }

  std::string claim(std::set<std::string>& taken, const std::string& name, const char* what) {
    if (!taken.insert(name).second)
      refuse(std::string(what) + " '" + name + "'", "twice in the URDF, rename one");
    return name;
  }

  // The link of every frame: of a BODY its own, of a joint's frame the one at its moving part.
  void name_links() {
    const size_t n = at(model_.njoints);
    home_frame_.assign(n, -1);
    home_.resize(n);
    std::vector<FrameIndex> frame_of(n, 0);  // of joints
    for (FrameIndex f = 1; f < model_.nframes; ++f) {
      const Frame& frame = model_.frames[f];
      if (frame.type == JOINT) frame_of[at(frame.parentJoint)] = f;
    }
    for (FrameIndex f = 1; f < model_.nframes; ++f) {
      const Frame& frame = model_.frames[f];
      if (frame.type != BODY) continue;
      const JointIndex j = frame.parentJoint;
      const FrameIndex p = frame.parentFrame;
      // attached to the joint's frame, or to nothing in particular
      const bool on_joint = p == frame_of[at(j)] || model_.frames[p].parentJoint != j;
      const bool at_joint = frame.placement.isApprox(SE3::Identity(), 0);
      if (home_frame_[at(j)] < 0 && on_joint && at_joint) {
        home_frame_[at(j)] = f;
      } else if (model_.frames[p].type == FIXED_JOINT && model_.frames[p].parentJoint == j &&
                 below_.count(p) == 0 && frame.placement.isApprox(model_.frames[p].placement, 0)) {
        below_[p] = f;
        children_.insert(f);
      }
    }
    for (JointIndex j = 0; j < model_.njoints; ++j) {
      const FrameIndex home = home_frame_[at(j)];
      const std::string made = j == 0 ? "world" : model_.names[j] + "_link";
      home_[at(j)] = claim(links_, home < 0 ? made : model_.frames[home].name, "link");
      link_[at(frame_of[at(j)])] = home_[at(j)];
      if (j > 0) claim(joints_, model_.names[j], "joint");
    }
    for (FrameIndex f = 1; f < model_.nframes; ++f) {
      const Frame& frame = model_.frames[f];
      if (is_home(f)) link_[at(f)] = frame.name;
      if (!is_fixed(f)) continue;
      const bool joint = frame.type == FIXED_JOINT;
      const auto child = below_.find(f);
      const std::string link = child != below_.end() ? model_.frames[child->second].name
                               : joint               ? frame.name + "_link"
                                                     : frame.name;
      link_[at(f)] = claim(links_, link, "link");
      if (child != below_.end()) link_[at(child->second)] = link;
      fixed_name_[f] = claim(joints_, joint ? frame.name : frame.name + "_fixed", "joint");
    }
  }

  // What the bodies on one joint have together, seen from the joint, is what it moves.
  bool adds_up(JointIndex j) const {
    Inertia sum;
    for (const Frame& frame : model_.frames) {
      if (frame.parentJoint == j && !is_zero(frame.inertia)) sum += frame.placement.act(frame.inertia);
    }
    return sum.isApprox(model_.inertias[j], 1e-12);
  }

  Inertia own_inertia(JointIndex j) const {
    const FrameIndex home = home_frame_[at(j)];
    return home < 0 ? Inertia() : model_.frames[home].inertia;
  }

  void write_link(const std::string& name, const Inertia& body) {
    text_ += "  <link" + attribute("name", name);
    if (is_zero(body)) {
      text_ += "/>\n";
      return;
    }
    const Eigen::Matrix3d& i = body.inertia();
    text_ += ">\n    <inertial>\n  " + origin(SE3(Eigen::Matrix3d::Identity(), body.lever()));
    if (text_.ends_with("\n  ")) text_.resize(text_.size() - 2);  // no origin
    text_ += "      <mass" + attribute("value", body.mass()) + "/>\n      <inertia" +
             attribute("ixx", i(0, 0)) + attribute("ixy", i(0, 1)) + attribute("ixz", i(0, 2)) +
             attribute("iyy", i(1, 1)) + attribute("iyz", i(1, 2)) + attribute("izz", i(2, 2)) +
             "/>\n    </inertial>\n  </link>\n";
  }

  void open_joint(const std::string& name, const char* type, const std::string& parent,
                  const std::string& child, const SE3& placement) {
    text_ += "  <joint" + attribute("name", name) + attribute("type", type) + ">\n    <parent" +
             attribute("link", parent) + "/>\n    <child" + attribute("link", child) + "/>\n" +
             origin(placement);
  }

  void write_fixed(FrameIndex f, bool lumped) {
    const Frame& frame = model_.frames[f];
    // hang it where it hung, if that moves with the same joint
    const Frame& above = model_.frames[frame.parentFrame];
    const bool same = above.parentJoint == frame.parentJoint && !link_[at(frame.parentFrame)].empty();
    const SE3 placement = same ? above.placement.actInv(frame.placement) : frame.placement;
    open_joint(fixed_name_.at(f), "fixed", same ? link_[at(frame.parentFrame)] : home_[at(frame.parentJoint)],
               link_[at(f)], placement);
    text_ += "  </joint>\n";
    const auto child = below_.find(f);
    const Inertia& body = child != below_.end() ? model_.frames[child->second].inertia : frame.inertia;
    write_link(link_[at(f)], lumped ? Inertia() : body);
  }

  void write_moving(JointIndex j) {
    const JointModel& joint = model_.joints[j];
    const std::string who = "joint '" + model_.names[j] + "'";
    const JointKind kind = joint.kind();
    if (!type_of(kind)) refuse(who, "URDF has no joint of type " + joint.shortname());
    const int q = joint.idx_q(), v = joint.idx_v(), nq = joint.nq(), nv = joint.nv();
    const bool single = kind != JointKind::Planar && kind != JointKind::FreeFlyer;

    // what has no place in URDF
    if (!model_.armature.segment(v, nv).isZero(0)) refuse(who, "URDF has no armature, set it to 0 first");
    if (!model_.rotorInertia.segment(v, nv).isZero(0))
      refuse(who, "URDF has no rotor inertia, set it to 0 first");
    if (model_.lowerVelocityLimit.segment(v, nv) != -model_.upperVelocityLimit.segment(v, nv) ||
        model_.lowerEffortLimit.segment(v, nv) != -model_.upperEffortLimit.segment(v, nv))
      refuse(who, "URDF has one limit of effort and of velocity for both directions");

    const double inf = std::numeric_limits<double>::infinity();
    double lower = -inf, upper = inf;
    if (single && nv == 1) {
      lower = model_.lowerPositionLimit[q];
      upper = model_.upperPositionLimit[q];
    } else if (!single && ((model_.lowerPositionLimit.segment(q, nq).array() > -inf).any() ||
                           (model_.upperPositionLimit.segment(q, nq).array() < inf).any())) {
      refuse(who, "URDF has no position limits of a joint with several axes");
    }
    const double effort = one_of(model_.upperEffortLimit.segment(v, nv), inf, who, "effort limit");
    const double velocity = one_of(model_.upperVelocityLimit.segment(v, nv), inf, who, "velocity limit");
    const double damping = one_of(model_.damping.segment(v, nv), 0, who, "damping");
    const double friction = one_of(model_.friction.segment(v, nv), 0, who, "friction");

    // a continuous joint that was given limits later is a revolute one
    const bool endless = lower == -inf && upper == inf;
    const char* type = kind == JointKind::Continuous && !endless ? "revolute" : type_of(kind);
    open_joint(model_.names[j], type, home_[at(model_.parents[j])], home_[at(j)], model_.jointPlacements[j]);
    if (kind != JointKind::FreeFlyer) text_ += "    <axis" + attribute("xyz", joint.axis()) + "/>\n";
    const bool bounded = single && (kind != JointKind::Continuous || !endless);
    if (bounded || effort < inf || velocity < inf) {
      text_ += "    <limit";
      if (bounded) text_ += attribute("lower", lower) + attribute("upper", upper);
      text_ += attribute("effort", effort) + attribute("velocity", velocity) + "/>\n";
    }
    if (damping != 0 || friction != 0)
      text_ += "    <dynamics" + attribute("damping", damping) + attribute("friction", friction) + "/>\n";
    if (const rbd::Mimic& mimic = model_.mimic(j); mimic.leader >= 0) {
      text_ += "    <mimic" + attribute("joint", model_.names[mimic.leader]) +
               attribute("multiplier", mimic.multiplier) + attribute("offset", mimic.offset) + "/>\n";
    }
    text_ += "  </joint>\n";
  }

  const Model& model_;
  std::string text_;
  std::vector<FrameIndex> home_frame_;      // of each joint: the frame of the link at its moving part, or -1
  std::vector<std::string> home_;           // of each joint: that link's name
  std::vector<std::string> link_;           // of each frame: its link; empty for the universe's frame alone
  std::map<FrameIndex, FrameIndex> below_;  // fixed joint -> the link it leads to
  std::set<FrameIndex> children_;           // those links
  std::map<FrameIndex, std::string> fixed_name_;  // of each frame that has one: its fixed joint
  std::set<std::string> links_, joints_;          // names given so far
};

}  // namespace

std::string writeModel(const Model& model) {
  std::string text = Writer(model).text();
  Options options;
  options.meshes = false;
  const Loaded back = loadXML(text, options, "writeModel: '" + model.name + "' read back");
  if (!back.ok()) throw Error(back.diagnostics);
  return text;
}

}  // namespace rbd::urdf
