// Checks of links and joints together: one tree, no name that the model reserves, valid mimics.
#pragma once

#include <string>

#include "rbd/urdf/description.h"

namespace rbd::urdf {

// One root, no loops, nothing detached, parents and children that exist. Returns the root link's name; of no
// use if an error was reported.
std::string check_tree(const Description& robot, Report& report);

// Names that the model keeps for itself ("universe", and "root_joint" above a floating base).
void check_names(const Description& robot, bool floating_base, Report& report);

// Mimic joints: leaders that exist and move, no cycles, one degree of freedom. `honoured`: the model will
// have them as followers; otherwise a note says that each is free.
void check_mimic(const Description& robot, bool honoured, Report& report);

}  // namespace rbd::urdf
