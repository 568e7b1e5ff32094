// The shapes of the sample robots, for pictures: GeometryModel with `visual` and an equal `collision`.
// `model` must be the sample of that name (std::out_of_range names the joint that is missing).
#pragma once

#include "rbd/model/geometry.h"
#include "rbd/model/model.h"

namespace rbd::buildModels {

GeometryModel manipulatorGeometries(const Model& model);
GeometryModel humanoidGeometries(const Model& model);

}  // namespace rbd::buildModels
