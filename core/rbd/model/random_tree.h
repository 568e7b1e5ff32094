// Random robots for tests and benches: trees of any shape with every kind of joint.
#pragma once

#include <cstdint>

#include "rbd/model/model.h"

namespace rbd::buildModels {

struct RandomTree {
  int joints = 10;
  bool floating_base = false;  // joint 1 is a free-flyer that carries everything
  bool depth_first = false;  // numbered depth first, as from a URDF; otherwise parents are any earlier joint
  bool mimic = false;  // about one one-dof joint in three follows another, before or behind it; chains too
};

// Joints "joint1" .. behind placements of about a metre, each with a solid body, a frame "tool1" .. and
// armature. Something heavy stands on the ground, which no algorithm may see. The same seed gives the same
// bytes on every machine.
Model randomTree(std::uint64_t seed, const RandomTree& options);

}  // namespace rbd::buildModels
