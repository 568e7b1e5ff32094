#include "rbd/urdf/read_elements.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

namespace rbd::urdf {
namespace {

using tinyxml2::XMLElement;

// Limits may be written as "practically infinite"; nothing is computed from them but comparisons.
constexpr double kLimitBound = std::numeric_limits<double>::max();
constexpr double kFullTurn = 6.2832;  // 2 pi, as files round it

constexpr JointType kJointTypes[] = {JointType::Fixed,     JointType::Revolute, JointType::Continuous,
                                     JointType::Prismatic, JointType::Planar,   JointType::Floating};

std::span<double> numbers_of(Eigen::Vector3d& v) { return {v.data(), 3}; }

// The origin of a body or a joint, whose angles are looked at.
Origin read_checked_origin(const XMLElement& parent, const std::string& owner, Report& report) {
  const XMLElement* element = parent.FirstChildElement("origin");
  const Origin origin = read_origin(element, owner, report);
  if (origin.rpy.cwiseAbs().maxCoeff() > kFullTurn) {
    report.warn(line_of(*element, "rpy"), owner,
                "rpy " + show(std::span(origin.rpy.data(), 3)) +
                    " turns more than once around: URDF angles are radians, are these degrees?");
  }
  return origin;
}

std::optional<Inertial> read_inertial(const XMLElement& link, const std::string& owner, Report& report) {
  const XMLElement* inertial = link.FirstChildElement("inertial");
  if (!inertial) return {};
  Inertial out;
  out.origin = read_checked_origin(*inertial, owner, report);

  const XMLElement* mass = inertial->FirstChildElement("mass");
  const XMLElement* inertia = inertial->FirstChildElement("inertia");
  if (!mass) report.error(line_of(*inertial), owner, "<inertial> has no <mass>");
  if (!inertia) report.error(line_of(*inertial), owner, "<inertial> has no <inertia>");
  if (mass && read_number(*mass, "value", owner, out.mass, report) && out.mass < 0)
    report.error(line_of(*mass, "value"), owner, "mass is negative (" + show(out.mass) + ")");
  if (!inertia) return out;

  // whether the tensor can be a body's is seen with the model: check_inertia.h
  out.tensor_line = line_of(*inertia);
  const auto read = [&](const char* name, int row, int col) {
    double value = 0;
    read_number(*inertia, name, owner, value, report);
    out.tensor(row, col) = out.tensor(col, row) = value;
  };
  read("ixx", 0, 0);
  read("ixy", 0, 1);
  read("ixz", 0, 2);
  read("iyy", 1, 1);
  read("iyz", 1, 2);
  read("izz", 2, 2);
  return out;
}

Eigen::Vector3d read_axis(const XMLElement& joint, const std::string& owner, Report& report) {
  Eigen::Vector3d v = Eigen::Vector3d::UnitX();
  const XMLElement* axis = joint.FirstChildElement("axis");
  if (!axis) {
    report.warn(line_of(joint), owner, "no <axis>: x is taken, as URDF has it");
    return v;
  }
  if (!read_numbers(*axis, "xyz", owner, numbers_of(v), report)) return v;
  const double norm = v.norm();
  const std::string seen = show(numbers_of(v));
  if (norm < 1e-6) {
    report.error(line_of(*axis, "xyz"), owner,
                 "axis is zero " + seen + ": give the direction it turns about or slides along");
  } else if (std::abs(norm - 1) > 1e-3) {
    report.note(line_of(*axis, "xyz"), owner,
                "axis " + seen + " has length " + show(norm) + ": it is normalised");
  }
  return v;
}

// Limits that a person would write in degrees: whole multiples of 5 of at least 45, on a joint that turns.
bool looks_like_degrees(const Limit& limit) {
  const auto round = [](double x) { return std::abs(x) <= 720 && std::remainder(x, 5) == 0; };
  return round(limit.lower) && round(limit.upper) &&
         std::max(std::abs(limit.lower), std::abs(limit.upper)) >= 45;
}

void check_positions(const Limit& limit, JointType type, int line, const std::string& owner, Report& report) {
  const std::string seen = "(lower " + show(limit.lower) + ", upper " + show(limit.upper) + ")";
  if (type != JointType::Revolute && type != JointType::Prismatic) {
    if (limit.lower != 0 || limit.upper != 0)
      report.note(line, owner, std::string(name_of(type)) + ": position limits are not used " + seen);
  } else if (limit.lower > limit.upper) {
    report.error(line, owner, "lower limit above the upper one " + seen + ": exchange them");
  } else if (limit.lower == limit.upper) {
    report.warn(line, owner,
                "limits leave no room to move " + seen + ": make the joint 'fixed', or give it a range");
  } else if (type == JointType::Revolute && looks_like_degrees(limit)) {
    report.warn(line, owner, "limits " + seen + " are radians in URDF: are these degrees?");
  }
}

std::optional<Limit> read_limit(const XMLElement& joint, JointType type, const std::string& owner,
                                Report& report) {
  const XMLElement* limit = joint.FirstChildElement("limit");
  if (!limit) {
    if (type == JointType::Revolute || type == JointType::Prismatic)
      report.error(line_of(joint), owner,
                   "no <limit> (a joint that may turn without end has type 'continuous')");
    return {};
  }
  Limit out;
  const bool lower =
      !limit->Attribute("lower") || read_number(*limit, "lower", owner, out.lower, report, kLimitBound);
  const bool upper =
      !limit->Attribute("upper") || read_number(*limit, "upper", owner, out.upper, report, kLimitBound);
  const auto read_peak = [&](const char* name, double& value) {
    if (!read_number(*limit, name, owner, value, report, kLimitBound)) return;
    const std::string what = std::string(name) + " limit is ";
    if (value < 0) report.error(line_of(*limit, name), owner, what + "negative (" + show(value) + ")");
    if (value == 0) report.warn(line_of(*limit, name), owner, what + "0: the joint cannot be driven");
  };
  read_peak("effort", out.effort);
  read_peak("velocity", out.velocity);
  if (!lower || !upper) return {};
  check_positions(out, type, line_of(*limit), owner, report);
  return out;
}

void read_dynamics(const XMLElement& element, const std::string& owner, Joint& joint, Report& report) {
  const XMLElement* dynamics = element.FirstChildElement("dynamics");
  if (!dynamics) return;
  const auto read = [&](const char* name, double& value) {
    if (!dynamics->Attribute(name) || !read_number(*dynamics, name, owner, value, report)) return;
    if (value < 0)
      report.error(line_of(*dynamics, name), owner, std::string(name) + " is negative (" + show(value) + ")");
  };
  read("damping", joint.damping);
  read("friction", joint.friction);
}

// No algorithm uses a safety controller; contradictions within it or with the limits are reported anyway.
void check_safety(const XMLElement& element, const std::string& owner, const Joint& joint, Report& report) {
  const XMLElement* safety = element.FirstChildElement("safety_controller");
  if (!safety) return;
  double gain = 0, lower = 0, upper = 0;
  if (!read_number(*safety, "k_velocity", owner, gain, report)) return;
  const auto read = [&](const char* name, double& value, double bound) {
    return !safety->Attribute(name) || read_number(*safety, name, owner, value, report, bound);
  };
  bool good = read("k_position", gain, kNumberBound);
  good = read("soft_lower_limit", lower, kLimitBound) && good;
  good = read("soft_upper_limit", upper, kLimitBound) && good;
  if (!good || !(safety->Attribute("soft_lower_limit") || safety->Attribute("soft_upper_limit"))) return;
  const std::string seen = "(" + show(lower) + ", " + show(upper) + ")";
  if (lower > upper) {
    report.warn(line_of(*safety), owner, "soft lower limit above the soft upper one " + seen);
    return;
  }
  if (!joint.limit || joint.type == JointType::Continuous) return;
  if (lower < joint.limit->lower || upper > joint.limit->upper)
    report.warn(line_of(*safety), owner, "soft limits " + seen + " reach beyond those of <limit>");
}

std::optional<Mimic> read_mimic(const XMLElement& joint, JointType type, const std::string& owner,
                                const Report& report) {
  const XMLElement* mimic = joint.FirstChildElement("mimic");
  if (!mimic) return {};
  Mimic out;
  out.line = line_of(*mimic);
  if (type == JointType::Fixed) return out;  // not used, whatever it says
  Report faults(report.file());
  if (mimic->Attribute("multiplier")) read_number(*mimic, "multiplier", owner, out.multiplier, faults);
  if (mimic->Attribute("offset")) read_number(*mimic, "offset", owner, out.offset, faults);
  out.leader = read_text(*mimic, "joint", owner, faults);
  out.faults = faults.take();
  return out;
}

JointEnd read_end(const XMLElement& joint, const char* end, const std::string& owner, Report& report) {
  if (const XMLElement* element = joint.FirstChildElement(end))
    return {read_text(*element, "link", owner, report), line_of(*element)};
  report.error(line_of(joint), owner, std::string("no <") + end + ">");
  return {};
}

// Nothing and a message if the type is missing or unknown.
std::optional<JointType> read_type(const XMLElement& joint, const std::string& owner, Report& report) {
  const std::string text = read_text(joint, "type", owner, report);
  if (text.empty()) return {};
  std::vector<std::string> known;
  std::string list;
  for (const JointType type : kJointTypes) {
    if (text == name_of(type)) return type;
    known.push_back(name_of(type));
    list += (list.empty() ? "" : " ") + known.back();
  }
  report.error(line_of(joint, "type"), owner,
               "unknown joint type '" + text + "' (known: " + list + ")" + did_you_mean(text, known));
  return {};
}

Joint read_joint(const XMLElement& element, const std::string& name, const std::string& owner,
                 Report& report) {
  Joint out;
  out.name = name;
  out.line = line_of(element);
  out.name_line = line_of(element, "name");
  out.parent = read_end(element, "parent", owner, report);
  out.child = read_end(element, "child", owner, report);
  out.origin = read_checked_origin(element, owner, report);
  const std::optional<JointType> type = read_type(element, owner, report);
  if (!type) return out;
  out.type = *type;
  if (out.type != JointType::Fixed) {
    if (out.type != JointType::Floating) out.axis = read_axis(element, owner, report);
    out.limit = read_limit(element, out.type, owner, report);
    read_dynamics(element, owner, out, report);
    const bool many_dofs = out.type == JointType::Planar || out.type == JointType::Floating;
    if (!many_dofs) check_safety(element, owner, out, report);
  }
  out.mimic = read_mimic(element, out.type, owner, report);
  return out;
}

// A name may stand once; `first` is the line of the element that has it already, 0 if there is none.
void check_name(const XMLElement& element, const std::string& name, int first, const std::string& owner,
                Report& report) {
  constexpr const char* kBlank = " \t\r\n";
  if (name.empty()) return;
  const int line = line_of(element, "name");
  if (first != 0)
    report.error(line, owner, "a second one of this name, the first is in line " + std::to_string(first));
  if (name.find_first_of(kBlank) == 0 || name.find_last_of(kBlank) + 1 == name.size())
    report.warn(line, owner, "the name begins or ends with a blank, which is part of it");
}

template <class Element>
int line_in(const std::map<std::string, Element>& map, const std::string& name) {
  const auto found = map.find(name);
  return found == map.end() ? 0 : found->second.line;
}

}  // namespace

const char* name_of(JointType type) {
  switch (type) {
    case JointType::Fixed:
      return "fixed";
    case JointType::Revolute:
      return "revolute";
    case JointType::Continuous:
      return "continuous";
    case JointType::Prismatic:
      return "prismatic";
    case JointType::Planar:
      return "planar";
    case JointType::Floating:
      return "floating";
  }
  return "";
}

std::string owner_of(const Link& link) { return "link '" + link.name + "'"; }
std::string owner_of(const Joint& joint) { return "joint '" + joint.name + "'"; }

Origin read_origin(const XMLElement* origin, const std::string& owner, Report& report) {
  Origin out;
  if (origin && origin->Attribute("xyz")) read_numbers(*origin, "xyz", owner, numbers_of(out.xyz), report);
  if (origin && origin->Attribute("rpy")) read_numbers(*origin, "rpy", owner, numbers_of(out.rpy), report);
  return out;
}

Description read_elements(const XMLElement& robot, Report& report) {
  Description out;
  out.name = read_text(robot, "name", "robot", report);
  if (const char* version = robot.Attribute("version"); version && std::string_view(version) != "1.0") {
    report.error(line_of(robot, "version"), owner_of(robot),
                 std::string("URDF version '") + version + "' is not known (known: 1.0)");
  }
  for (const XMLElement* e = robot.FirstChildElement(); e; e = e->NextSiblingElement()) {
    const std::string_view tag = e->Name();
    if (tag != "link" && tag != "joint") continue;
    const std::string owner = owner_of(*e);
    const std::string name = read_text(*e, "name", owner, report);
    if (tag == "link") {
      check_name(*e, name, line_in(out.links, name), owner, report);
      out.links.try_emplace(name, Link{name, line_of(*e), read_inertial(*e, owner, report)});
    } else {
      check_name(*e, name, line_in(out.joints, name), owner, report);
      out.joints.try_emplace(name, read_joint(*e, name, owner, report));
    }
  }
  if (out.links.empty()) report.error(line_of(robot), owner_of(robot), "there is no <link>");
  return out;
}

}  // namespace rbd::urdf
