// Links and joints from XML to plain values, each checked on its own while it is read.
#pragma once

#include "rbd/urdf/description.h"
#include "rbd/urdf/xml.h"

namespace rbd::urdf {

// Reports what is wrong within one element: names, masses, kinds, axes, limits, malformed numbers. Use the
// result only if no error was reported.
Description read_elements(const tinyxml2::XMLElement& robot, Report& report);

// An <origin>, or none (null).
Origin read_origin(const tinyxml2::XMLElement* origin, const std::string& owner, Report& report);

}  // namespace rbd::urdf
