// Two robots that need no file. Dimensions and inertias: docs/sample_models.md.
#pragma once

#include "rbd/model/model.h"

namespace rbd::buildModels {

// Six-axis arm, name "manipulator": joints RZ RY RY RZ RY RZ, 13 frames. At neutral the upper arm stands
// upright and the forearm points along +x. `model` is replaced. Smallest eigenvalue of M at least 0.2 kg
// m^2 everywhere. mimic: a tool that keeps its roll. joint6_tool_roll follows joint4_forearm_roll with -1;
// nq 5, nv 5.
void manipulator(Model& model, bool mimic = false);

// Human-like robot of about 1.6 m on a free-flyer, name "humanoid": nq 37, nv 36.
// mimic: legs like pantographs, whose feet do not pitch against the pelvis. Knees follow hip pitches with -2,
// ankle pitches follow knees with -0.5; nq 33, nv 32.
void humanoid(Model& model, bool mimic = false);

}  // namespace rbd::buildModels
