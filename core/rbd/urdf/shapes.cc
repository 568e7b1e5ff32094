#include "rbd/urdf/shapes.h"

#include <tinyxml2.h>

#include <map>
#include <optional>

#include "rbd/spatial/so3.h"
#include "rbd/urdf/read_elements.h"

namespace rbd::urdf {
namespace {

using tinyxml2::XMLElement;
// Calls f with each child of that name.
template <class F>
void for_each(const XMLElement& parent, const char* name, F f) {
  for (const XMLElement* e = parent.FirstChildElement(name); e; e = e->NextSiblingElement(name)) f(*e);
}

using Color = Eigen::Vector4d;

// The colours of a file, each read once.
struct Colors {
  std::map<const XMLElement*, Color> own;  // by <material>: what it gives itself
  std::map<std::string, Color> named;      // by name, wherever in the file it is given; the first one wins
};

SE3 pose_of_shape(const Origin& origin) { return SE3(rpyToMatrix(origin.rpy), origin.xyz); }

// The <color> inside <material>, nothing if there is none that can be read. Out-of-range parts are clamped.
std::optional<Color> read_color(const XMLElement& material, const std::string& owner, Report& report) {
  const XMLElement* color = material.FirstChildElement("color");
  Color rgba;
  const std::span numbers(rgba.data(), 4);
  if (!color || !read_numbers(*color, "rgba", owner, numbers, report)) return {};
  if (rgba.minCoeff() < 0 || rgba.maxCoeff() > 1) {
    report.warn(line_of(*color, "rgba"), owner,
                "colour parts lie between 0 and 1: clamped " + exactly(numbers));
    rgba = rgba.cwiseMax(0.0).cwiseMin(1.0);
  }
  return rgba;
}

Colors read_colors(const XMLElement& robot, Report& report) {
  Colors colors;
  const auto add = [&](const XMLElement& material, const std::string& owner) {
    const std::optional<Color> rgba = read_color(material, owner, report);
    if (!rgba) return;
    colors.own.emplace(&material, *rgba);
    const char* name = material.Attribute("name");
    if (name && *name) colors.named.emplace(name, *rgba);
  };
  for_each(robot, "material", [&](const XMLElement& m) { add(m, owner_of(m)); });
  for_each(robot, "link", [&](const XMLElement& link) {
    for_each(link, "visual", [&](const XMLElement& visual) {
      if (const XMLElement* m = visual.FirstChildElement("material")) add(*m, owner_of(link));
    });
  });
  return colors;
}

// The material of one visual: its own colour, else that of its name, else none.
void apply_material(const XMLElement& visual, const Colors& colors, const std::string& owner,
                    GeometryObject& object, Report& report) {
  const XMLElement* material = visual.FirstChildElement("material");
  if (!material) return;
  const auto take = [&](const auto& map, const auto& key) {
    const auto found = map.find(key);
    if (found == map.end()) return false;
    object.rgba = found->second;
    return object.hasColor = true;
  };
  if (take(colors.own, material) || material->FirstChildElement("texture")) return;
  const char* name = material->Attribute("name");
  if (name && !take(colors.named, name) && *name)
    report.warn(line_of(*material), owner, std::string("material '") + name + "' has no colour anywhere");
}

// Sizes of box, cylinder, capsule, sphere: false if the shape is not usable.
bool read_size(const XMLElement& shape, const std::string& owner, GeometryObject& object, Report& report) {
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

bool read_mesh(const XMLElement& mesh, const std::string& owner, GeometryObject& object, Report& report) {
  object.shape = Shape::Mesh;
  object.meshUri = read_text(mesh, "filename", owner, report);
  bool read = !object.meshUri.empty();
  if (mesh.Attribute("scale")) {
    read = read_numbers(mesh, "scale", owner, std::span(object.scale.data(), 3), report) && read;
    if (read && object.scale.cwiseAbs().minCoeff() == 0) {
      report.error(line_of(mesh, "scale"), owner,
                   "mesh scale is zero " + exactly(std::span(object.scale.data(), 3)));
      return false;
    }
  }
  return read;
}

// One <visual> or <collision>; nothing if it is not usable.
std::optional<LinkShape> read_shape(const XMLElement& element, const std::string& owner, const Colors& colors,
                                    Report& report) {
  const std::string tag = element.Name();
  LinkShape item;
  item.visual = tag == "visual";
  item.object.placement = pose_of_shape(read_origin(element.FirstChildElement("origin"), owner, report));

  const XMLElement* geometry = element.FirstChildElement("geometry");
  const XMLElement* shape = geometry ? geometry->FirstChildElement() : nullptr;
  if (!shape) {
    report.error(line_of(geometry ? *geometry : element), owner,
                 "<" + tag + "> has no " + (geometry ? "shape" : "<geometry>"));
    return {};
  }
  if (shape->NextSiblingElement()) {
    report.error(line_of(*shape->NextSiblingElement()), owner, "a second shape in one <geometry>");
    return {};
  }
  item.line = line_of(*shape);
  if (item.visual) apply_material(element, colors, owner, item.object, report);
  const std::string_view kind = shape->Name();
  const bool solid = kind == "box" || kind == "cylinder" || kind == "capsule" || kind == "sphere";
  const bool read = kind == "mesh" ? read_mesh(*shape, owner, item.object, report)
                                   : solid && read_size(*shape, owner, item.object, report);
  if (!read) return {};
  return item;
}

}  // namespace

std::vector<LinkShape> read_shapes(const XMLElement& robot, Report& report) {
  const Colors colors = read_colors(robot, report);
  std::vector<LinkShape> out;
  for_each(robot, "link", [&](const XMLElement& link) {
    const std::string name = link.Attribute("name") ? link.Attribute("name") : "";
    int count[2] = {0, 0};  // names are numbered apart: collision, visual
    for (const XMLElement* e = link.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string_view tag = e->Name();
      if (tag != "visual" && tag != "collision") continue;
      const int number = count[tag == "visual"]++;
      std::optional<LinkShape> item = read_shape(*e, owner_of(link), colors, report);
      if (!item) continue;
      item->link = name;
      item->object.name = name + "_" + std::to_string(number);
      out.push_back(std::move(*item));
    }
  });
  return out;
}

}  // namespace rbd::urdf
