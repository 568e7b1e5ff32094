// Where a mass or an inertia is refused or doubted: on the built model, since what counts is the body that a
// joint really moves.
#pragma once

#include "rbd/model/model.h"
#include "rbd/urdf/description.h"

namespace rbd::urdf {

// Links whose inertia no matter can have (an error where it makes the whole moving body impossible, else a
// warning), point masses, and moving bodies without mass or without inertia about their joint's axis: there
// the mass matrix is singular. A negative mass never gets here: read_elements.h refuses it.
void check_inertia(const Model& model, const Description& robot, Report& report);

}  // namespace rbd::urdf
