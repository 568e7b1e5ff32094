#include "rbd/urdf/check.h"

#include <tinyxml2.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <vector>

namespace rbd::urdf {
namespace {

using tinyxml2::XMLElement;

// Limits may be written as "practically infinite"; nothing is computed from them but comparisons.
constexpr double kLimitBound = std::numeric_limits<double>::max();
constexpr double kFullTurn = 6.2832;  // 2 pi, as files round it

void check_origin(XMLElement& parent, const std::string& owner, Report& report) {
  XMLElement* origin = parent.FirstChildElement("origin");
  if (!origin) return;
  std::array<double, 3> xyz{}, rpy{};
  if (origin->Attribute("xyz")) read_numbers(*origin, "xyz", owner, xyz, report);
  if (!origin->Attribute("rpy") || !read_numbers(*origin, "rpy", owner, rpy, report)) return;
  for (const double angle : rpy) {
    if (std::abs(angle) <= kFullTurn) continue;
    report.warn(
        line_of(*origin, "rpy"), owner,
        "rpy " + show(rpy) + " turns more than once around: URDF angles are radians, are these degrees?");
    break;
  }
}

// Limits that a person would write in degrees: whole multiples of 5 of at least 45, on a joint that turns.
bool looks_like_degrees(double lower, double upper) {
  const auto round = [](double x) { return std::abs(x) <= 720 && std::remainder(x, 5) == 0; };
  return round(lower) && round(upper) && std::max(std::abs(lower), std::abs(upper)) >= 45;
}

void check_inertial(XMLElement& link, const std::string& owner, Report& report) {
  XMLElement* inertial = link.FirstChildElement("inertial");
  if (!inertial) return;
  check_origin(*inertial, owner, report);

  double value = 0;
  XMLElement* mass = inertial->FirstChildElement("mass");
  XMLElement* inertia = inertial->FirstChildElement("inertia");
  if (!mass) report.error(line_of(*inertial), owner, "<inertial> has no <mass>");
  if (!inertia) report.error(line_of(*inertial), owner, "<inertial> has no <inertia>");
  const bool mass_read = mass && read_number(*mass, "value", owner, value, report);
  if (mass_read && value < 0)
    report.error(line_of(*mass, "value"), owner, "mass is negative (" + show(value) + ")");

  for (const char* name : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
    if (inertia) read_number(*inertia, name, owner, value, report);
  }
}

void check_axis(XMLElement& joint, const std::string& owner, Report& report) {
  XMLElement* axis = joint.FirstChildElement("axis");
  if (!axis) {
    report.warn(line_of(joint), owner, "no <axis>: x is taken, as URDF has it");
    return;
  }
  Eigen::Vector3d v;
  if (!read_numbers(*axis, "xyz", owner, std::span(v.data(), 3), report)) return;
  const double norm = v.norm();
  const std::string seen = show(std::span(v.data(), 3));
  if (norm < 1e-6) {
    report.error(line_of(*axis, "xyz"), owner,
                 "axis is zero " + seen + ": give the direction it turns about or slides along");
  } else if (std::abs(norm - 1) > 1e-3) {
    report.note(line_of(*axis, "xyz"), owner,
                "axis " + seen + " has length " + show(norm) + ": it is normalised");
  }
}

void check_limit(XMLElement& joint, std::string_view type, const std::string& owner, Report& report) {
  const bool bounded = type == "revolute" || type == "prismatic";
  XMLElement* limit = joint.FirstChildElement("limit");
  if (!limit) {
    if (!bounded) return;
    report.error(line_of(joint), owner,
                 "no <limit> (a joint that may turn without end has type 'continuous')");
    return;
  }
  double lower = 0, upper = 0, value = 0;
  bool read = true;
  for (const char* name : {"lower", "upper"}) {
    double& out = *name == 'l' ? lower : upper;
    if (limit->Attribute(name)) read = read_number(*limit, name, owner, out, report, kLimitBound) && read;
  }
  for (const char* name : {"effort", "velocity"}) {
    if (!read_number(*limit, name, owner, value, report, kLimitBound)) continue;
    const std::string what = std::string(name) + " limit is ";
    if (value < 0) report.error(line_of(*limit, name), owner, what + "negative (" + show(value) + ")");
    if (value == 0) report.warn(line_of(*limit, name), owner, what + "0: the joint cannot be driven");
  }
  if (!read) return;

  const std::string seen = "(lower " + show(lower) + ", upper " + show(upper) + ")";
  if (!bounded) {
    if (lower != 0 || upper != 0)
      report.note(line_of(*limit), owner, std::string(type) + ": position limits are not used " + seen);
  } else if (lower > upper) {
    report.error(line_of(*limit), owner, "lower limit above the upper one " + seen + ": exchange them");
  } else if (lower == upper) {
    report.warn(line_of(*limit), owner,
                "limits leave no room to move " + seen + ": make the joint 'fixed', or give it a range");
  } else if (type == "revolute" && looks_like_degrees(lower, upper)) {
    report.warn(line_of(*limit), owner, "limits " + seen + " are radians in URDF: are these degrees?");
  }
}

// Nothing computes with a safety controller; what contradicts itself or the limits is told all the same.
void check_safety(XMLElement& joint, const std::string& owner, Report& report) {
  XMLElement* safety = joint.FirstChildElement("safety_controller");
  if (!safety) return;
  double value = 0, lower = 0, upper = 0;
  if (!read_number(*safety, "k_velocity", owner, value, report)) return;
  bool read = true;
  if (safety->Attribute("k_position")) read = read_number(*safety, "k_position", owner, value, report);
  const bool soft = safety->Attribute("soft_lower_limit") || safety->Attribute("soft_upper_limit");
  for (const char* name : {"soft_lower_limit", "soft_upper_limit"}) {
    double& out = name[5] == 'l' ? lower : upper;
    if (safety->Attribute(name)) read = read_number(*safety, name, owner, out, report, kLimitBound) && read;
  }
  if (!read || !soft) return;
  const std::string seen = "(" + show(lower) + ", " + show(upper) + ")";
  if (lower > upper) {
    report.warn(line_of(*safety), owner, "soft lower limit above the soft upper one " + seen);
    return;
  }
  const XMLElement* limit = joint.FirstChildElement("limit");
  if (!limit || std::string_view(joint.Attribute("type")) == "continuous") return;
  if (lower < limit->DoubleAttribute("lower") || upper > limit->DoubleAttribute("upper"))
    report.warn(line_of(*safety), owner, "soft limits " + seen + " reach beyond those of <limit>");
}

void check_dynamics(XMLElement& joint, const std::string& owner, Report& report) {
  XMLElement* dynamics = joint.FirstChildElement("dynamics");
  if (!dynamics) return;
  for (const char* name : {"damping", "friction"}) {
    double value = 0;
    if (!dynamics->Attribute(name)) dynamics->SetAttribute(name, "0");
    if (!read_number(*dynamics, name, owner, value, report)) continue;
    if (value < 0) {
      report.error(line_of(*dynamics, name), owner, std::string(name) + " is negative (" + show(value) + ")");
    }
  }
}

void check_joint(XMLElement& joint, const std::string& owner, Report& report) {
  for (const char* end : {"parent", "child"}) {
    const XMLElement* element = joint.FirstChildElement(end);
    if (element) {
      read_text(*element, "link", owner, report);
    } else {
      report.error(line_of(joint), owner, std::string("no <") + end + ">");
    }
  }
  check_origin(joint, owner, report);

  const std::string type = read_text(joint, "type", owner, report);
  if (type == "revolute" || type == "prismatic" || type == "continuous") {
    check_axis(joint, owner, report);
    check_limit(joint, type, owner, report);
    check_dynamics(joint, owner, report);
    check_safety(joint, owner, report);
  } else if (type == "planar" || type == "floating") {
    if (type == "planar") check_axis(joint, owner, report);
    check_limit(joint, type, owner, report);
    check_dynamics(joint, owner, report);
  } else if (!type.empty() && type != "fixed") {
    report.error(
        line_of(joint, "type"), owner,
        "unknown joint type '" + type + "' (known: fixed revolute continuous prismatic planar floating)" +
            did_you_mean(type, {"fixed", "revolute", "continuous", "prismatic", "planar", "floating"}));
  }
}

// The link a joint starts from or ends at. Both exist once check_elements has passed.
std::string link_of(const XMLElement& joint, const char* end) {
  return joint.FirstChildElement(end)->Attribute("link");
}

}  // namespace

Elements check_elements(XMLElement& robot, Report& report) {
  Elements out;
  read_text(robot, "name", "robot", report);
  if (const char* version = robot.Attribute("version"); version && std::string_view(version) != "1.0") {
    report.error(line_of(robot, "version"), owner_of(robot),
                 std::string("URDF version '") + version + "' is not known (known: 1.0)");
  }
  robot.DeleteAttribute("version");

  for (XMLElement* e = robot.FirstChildElement(); e; e = e->NextSiblingElement()) {
    const std::string_view tag = e->Name();
    if (tag != "link" && tag != "joint") continue;
    const std::string name = read_text(*e, "name", owner_of(*e), report);
    const std::string owner = owner_of(*e);
    auto& map = tag == "link" ? out.links : out.joints;
    const auto [first, fresh] = map.emplace(name, e);
    if (!fresh && !name.empty()) {
      report.error(
          line_of(*e, "name"), owner,
          "a second one of this name, the first is in line " + std::to_string(line_of(*first->second)));
    }
    if (name.find_first_of(" \t\r\n") == 0 ||
        (!name.empty() && name.find_last_of(" \t\r\n") + 1 == name.size())) {
      report.warn(line_of(*e, "name"), owner, "the name begins or ends with a blank, which is part of it");
    }
    if (tag == "link") {
      check_inertial(*e, owner, report);
    } else {
      check_joint(*e, owner, report);
    }
  }
  if (out.links.empty()) report.error(line_of(robot), owner_of(robot), "there is no <link>");
  return out;
}

void check_tree(const Elements& elements, Report& report) {
  std::map<std::string, const XMLElement*> joint_above;  // by child link
  std::multimap<std::string, std::string> children;      // parent link -> child links
  std::vector<std::string> links;
  for (const auto& [name, link] : elements.links) links.push_back(name);
  for (const auto& [name, joint] : elements.joints) {
    const std::string owner = owner_of(*joint);
    bool exist = true;
    for (const char* end : {"parent", "child"}) {
      if (elements.links.count(link_of(*joint, end))) continue;
      exist = false;
      report.error(line_of(*joint->FirstChildElement(end)), owner,
                   std::string("its ") + end + " link '" + link_of(*joint, end) + "' does not exist" +
                       did_you_mean(link_of(*joint, end), links));
    }
    if (!exist) continue;
    const std::string parent = link_of(*joint, "parent"), child = link_of(*joint, "child");
    if (parent == child) {
      report.error(line_of(*joint), owner, "parent and child are the same link '" + child + "'");
      continue;
    }
    const auto [first, fresh] = joint_above.emplace(child, joint);
    if (!fresh) {
      report.error(line_of(*joint), owner,
                   "link '" + child + "' hangs on joint '" + first->second->Attribute("name") +
                       "' already (line " + std::to_string(line_of(*first->second)) +
                       "): each link has one joint above it, URDF knows no loops");
      continue;
    }
    children.emplace(parent, child);
  }
  if (report.failed()) return;

  // Whoever is not reached from the root stands in a ring, or hangs on one; another root is a detached part.
  std::vector<std::pair<int, std::string>> roots;  // by line: the first one in the file is the root
  for (const auto& [name, link] : elements.links) {
    if (!joint_above.count(name)) roots.emplace_back(line_of(*link), name);
  }
  std::sort(roots.begin(), roots.end());
  for (size_t k = 1; k < roots.size(); ++k) {
    report.error(roots[k].first, "link '" + roots[k].second + "'",
                 "no joint leads to it: detached from the root '" + roots[0].second + "' (line " +
                     std::to_string(roots[0].first) + "): name it as child of a joint");
  }
  if (report.failed()) return;

  std::set<std::string> reached;
  std::vector<std::string> open;
  if (!roots.empty()) open.push_back(roots[0].second);
  while (!open.empty()) {
    const std::string link = open.back();
    open.pop_back();
    reached.insert(link);
    const auto [begin, end] = children.equal_range(link);
    for (auto it = begin; it != end; ++it) open.push_back(it->second);
  }
  for (const auto& [name, link] : elements.links) {
    if (reached.count(name)) continue;
    // Walk up until a link repeats: that one is in the ring. One message is enough.
    std::set<std::string> seen;
    std::string at = name;
    while (seen.insert(at).second) at = link_of(*joint_above.at(at), "parent");
    std::string ring = at;
    std::string up = at;
    for (int shown = 0; shown < 8; ++shown) {
      up = link_of(*joint_above.at(up), "parent");
      ring = up + " > " + ring;
      if (up == at) break;
    }
    report.error(line_of(*joint_above.at(at)), owner_of(*joint_above.at(at)),
                 "closes a loop of links (" + ring + "): a tree is needed, take one joint of it out");
    return;
  }
}

void check_names(const Elements& elements, bool floating_base, Report& report) {
  for (const auto& [name, joint] : elements.joints) {
    if (name == "universe" || (floating_base && name == "root_joint")) {
      report.error(line_of(*joint, "name"), owner_of(*joint),
                   "this name is taken by the model itself, choose another");
    }
    if (const auto link = elements.links.find(name); link != elements.links.end()) {
      report.note(line_of(*joint, "name"), owner_of(*joint),
                  "a link has the same name (line " + std::to_string(line_of(*link->second)) +
                      "): look its frame up by name and type");
    }
  }
}

namespace {

bool has_many_dofs(const XMLElement& joint) {
  const std::string_view type = joint.Attribute("type");
  return type == "planar" || type == "floating";
}

}  // namespace

void check_mimic(const Elements& elements, bool honoured, Report& report) {
  const Severity severity = honoured ? Severity::Error : Severity::Warning;  // of a bad leader
  std::map<std::string, std::string> leader;                                 // follower joint -> leader
  for (const auto& [name, joint] : elements.joints) {
    XMLElement* mimic = joint->FirstChildElement("mimic");
    if (!mimic) continue;
    const std::string owner = owner_of(*joint);
    const int line = line_of(*mimic);
    if (std::string_view(joint->Attribute("type")) == "fixed") {
      report.note(line, owner, "<mimic> of a fixed joint is not used");
      continue;
    }
    double multiplier = 1, offset = 0;
    if (mimic->Attribute("multiplier")) read_number(*mimic, "multiplier", owner, multiplier, report);
    if (mimic->Attribute("offset")) read_number(*mimic, "offset", owner, offset, report);
    if (multiplier == 0) report.warn(line, owner, "mimic multiplier is 0: the joint never moves");
    const std::string target = read_text(*mimic, "joint", owner, report);
    const auto found = elements.joints.find(target);
    if (target.empty()) {
      continue;
    } else if (found == elements.joints.end()) {
      report.add(severity, line, owner, "mimics joint '" + target + "', which does not exist");
    } else if (std::string_view(found->second->Attribute("type")) == "fixed") {
      report.add(severity, line, owner, "mimics joint '" + target + "', which is fixed");
    } else if (const auto* many = has_many_dofs(*joint)           ? joint
                                  : has_many_dofs(*found->second) ? found->second
                                                                  : nullptr) {
      report.add(severity, line, owner,
                 "mimics joint '" + target + "', but " + owner_of(*many) + " is " + many->Attribute("type") +
                     ": only joints of one degree of freedom can mimic or lead");
    } else {
      leader[name] = target;
    }
  }
  for (const auto& [name, target] : leader) {
    std::string at = target;
    for (size_t steps = 0; steps < leader.size() && at != name && leader.count(at); ++steps)
      at = leader.at(at);
    if (at != name) continue;
    report.error(line_of(*elements.joints.at(name)->FirstChildElement("mimic")),
                 owner_of(*elements.joints.at(name)), "mimics itself, through joint '" + target + "'");
    return;
  }
  if (report.failed() || honoured) return;
  for (const auto& [follower, followed] : leader) {
    const XMLElement& joint = *elements.joints.at(follower);
    report.note(line_of(*joint.FirstChildElement("mimic")), owner_of(joint),
                "<mimic> of joint '" + followed + "' is left out as asked: a free joint");
  }
}

}  // namespace rbd::urdf
