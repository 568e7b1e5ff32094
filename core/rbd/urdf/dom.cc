#include "rbd/urdf/dom.h"

#include <console_bridge/console.h>
#include <tinyxml2.h>
#include <urdf_parser/urdf_parser.h>

#include <mutex>

namespace rbd::urdf {
namespace {

using tinyxml2::XMLElement;

// Children of `element` for which keep(child's name) is false go; comments and text as well.
template <class Keep>
void keep_only(XMLElement& element, Keep keep) {
  for (tinyxml2::XMLNode* node = element.FirstChild(); node;) {
    tinyxml2::XMLNode* next = node->NextSibling();
    if (!node->ToElement() || !keep(std::string_view(node->Value()))) element.DeleteChild(node);
    node = next;
  }
}

std::string skeleton(XMLElement& robot) {
  keep_only(robot, [](std::string_view tag) { return tag == "link" || tag == "joint"; });
  for (XMLElement* e = robot.FirstChildElement(); e; e = e->NextSiblingElement()) {
    const bool link = std::string_view(e->Name()) == "link";
    const bool fixed = !link && std::string_view(e->Attribute("type")) == "fixed";
    keep_only(*e, [&](std::string_view tag) {
      if (link) return tag == "inertial";
      if (tag == "origin" || tag == "parent" || tag == "child") return true;
      return !fixed && (tag == "axis" || tag == "limit" || tag == "dynamics" || tag == "mimic");
    });
  }
  tinyxml2::XMLPrinter printer(nullptr, true);
  robot.Accept(&printer);
  return printer.CStr();
}

// While it lives, urdfdom's messages go here. The handler is global to the process, hence the lock.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~Listener() override { console_bridge::restorePreviousOutputHandler(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_WARN) return;
    said += (said.empty() ? "" : "; ") + text;
  }

  std::string said;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
};

// A chain of links owns each next one: taking it apart first keeps its destruction from recursing.
struct Unchain {
  void operator()(::urdf::ModelInterface* model) const {
    for (auto& [name, link] : model->links_) {
      link->child_links.clear();
      link->child_joints.clear();
    }
    delete model;
  }
};

}  // namespace

::urdf::ModelInterfaceSharedPtr read_dom(XMLElement& robot, const Elements& elements, Report& report) {
  const std::string text = skeleton(robot);
  const int line = line_of(robot);
  ::urdf::ModelInterfaceSharedPtr model;
  std::string said;
  try {
    Listener listener;
    const ::urdf::ModelInterfaceSharedPtr parsed = ::urdf::parseURDF(text);
    said = listener.said;
    // The content moves into a model of ours, whose end we control.
    if (parsed) model = {new ::urdf::ModelInterface(std::move(*parsed)), Unchain()};
  } catch (const std::exception& e) {
    said = e.what();
  }

  // Our checks come first, so this is a second opinion: it must find nothing, and lose nothing.
  if (!said.empty()) report.error(line, owner_of(robot), "urdfdom: " + said);
  if (!model && said.empty()) report.error(line, owner_of(robot), "urdfdom returned no model");
  if (model && (model->links_.size() != elements.links.size() ||
                model->joints_.size() != elements.joints.size() || !model->root_link_)) {
    report.error(line, owner_of(robot),
                 "urdfdom kept " + std::to_string(model->links_.size()) + " of " +
                     std::to_string(elements.links.size()) + " links and " +
                     std::to_string(model->joints_.size()) + " of " + std::to_string(elements.joints.size()) +
                     " joints");
  }
  return report.failed() ? nullptr : model;
}

}  // namespace rbd::urdf
