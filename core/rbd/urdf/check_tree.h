// What links and joints must be together: one tree, names the model does not need itself, mimics that lead
// somewhere.
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
// have them as followers; otherwise each is told to be free.
void check_mimic(const Description& robot, bool honoured, Report& report);

}  // namespace rbd::urdf
