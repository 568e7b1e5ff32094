#include "rbd/urdf/shapes.h"

#include <tinyxml2.h>

#include <map>

#include "rbd/spatial/so3.h"

namespace rbd::urdf {
namespace {

using tinyxml2::XMLElement;
using Colors = std::map<std::string, Eigen::Vector4d>;

// Pose of a shape in its link; the identity without <origin>.
SE3 read_pose(XMLElement* origin, const std::string& owner, Report& report) {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero(), rpy = Eigen::Vector3d::Zero();
  if (origin && origin->Attribute("xyz"))
    read_numbers(*origin, "xyz", owner, std::span(xyz.data(), 3), report);
  if (origin && origin->Attribute("rpy"))
    read_numbers(*origin, "rpy", owner, std::span(rpy.data(), 3), report);
  return SE3(rpyToMatrix(rpy), xyz);
}

// A <color> inside <material>; false if there is none that can be read. Out-of-range parts are clamped.
bool read_color(XMLElement& material, const std::string& owner, Eigen::Vector4d& rgba, Report& report) {
  XMLElement* color = material.FirstChildElement("color");
  if (!color || !read_numbers(*color, "rgba", owner, std::span(rgba.data(), 4), report)) return false;
  if (rgba.minCoeff() < 0 || rgba.maxCoeff() > 1) {
    report.warn(line_of(*color, "rgba"), owner,
                std::string("colour parts lie between 0 and 1: clamped (") + color->Attribute("rgba") + ")");
    rgba = rgba.cwiseMax(0.0).cwiseMin(1.0);
  }
  return true;
}

// Colours by material name, wherever in the file they are given; the first one wins.
Colors read_colors(XMLElement& robot, Report& report) {
  Colors colors;
  const auto add = [&](XMLElement& material, const std::string& owner) {
    Eigen::Vector4d rgba;
    const char* name = material.Attribute("name");
    if (read_color(material, owner, rgba, report) && name && *name) colors.emplace(name, rgba);
  };
  for (XMLElement* m = robot.FirstChildElement("material"); m; m = m->NextSiblingElement("material")) {
    add(*m, owner_of(*m));
  }
  for (XMLElement* link = robot.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    for (XMLElement* v = link->FirstChildElement("visual"); v; v = v->NextSiblingElement("visual")) {
      if (XMLElement* m = v->FirstChildElement("material")) add(*m, owner_of(*link));
    }
  }
  return colors;
}

// The material of one visual: its own colour, else that of its name, else none.
void apply_material(XMLElement& visual, const Colors& colors, const std::string& owner,
                    GeometryObject& object, Report& report) {
  XMLElement* material = visual.FirstChildElement("material");
  if (!material) return;
  Report checked_before(report.file());
  object.hasColor = read_color(*material, owner, object.rgba, checked_before);
  const char* name = material->Attribute("name");
  if (object.hasColor || material->FirstChildElement("texture")) return;
  const auto named = name ? colors.find(name) : colors.end();
  if (named != colors.end()) {
    object.hasColor = true;
    object.rgba = named->second;
  } else if (name && *name) {
    report.warn(line_of(*material), owner, std::string("material '") + name + "' has no colour anywhere");
  }
}

// Sizes of box, cylinder, capsule, sphere: false if the shape is not usable.
bool read_size(XMLElement& shape, const std::string& owner, GeometryObject& object, Report& report) {
  const std::string kind = shape.Name();
  int count = 0;
  bool read = true;
  if (kind == "box") {
    object.shape = Shape::Box;
    count = 3;
    read = read_numbers(shape, "size", owner, std::span(object.size.data(), 3), report);
  } else {
    object.shape = kind == "sphere" ? Shape::Sphere : kind == "capsule" ? Shape::Capsule : Shape::Cylinder;
    count = kind == "sphere" ? 1 : 2;
    read = read_number(shape, "radius", owner, object.size[0], report);
    if (count == 2) read = read_number(shape, "length", owner, object.size[1], report) && read;
  }
  if (!read) return false;

  const std::string seen = show(std::span(object.size.data(), count));
  if (object.size.minCoeff() < 0) {
    report.error(line_of(shape), owner, "<" + kind + "> of negative size " + seen);
    return false;
  }
  if (object.size.head(count).minCoeff() == 0 && kind != "capsule") {
    report.warn(line_of(shape), owner, "<" + kind + "> without volume is left out " + seen);
    return false;
  }
  return true;
}

bool read_mesh(XMLElement& mesh, const std::string& owner, GeometryObject& object, Report& report) {
  object.shape = Shape::Mesh;
  object.meshUri = read_text(mesh, "filename", owner, report);
  bool read = !object.meshUri.empty();
  if (mesh.Attribute("scale")) {
    read = read_numbers(mesh, "scale", owner, std::span(object.scale.data(), 3), report) && read;
    if (read && object.scale.cwiseAbs().minCoeff() == 0) {
      report.error(line_of(mesh, "scale"), owner,
                   std::string("mesh scale is zero (") + mesh.Attribute("scale") + ")");
      return false;
    }
  }
  return read;
}

}  // namespace

std::vector<LinkShape> read_shapes(XMLElement& robot, Report& report) {
  const Colors colors = read_colors(robot, report);
  std::vector<LinkShape> out;
  for (XMLElement* link = robot.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    const std::string owner = owner_of(*link);
    const std::string name = link->Attribute("name") ? link->Attribute("name") : "";
    int count[2] = {0, 0};  // names are numbered apart: collision, visual
    for (XMLElement* e = link->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string_view tag = e->Name();
      if (tag != "visual" && tag != "collision") continue;
      LinkShape item;
      item.link = name;
      item.visual = tag == "visual";
      item.object.name = name + "_" + std::to_string(count[item.visual]++);
      item.object.placement = read_pose(e->FirstChildElement("origin"), owner, report);

      XMLElement* geometry = e->FirstChildElement("geometry");
      XMLElement* shape = geometry ? geometry->FirstChildElement() : nullptr;
      if (!shape) {
        report.error(line_of(geometry ? *geometry : *e), owner,
                     "<" + std::string(tag) + "> has no " + (geometry ? "shape" : "<geometry>"));
        continue;
      }
      if (shape->NextSiblingElement()) {
        report.error(line_of(*shape->NextSiblingElement()), owner, "a second shape in one <geometry>");
        continue;
      }
      item.line = line_of(*shape);
      const std::string_view kind = shape->Name();
      const bool mesh = kind == "mesh";
      const bool solid = kind == "box" || kind == "cylinder" || kind == "capsule" || kind == "sphere";
      if (item.visual) apply_material(*e, colors, owner, item.object, report);
      if (mesh ? read_mesh(*shape, owner, item.object, report)
               : solid && read_size(*shape, owner, item.object, report)) {
        out.push_back(std::move(item));
      }
    }
  }
  return out;
}

}  // namespace rbd::urdf
