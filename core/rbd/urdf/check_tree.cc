#include "rbd/urdf/check_tree.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "rbd/urdf/xml.h"

namespace rbd::urdf {
namespace {

// Joints by the links they join.
struct Tree {
  std::map<std::string, const Joint*> above;         // child link -> the joint above it
  std::multimap<std::string, std::string> children;  // parent link -> child links
};

bool ends_exist(const Description& robot, const Joint& joint, const std::vector<std::string>& links,
                Report& report) {
  bool exist = true;
  const auto check = [&](const char* what, const JointEnd& end) {
    if (robot.links.count(end.link)) return;
    exist = false;
    report.error(end.line, owner_of(joint),
                 std::string("its ") + what + " link '" + end.link + "' does not exist" +
                     did_you_mean(end.link, links));
  };
  check("parent", joint.parent);
  check("child", joint.child);
  return exist;
}

Tree join_links(const Description& robot, Report& report) {
  Tree tree;
  std::vector<std::string> links;
  for (const auto& [name, link] : robot.links) links.push_back(name);
  for (const auto& [name, joint] : robot.joints) {
    if (!ends_exist(robot, joint, links, report)) continue;
    const std::string &parent = joint.parent.link, &child = joint.child.link;
    if (parent == child) {
      report.error(joint.line, owner_of(joint), "parent and child are the same link '" + child + "'");
      continue;
    }
    const auto [first, fresh] = tree.above.emplace(child, &joint);
    if (!fresh) {
      report.error(joint.line, owner_of(joint),
                   "link '" + child + "' hangs on joint '" + first->second->name + "' already (line " +
                       std::to_string(first->second->line) +
                       "): each link has one joint above it, URDF knows no loops");
      continue;
    }
    tree.children.emplace(parent, child);
  }
  return tree;
}

// The first link in the file that no joint leads to; another one is a detached part. "" if there is none.
std::string find_root(const Description& robot, const Tree& tree, Report& report) {
  std::vector<std::pair<int, std::string>> roots;
  for (const auto& [name, link] : robot.links) {
    if (!tree.above.count(name)) roots.emplace_back(link.line, name);
  }
  std::sort(roots.begin(), roots.end());
  for (size_t k = 1; k < roots.size(); ++k) {
    report.error(roots[k].first, "link '" + roots[k].second + "'",
                 "no joint leads to it: detached from the root '" + roots[0].second + "' (line " +
                     std::to_string(roots[0].first) + "): name it as child of a joint");
  }
  return roots.empty() ? "" : roots[0].second;
}

std::set<std::string> links_below(const std::string& root, const Tree& tree) {
  std::set<std::string> reached;
  std::vector<std::string> open;
  if (!root.empty()) open.push_back(root);
  while (!open.empty()) {
    const std::string link = open.back();
    open.pop_back();
    reached.insert(link);
    const auto [begin, end] = tree.children.equal_range(link);
    for (auto it = begin; it != end; ++it) open.push_back(it->second);
  }
  return reached;
}

// A link that the root does not reach is in a ring of links, or below one: walks up until a link repeats.
void report_ring(const std::string& link, const Tree& tree, Report& report) {
  const auto above = [&](const std::string& name) { return tree.above.at(name)->parent.link; };
  std::set<std::string> seen;
  std::string at = link;
  while (seen.insert(at).second) at = above(at);
  std::string ring = at;
  std::string up = at;
  for (int shown = 0; shown < 8; ++shown) {
    up = above(up);
    ring = up + " > " + ring;
    if (up == at) break;
  }
  const Joint& joint = *tree.above.at(at);
  report.error(joint.line, owner_of(joint),
               "closes a loop of links (" + ring + "): a tree is needed, take one joint of it out");
}

bool has_many_dofs(const Joint& joint) {
  return joint.type == JointType::Planar || joint.type == JointType::Floating;
}

// Why this joint cannot follow that leader; "" if it can.
std::string mimic_fault(const Description& robot, const Joint& joint, const Mimic& mimic) {
  const std::string says = "mimics joint '" + mimic.leader + "', ";
  const auto found = robot.joints.find(mimic.leader);
  if (found == robot.joints.end()) return says + "which does not exist";
  const Joint& leader = found->second;
  if (leader.type == JointType::Fixed) return says + "which is fixed";
  if (!has_many_dofs(joint) && !has_many_dofs(leader)) return "";
  const Joint& many = has_many_dofs(joint) ? joint : leader;
  return says + "but " + owner_of(many) + " is " + name_of(many.type) +
         ": only joints of one degree of freedom can mimic or lead";
}

using Leaders = std::map<std::string, const Mimic*>;  // follower -> whom it mimics

bool leads_to_itself(const std::string& name, const Leaders& leaders) {
  std::string at = leaders.at(name)->leader;
  for (size_t steps = 0; steps < leaders.size() && at != name && leaders.count(at); ++steps)
    at = leaders.at(at)->leader;
  return at == name;
}

}  // namespace

std::string check_tree(const Description& robot, Report& report) {
  const Tree tree = join_links(robot, report);
  if (report.failed()) return {};
  std::string root = find_root(robot, tree, report);
  if (report.failed()) return {};
  const std::set<std::string> reached = links_below(root, tree);
  for (const auto& [name, link] : robot.links) {
    if (reached.count(name)) continue;
    report_ring(name, tree, report);  // one message is enough
    break;
  }
  return root;
}

void check_names(const Description& robot, bool floating_base, Report& report) {
  for (const auto& [name, joint] : robot.joints) {
    if (name == "universe" || (floating_base && name == "root_joint")) {
      report.error(joint.name_line, owner_of(joint),
                   "this name is taken by the model itself, choose another");
    }
    if (const auto link = robot.links.find(name); link != robot.links.end()) {
      report.note(joint.name_line, owner_of(joint),
                  "a link has the same name (line " + std::to_string(link->second.line) +
                      "): look its frame up by name and type");
    }
  }
}

void check_mimic(const Description& robot, bool honoured, Report& report) {
  const Severity severity = honoured ? Severity::Error : Severity::Warning;  // of a bad leader
  Leaders leaders;
  for (const auto& [name, joint] : robot.joints) {
    if (!joint.mimic) continue;
    const Mimic& mimic = *joint.mimic;
    const std::string owner = owner_of(joint);
    if (joint.type == JointType::Fixed) {
      report.note(mimic.line, owner, "<mimic> of a fixed joint is not used");
      continue;
    }
    report.add(mimic.faults);
    if (mimic.multiplier == 0) report.warn(mimic.line, owner, "mimic multiplier is 0: the joint never moves");
    if (mimic.leader.empty()) continue;
    if (const std::string fault = mimic_fault(robot, joint, mimic); !fault.empty()) {
      report.add(severity, mimic.line, owner, fault);
    } else {
      leaders[name] = &mimic;
    }
  }
  for (const auto& [name, mimic] : leaders) {
    if (!leads_to_itself(name, leaders)) continue;
    report.error(mimic->line, owner_of(robot.joints.at(name)),
                 "mimics itself, through joint '" + mimic->leader + "'");
    return;
  }
  if (report.failed() || honoured) return;
  for (const auto& [follower, mimic] : leaders) {
    report.note(mimic->line, owner_of(robot.joints.at(follower)),
                "<mimic> of joint '" + mimic->leader + "' is left out as asked: a free joint");
  }
}

}  // namespace rbd::urdf
