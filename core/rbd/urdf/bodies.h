// Checks of masses and inertias that need the built model: what counts is the body that a joint really moves.
#pragma once

#include "rbd/model/model.h"
#include "rbd/urdf/check.h"

namespace rbd::urdf {

// Links whose inertia no matter can have (an error where it makes the whole moving body impossible, else a
// warning), point masses, and moving bodies without mass or without inertia about their joint's axis: there
// the mass matrix is singular.
void check_bodies(const Model& model, const Elements& elements, Report& report);

}  // namespace rbd::urdf
