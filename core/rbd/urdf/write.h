// Model in, URDF text out; urdf::load of it gives the same model back.
#pragma once

#include <string>

#include "rbd/model/model.h"

namespace rbd::urdf {

// URDF of `model`, one element a line. What comes back from load() (Options as they are by default) has the
// same joints by name, with their kinds, placements, limits, damping, friction and mimics, and the same
// bodies and frames by name; every algorithm gives the same numbers to rounding. In detail:
//   - joints come back in load's order: depth first, siblings by name. A loaded model keeps its order.
//   - each moving joint and each frame becomes a link; links, fixed joints and their names are kept. Frames
//     of other types (OP_FRAME, SENSOR) come back as links on a fixed joint NAME_fixed; a joint whose moving
//     part has no link of its own gets one, NAME_link, and the ground "world".
//   - inertias are written link by link; where they no longer add up to what a joint moves (setInertia), all
//     of it goes to the link at the joint.
//
// Throws std::invalid_argument, with the name, for what URDF cannot say: helical, universal, spherical and
// translation joints; limits that differ in both directions or between axes, position limits of planar and
// floating joints; armature and rotors; gravity other than (0, 0, -9.81); two frames that would be links, or
// joints, of one name. And for whatever load() would refuse, with its message: the text is read back before
// it is returned.
std::string writeModel(const Model& model);

}  // namespace rbd::urdf
