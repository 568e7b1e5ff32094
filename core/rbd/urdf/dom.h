// urdfdom, kept quiet and to the point: it gets only what we checked, and everything it says is reported.
#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include "rbd/urdf/check.h"

namespace rbd::urdf {

// The links and joints of a checked file as urdfdom's tree; null and an error in the report if it refuses.
// Takes shapes, materials and everything else it need not see out of `robot`.
::urdf::ModelInterfaceSharedPtr read_dom(tinyxml2::XMLElement& robot, const Elements& elements,
                                         Report& report);

}  // namespace rbd::urdf
