// Two robots that need no file. Dimensions and inertias: docs/sample_models.md.
#pragma once

#include "rbd/model/model.h"

namespace rbd::buildModels {

// Six-axis arm, name "manipulator": joints RZ RY RY RZ RY RZ, 13 frames. At neutral the upper arm stands
// upright and the forearm points along +x. `model` is replaced. Smallest eigenvalue of M at least 0.2 kg m^2
// everywhere. mimic = true is refused (std::invalid_argument) until the core has mimic joints.
void manipulator(Model& model, bool mimic = false);

// Human-like robot of about 1.6 m on a free-flyer, name "humanoid": nq 37, nv 36.
void humanoid(Model& model, bool mimic = false);

}  // namespace rbd::buildModels
