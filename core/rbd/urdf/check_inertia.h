// Where a mass or an inertia is refused or gets a warning: on the built model, since what counts is the whole body
// that a joint moves, welded links included.
#pragma once

#include "rbd/model/model.h"
#include "rbd/urdf/description.h"

namespace rbd::urdf {

// Links whose inertia is physically impossible (an error where it makes the whole moving body impossible, else a
// warning), point masses, and moving bodies without mass or without inertia about their joint's axis: there
// the mass matrix is singular. Negative masses are refused earlier, in read_elements.h.
void check_inertia(const Model& model, const Description& robot, Report& report);

}  // namespace rbd::urdf
