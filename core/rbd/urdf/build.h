// From a checked description of links and joints to a Model.
#pragma once

#include <string>

#include "rbd/model/model.h"
#include "rbd/urdf/description.h"
#include "rbd/urdf/urdf.h"

namespace rbd::urdf {

// Adds the tree below the link `root` to an empty model. The description must have passed every check.
void build(const Description& robot, const std::string& root, const Options& options, Model& model);

}  // namespace rbd::urdf
