// Every check of links, joints and their tree that must hold before a model is built from them.
#pragma once

#include <map>
#include <string>

#include "rbd/urdf/xml.h"

namespace rbd::urdf {

// Links and joints by name, as they stand in the file. Valid as long as the XML document.
struct Elements {
  std::map<std::string, tinyxml2::XMLElement*> links;
  std::map<std::string, tinyxml2::XMLElement*> joints;
};

// Each link and joint on its own: names, masses, inertias, placements, kinds, axes, limits. Numbers that pass
// are rewritten in plain form (see read_numbers).
Elements check_elements(tinyxml2::XMLElement& robot, Report& report);

// All of them together: one root, no loops, nothing detached, parents and children that exist.
// Call it only if check_elements reported no error.
void check_tree(const Elements& elements, Report& report);

// Names that the model keeps for itself ("universe", and "root_joint" above a floating base).
void check_names(const Elements& elements, bool floating_base, Report& report);

// Mimic joints: leaders that exist and move, no cycles, one degree of freedom. `honoured`: the model will
// have them as followers; otherwise each is told to be free.
void check_mimic(const Elements& elements, bool honoured, Report& report);

}  // namespace rbd::urdf
